"""A rig file that states how irregular its bushing is: repeats scatter by it, more can be named."""

from __future__ import annotations

import numpy as np

from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.diagnosis.case import Case
from noise.diagnosis.causes.posterior import load_posterior
from noise.diagnosis.first_answer import first_answer, known_effects
from noise.diagnosis.simulated.model_runs import Model, ModelRuns, with_effects
from sim.effects import EFFECTS
from sim.run import simulate

RIG = load_material_rig("fluorocarbon")
SCATTER = "critical_torque_scatter"
CONDITIONS = ((1.0, 0.279e-3, 2214.0), (2.5, 0.279e-3, 3745.0), (1.0, 0.279e-3, 2214.0))


def scattered(scatter):
    return with_effects(RIG, [LawSpec(SCATTER, {"form": "uniform", "scatter": scatter})])


def recordings(rig, seed=5):
    return tuple(
        simulate(
            rig, speed, interference=fit, support_stiffness=support, seconds=0.5,
            rng=np.random.default_rng([seed, i]),
        ).recording
        for i, (speed, fit, support) in enumerate(CONDITIONS)
    )  # fmt: skip


def answer(rig):
    found = recordings(rig)
    case = Case(RIG, tuple(f"run{i}.wav" for i in range(len(found))), found)
    return first_answer(case, EFFECTS, load_posterior())


def test_recordings_of_a_rig_as_irregular_as_its_file_states_have_no_gap():
    assert answer(RIG).verdict == ()


def test_more_scatter_than_the_file_states_is_a_gap():
    found = answer(scattered(0.6))
    assert found.verdict != ()
    assert found.probabilities[SCATTER] > 0.0
    assert SCATTER not in known_effects(RIG, EFFECTS)


def test_a_model_with_more_scatter_has_it_instead_of_the_files():
    template = recordings(RIG)[0]
    more = ModelRuns(RIG, EFFECTS, {}).simulated(
        Model(effects=scattered(0.6).effects[-1:]), template, 3
    )
    stated = ModelRuns(scattered(0.6), EFFECTS, {}).simulated(Model(), template, 3)
    assert np.array_equal(more.samples, stated.samples)
