"""Parameters and effects are found again in runs that have them, on conditions no fit has seen."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import FIXED, Condition
from models.rig import LawSpec
from models.transfer_functions.transfer_function import TransferFunction
from noise.base import SURE_90
from noise.diagnosis.evidence.summary import case_table
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import closed_interval, closed_share
from noise.diagnosis.fit.estimated_forms import estimated_forms, wiener_estimate
from noise.diagnosis.fit.fit import (
    fit_effects,
    fit_parameters,
    pattern_search,
    read_offsets,
    split,
    stated_candidates,
)
from noise.diagnosis.simulated.model_runs import OFFSETS, Model, with_offsets
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG, at, run

SPEEDS = (1.0, 1.6, 2.5)


def _comparison(recordings, rig=RIG, library=EFFECTS, names=()):
    """Recordings beside their rig; with names of numbers, each of which scatters by 0.05."""
    table = case_table(recordings, rig, library=library) if names else None
    scale = np.full(len(names), 0.05)
    return CaseComparison(rig, tuple(recordings), library, table, tuple(names), scale)


def _gap(comparison, model, chosen):
    return float(np.sqrt(np.mean(comparison.squared(model, chosen))))


@pytest.fixture(scope="module")
def plain():
    return _comparison([run(at(v, FIXED), seed=40 + i) for i, v in enumerate(SPEEDS)])


WEAK = {"form": "exponential", "share": 0.4, "speed": 5.0}


@pytest.fixture(scope="module")
def weakening():
    conditions = [at(v, FIXED) for v in SPEEDS]
    return _comparison([run(c, ("velocity_weakening", WEAK), seed=40 + i)
                   for i, c in enumerate(conditions)])  # fmt: skip


def test_a_model_is_simulated_alike_each_time_and_as_it_was_recorded(plain):
    template = plain.recordings[1]
    one, again = (plain.runs.simulated(Model(), template, 3) for _ in range(2))
    assert one.samples.tobytes() == again.samples.tobytes()
    assert one.samples.shape == template.samples.shape
    assert (one.rate, one.condition) == (template.rate, template.condition)


def test_residuals_saturate_and_are_smallest_at_the_truth():
    late = {"form": "constant", "delay": 3e-4, "acceleration": 1.0}
    runs = [run(at(v), ("channel_delay", late), seed=40 + i) for i, v in enumerate(SPEEDS[:2])]
    comparison = _comparison(runs, names=[f"acceleration_transfer_{i}" for i in range(4, 10)])
    truth = Model(effects=(LawSpec("channel_delay", late),))
    at_truth, without = (comparison.residuals(model, [0, 1]) for model in (truth, Model()))
    assert (np.abs(at_truth) <= 1.0).all()
    assert (np.abs(without) <= 1.0).all()
    assert np.sum(at_truth**2) < 0.5 * np.sum(without**2)


def test_the_truth_closes_the_gap(weakening):
    truth = Model(effects=(LawSpec("velocity_weakening", WEAK),))
    before, after = (_gap(weakening, model, range(3)) for model in (Model(), truth))
    assert before > 3.0
    assert after < 0.6 * before


def test_a_stiffness_that_is_off_is_recalibrated():
    stiff = with_offsets(RIG, {"elastomer_stiffness": 1.15})
    comparison = _comparison(
        [run(at(v, FIXED), seed=70 + i, rig=stiff) for i, v in enumerate(SPEEDS)]
    )
    fitted = fit_parameters(comparison, [0, 2])
    found = dict(zip(OFFSETS, fitted.model.offsets, strict=True))
    assert found["elastomer_stiffness"] == pytest.approx(math.log(1.15), abs=0.06)
    for name in ("critical_torque", "kinetic_torque"):
        assert found[name] == pytest.approx(0.0, abs=0.06)
    before, after = (_gap(comparison, m, [1]) for m in (Model(), fitted.model))
    assert (before - max(after, 1.0)) / (before - 1.0) > 0.5
    assert all(s > 0 for s in fitted.spread.values())


def _changed_rig(seed):
    """Recordings of a rig whose parameters are off, by how much, and a comparison of them."""
    rng = np.random.default_rng([seed, 99])
    true = np.clip(rng.normal(0.0, 0.06, len(OFFSETS)), -0.12, 0.12)
    rig = with_offsets(RIG, dict(zip(OFFSETS, np.exp(true).tolist(), strict=True)))
    conditions = [at(v, (2214.0, FIXED)[i % 2]) for i, v in enumerate((0.8, 1.4, 2.4, 4.0))]
    runs = [run(c, seed=1000 + 10 * seed + i, rig=rig, seconds=0.3)
            for i, c in enumerate(conditions)]  # fmt: skip
    return true, _comparison(runs, names=["contact_peak"])


def test_torques_and_stiffness_are_read_off_recordings():
    true, comparison = _changed_rig(1)
    read = dict(zip(OFFSETS, read_offsets(comparison.table, range(4)), strict=True))
    for name, within in (
        ("critical_torque", 0.03), ("kinetic_torque", 0.03), ("elastomer_stiffness", 0.06)
    ):  # fmt: skip
        assert read[name] == pytest.approx(true[OFFSETS.index(name)], abs=within)
    assert read["damping"] == 0.0
    assert read_offsets(None, [0]) == (0.0,) * len(OFFSETS)


@pytest.mark.slow
def test_intervals_of_parameters_hold_nearly_as_often_as_they_say():
    inside = []
    for seed in range(40, 52):
        true, comparison = _changed_rig(seed)
        fitted = fit_parameters(comparison, range(4))
        spread = np.array([fitted.spread[name] for name in OFFSETS])
        inside += (np.abs(np.array(fitted.model.offsets) - true) < SURE_90 * spread).tolist()
    assert 0.8 <= np.mean(inside) <= 1.0  # of 60, 90 % by design


@pytest.mark.slow
def test_a_pair_begun_with_one_of_it_keeps_that_one(weakening):
    known = LawSpec("velocity_weakening", WEAK)
    fitted = fit_effects(
        weakening, [0, 2], ["velocity_weakening", "mains_hum"], Model(),
        begun=Model(effects=(known,)),
    )  # fmt: skip
    assert [spec.name for spec in fitted.model.effects] == ["velocity_weakening", "mains_hum"]
    assert fitted.model.effects[0].parameters["form"] == "exponential"
    assert _gap(weakening, fitted.model, [0, 2]) < _gap(weakening, Model(), [0, 2])


conditions = st.lists(
    st.builds(
        Condition,
        speed=st.sampled_from([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, None]),
        interference=st.sampled_from([0.2e-3, 0.3e-3, None]),
        support_stiffness=st.sampled_from([2214.0, math.inf]),
    ),
    min_size=1,
    max_size=12,
)


@settings(max_examples=100)
@given(conditions)
def test_whole_conditions_are_held_out(at):
    fitted, held = split(at)
    assert fitted
    assert held
    if len(set(at)) > 1:
        assert sorted(fitted + held) == list(range(len(at)))
        assert not {at[i] for i in fitted} & {at[i] for i in held}
        assert len({at[i] for i in held}) <= 0.5 * len(set(at))
        assert any(abs(at[i].speed or 0.0) == max(abs(c.speed or 0.0) for c in at) for i in held)


def test_an_effect_of_the_users_own_is_tried_over_two_decades_about_its_default():
    mine = replace(EFFECTS["velocity_weakening"], name="mine")
    shares = sorted({spec.parameters["share"] for spec in stated_candidates(mine, 0)})
    default = mine.parameters["share"].default
    assert shares[0] == pytest.approx(0.1 * default)
    assert shares[-1] == pytest.approx(min(10.0 * default, mine.parameters["share"].high))
    assert {spec.parameters["form"] for spec in stated_candidates(mine, 0)} == set(mine.forms)


squares = st.lists(st.floats(0.2, 400.0), min_size=1, max_size=6).map(np.array)


@given(squares, st.floats(0.0, 1.0))
def test_an_interval_holds_its_share(before, kept):
    after = before * kept
    share = closed_share(before, after)
    interval = closed_interval(before, after)
    assert (share is None) == (interval is None)
    if share is not None:
        low, high = interval
        assert low <= share <= high <= 1.0


def test_both_ends_of_an_interval_follow_what_the_fit_leaves():
    before = np.full(3, 36.0)
    ends = [closed_interval(before, np.full(3, left)) for left in (30.0, 16.0, 4.0)]
    assert sorted(ends) == ends
    for (_, high), (low, _) in itertools.pairwise(ends):
        assert high < low


def test_a_search_walks_over_steps_and_stays_within_what_is_finite():
    def cost(x):
        return float("inf") if x[0] > 2.0 else float(np.floor(10.0 * abs(x[0] - 1.6)) + abs(x[1]))

    found, least = pattern_search(cost, np.array([0.0, 0.5]), np.array([0.5, 0.0]), (1.0, 0.5, 0.2))
    assert found[0] == pytest.approx(1.6, abs=0.11)
    assert found[1] == 0.5
    assert least < 2.0


BEAMS = {"amount": 8.0, "frequency": 1000.0, "damping_ratio": 0.03}


def test_a_form_that_was_estimated_closes_much_of_what_the_true_one_does_where_it_is_not_from():
    runs = tuple(run(at(v), ("beam_modes", BEAMS), seed=40 + i) for i, v in enumerate(SPEEDS))
    comparison = CaseComparison(RIG, runs, EFFECTS, None, (), np.empty(0))
    left = []
    for form in estimated_forms(comparison, [0, 2]):
        comparison.forms["beam_modes", form.forms[0]] = form
        spec = LawSpec("beam_modes", {"form": form.forms[0], "amount": 1.0})
        left.append(float(comparison.misfits(Model(effects=(spec,)), [1])[0]))
    truth = Model(effects=(LawSpec("beam_modes", BEAMS),))
    before, after = (float(comparison.misfits(model, [1])[0]) for model in (Model(), truth))
    assert before > after
    assert before - min(left) > 0.5 * (before - after)


def test_a_transfer_is_found_beneath_noise_and_not_where_there_was_nothing():
    rng, rate = np.random.default_rng(0), 8e3
    spectrum = np.fft.rfft(rng.standard_normal(16000))
    x = np.fft.irfft(spectrum * _low_pass().at(np.fft.rfftfreq(16000, 1.0 / rate)))
    r = 0.5 * np.roll(x, 8)
    pairs = [(x, r + 0.02 * rng.standard_normal(x.size))]
    found = wiener_estimate(pairs, rate, 0.02, noise=0.02)
    assert abs(found.at(np.array([300.0]))[0]) == pytest.approx(0.5, rel=0.1)
    assert abs(found.at(np.array([3000.0]))[0]) < 0.2


def _low_pass():
    frequency = np.linspace(0.0, 4e3, 401)
    return TransferFunction(frequency, (frequency < 1000.0).astype(complex))
