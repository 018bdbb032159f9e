"""From the torque to acceleration and sound: as measured where the rig file says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED, Condition, KnownCondition
from models.recording import Channel, Recording
from models.rig import LawSpec
from models.rig_file import load_material_rig, load_rig
from models.transfer_functions.measured import MeasuredResponse
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.signature import group_costs, signature
from noise.diagnosis.simulated.model_runs import Model, ModelRuns
from noise.diagnosis.simulated.repeats import Scatter, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import (
    TransferFunctionCache,
    predict,
    shift_clamp_mode,
    torque_transfer_functions,
)
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG, RIG_FILE

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of what was not measured

FREQUENCY = np.arange(2.0, 12e3, 2.0)


@pytest.fixture
def rig_with(tmp_path):
    """A rig file with measured responses for one support."""

    def made(support, **responses):
        lines = [RIG_FILE, "[[measured_response]]", f"support_stiffness_Nm_rad = {support}"]
        for name, response in responses.items():
            unit = {"torque_to_acceleration": "m/s^2", "torque_to_pressure": "Pa"}[name]
            path = tmp_path / f"{name}.npz"
            np.savez(
                path, frequency_hz=FREQUENCY, response=np.full(FREQUENCY.size, response + 0j),
                input_unit="N m", output_unit=unit,
            )  # fmt: skip
            lines.append(f'{name} = "{path.name}"')
        (tmp_path / "rig.toml").write_text("\n".join(lines))
        return load_rig(tmp_path / "rig.toml")

    return made


def test_a_measured_response_is_taken_line_by_line(rig_with):
    rig = rig_with(2214, torque_to_acceleration=3.0 - 4.0j, torque_to_pressure=0.5j)
    found = torque_transfer_functions(rig, 0.279e-3, 2214.0)
    assert found["acceleration"].at(np.array([777.0, 3e3])) == pytest.approx([3 - 4j] * 2, rel=1e-3)
    assert found["pressure"].at(np.array([100.0])) == pytest.approx([0.5j], abs=0.01)


def test_what_was_not_measured_is_modelled(rig_with):
    found = torque_transfer_functions(rig_with(2214, torque_to_acceleration=3.0), 0.279e-3, 2214.0)
    assert found["acceleration"].at(np.array([500.0])) == pytest.approx([3.0])
    modelled = torque_transfer_functions(RIG, 0.279e-3, 2214.0)["pressure"]
    at = np.arange(100.0, 5e3, 100.0)  # inertias of the two rigs differ in the fourth digit
    assert found["pressure"].at(at) == pytest.approx(modelled.at(at), rel=0.01)


def test_a_measured_response_is_of_its_own_support_alone(rig_with):
    rig = rig_with(2214, torque_to_acceleration=3.0, torque_to_pressure=1.0)
    for support in (3745.0, FIXED):
        other = torque_transfer_functions(rig, 0.279e-3, support)["acceleration"].response
        assert not np.allclose(other, 3.0)
    fixed = rig_with('"fixed"', torque_to_acceleration=7.0, torque_to_pressure=1.0)
    bolted = torque_transfer_functions(fixed, 0.279e-3, FIXED)["acceleration"].at(
        np.array([500.0, 3e3])
    )
    assert bolted == pytest.approx([7.0, 7.0], rel=1e-3)


def test_the_simulator_sends_its_torque_through_the_same_transfer_functions():
    from sim.acquisition import Acquisition
    from sim.run import simulate

    quiet = Acquisition(noise={})
    recording = simulate(
        RIG, 1.0, support_stiffness=3745.0, seconds=0.4, acquisition=quiet
    ).recording
    found = torque_transfer_functions(RIG, 0.279e-3, 3745.0)
    inside = slice(round(0.1 * recording.rate), -round(0.02 * recording.rate))
    for kind in ("acceleration", "pressure"):
        predicted = predict(recording["torque"], recording.rate, found[kind])
        left = (predicted - recording[kind])[inside]
        assert np.std(left) < 0.1 * np.std(recording[kind][inside]), kind


PLAIN = load_material_rig("fluorocarbon-thesis")
LINES = np.arange(10.0, 5000.1, 2.5)


def _mode(f, at=259.0, damping=0.02):
    x = f / at
    return -(x**2) / (1.0 - x**2 + 2j * damping * x)


def _rig(response):
    """A rig whose both responses were measured."""
    frf = TransferFunction(LINES, response.astype(complex), None, "N m", "m/s^2")
    entry = MeasuredResponse(2214.0, frf, replace(frf, output_unit="Pa"))
    return replace(PLAIN, measured=(entry,))


def _measured(response):
    return torque_transfer_functions(_rig(response), 0.279e-3, 2214.0)["acceleration"]


def test_between_its_lines_a_resonance_is_what_it_is():
    f = np.arange(240.0, 280.0, 0.3)
    straight = np.abs(TransferFunction(LINES, _mode(LINES)).at(f) - _mode(f)).max()
    assert np.abs(_measured(_mode(LINES)).at(f) - _mode(f)).max() < 0.2 * straight


def test_a_measured_transfer_function_does_not_echo_after_one_over_its_spacing():
    torque = np.zeros(24_000)
    torque[2400] = 1.0
    rung = predict(torque, 24e3, _measured(_mode(LINES)))
    after = np.abs(rung[2400 + 8400 : 2400 + 12_000]).max()  # 0.35 to 0.5 s later
    assert after < 1e-3 * np.abs(rung).max()


def test_a_lighter_clamp_rings_higher():
    nominal = lumped_bushing(PLAIN, 0.279e-3, 2214.0)
    lighter = replace(nominal, clamp_inertia=0.9 * nominal.clamp_inertia)
    f = np.arange(150.0, 400.0, 0.1)
    s = 2j * np.pi * f
    clamp = 1.0 / (
        nominal.support_stiffness + nominal.support_damping * s + nominal.clamp_inertia * s**2
    )
    before, after = (
        f[np.argmax(np.abs(w.response))]
        for w in (
            TransferFunction(f, clamp),
            shift_clamp_mode(TransferFunction(f, clamp), nominal, lighter),
        )
    )
    assert after / before == pytest.approx(0.9**-0.5, rel=1e-3)


def test_a_quiet_steady_rig_is_quiet_from_start_to_end_of_a_recording():
    at = Condition(speed=8.0, interference=0.279e-3, support_stiffness=2214.0)
    rig = _rig(_mode(LINES))
    template = Recording(np.zeros((1, 15_000)), 30e3, (Channel("torque"),), at)
    (run,) = nominal_repeats(template, rig, TransferFunctionCache(rig), (1,))
    assert np.abs(run["acceleration"]).max() < 0.5


SUPPORT = 3745.0
AT = KnownCondition(2.0, 0.279e-3, SUPPORT)
RUN = Recording(
    np.zeros((3, 9000)), 30e3, tuple(map(Channel, ("torque", "acceleration", "pressure"))), AT
)
HAMMERED = np.arange(40.0, 10_001.0, 5.0)
NONE = Scatter(0.0, 0.0, 0.0, 0.0)


def _poorly_measured():
    """A rig of whose responses a hammer test tells a tenth wrong at every line."""
    rng = np.random.default_rng(0)
    responses = {}
    for name, h in torque_transfer_functions(PLAIN, 0.279e-3, SUPPORT).items():
        error = 0.1 * (rng.standard_normal((2, HAMMERED.size)) * np.abs(h.at(HAMMERED)))
        size = h.at(HAMMERED) + error[0] + 1j * error[1]
        responses[f"torque_to_{name}"] = TransferFunction(
            HAMMERED, size, None, "N m", h.output_unit
        )
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
