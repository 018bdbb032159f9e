"""What sensors see of a model: by the responses that the rig file has, as of nominal repeats."""

from dataclasses import replace

import numpy as np
import pytest

from models.condition import KnownCondition
from models.recording import Channel, Recording
from models.rig import LawSpec
from models.rig_file import load_material_rig
from models.transfer_functions.measured import MeasuredResponse
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.signature import group_costs, signature
from noise.diagnosis.simulated.model_runs import Model, ModelRuns
from noise.diagnosis.simulated.repeats import Scatter, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import (
    TransferFunctionCache,
    torque_transfer_functions,
)
from sim.effects import EFFECTS

SUPPORT = 3745.0
AT = KnownCondition(2.0, 0.279e-3, SUPPORT)
RUN = Recording(
    np.zeros((3, 9000)), 30e3, tuple(map(Channel, ("torque", "acceleration", "pressure"))), AT
)
LINES = np.arange(40.0, 10_001.0, 5.0)
PLAIN = load_material_rig("fluorocarbon-thesis")
NONE = Scatter(0.0, 0.0, 0.0, 0.0)


def _poorly_measured():
    """A rig of whose responses a hammer test tells a tenth wrong at every line."""
    rng = np.random.default_rng(0)
    responses = {}
    for name, h in torque_transfer_functions(PLAIN, 0.279e-3, SUPPORT).items():
        error = 0.1 * (rng.standard_normal((2, LINES.size)) * np.abs(h.at(LINES)))
        size = h.at(LINES) + error[0] + 1j * error[1]
        responses[f"torque_to_{name}"] = TransferFunction(LINES, size, None, "N m", h.output_unit)
    return replace(PLAIN, measured=(MeasuredResponse(SUPPORT, **responses),))


@pytest.mark.parametrize("rig", [PLAIN, _poorly_measured()], ids=["modelled", "poorly measured"])
def test_a_model_without_effects_is_heard_as_nominal_repeats_are(rig):
    nominal = nominal_repeats(RUN, rig, TransferFunctionCache(rig), [1], NONE, EFFECTS)[0]
    model = ModelRuns(rig, EFFECTS, {}).simulated(Model(), RUN, 1, NONE)
    away = (signature(nominal) - signature(model)) / 0.03
    assert np.nanmax(group_costs(away)) < 0.25


def test_what_effects_on_the_structure_change_is_added_to_what_was_measured():
    runs = ModelRuns(_poorly_measured(), EFFECTS, {})
    room = LawSpec("room_reflections", {"amount": 1.0})
    plain, echoing = (
        runs.simulated(Model(effects=effects), RUN, 1, NONE) for effects in ((), (room,))
    )
    assert np.array_equal(plain["torque"], echoing["torque"])
    assert np.array_equal(plain["acceleration"], echoing["acceleration"])
    assert np.std(echoing["pressure"] - plain["pressure"]) > 0.1 * np.std(plain["pressure"])
