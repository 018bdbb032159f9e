"""Cases that the diagnosis learns from: the same seed the same case, and all kinds of them."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from noise.diagnosis.cases.draws import drawn_effect
from noise.diagnosis.simulated.model_runs import OFFSETS, with_offsets
from noise.diagnosis.simulated.repeats import CHANNELS, Scatter
from noise.training.causes.cases.draw import KINDS, WEAKEST, draw_case
from noise.training.causes.cases.rigs import draw_setting
from noise.training.causes.cases.unknown_effects import UNKNOWN_EFFECTS, draw_unknown_effect
from noise.training.causes.fit import known_cases_of_a_rig
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG, SECONDS, at, run


def test_the_same_seed_gives_the_same_case_and_another_another():
    one, again, other = draw_case(11), draw_case(11), draw_case(12)
    assert one.truth == again.truth
    assert len(one.recordings) == len(again.recordings)
    for a, b in zip(one.recordings, again.recordings, strict=True):
        assert a.condition == b.condition
        assert a.samples.tobytes() == b.samples.tobytes()
    assert one.recordings[0].samples.tobytes() != other.recordings[0].samples.tobytes()


def test_cases_in_a_row_are_of_one_rig_and_its_repeats_are_simulated_once():
    one, other = draw_case(8), draw_case(11)
    assert one.rig is other.rig
    assert one.truth != other.truth
    assert draw_case(12).rig.fits != one.rig.fits
    shared, alone = known_cases_of_a_rig([8, 11]), known_cases_of_a_rig([11])
    assert np.array_equal(shared[1].table.measured, alone[0].table.measured, equal_nan=True)
    assert np.array_equal(shared[0].table.nominal, shared[1].table.nominal, equal_nan=True)


@pytest.mark.parametrize("seed", [0, 8, 21])
def test_a_case_is_what_a_user_brings(seed):
    case = draw_case(seed)
    rates = {recording.rate for recording in case.recordings}
    assert len(rates) == 1
    conditions = Counter(recording.condition for recording in case.recordings)
    assert sorted(conditions.values())[-1] == (1 if "single" in case.departures else 2)
    supports = {c.support_stiffness for c in conditions}
    assert {m.support_stiffness for m in case.rig.measured} == supports
    for recording in case.recordings:
        assert recording.channel_names in (CHANNELS, ("torque", "angle"))
        assert np.isfinite(recording.samples).all()
        assert (recording.samples.std(axis=1) > 0).all()
    listed = {spec.name for spec in case.rig.effects if not EFFECTS[spec.name].irregular}
    assert not listed & set(case.truth.effects)  # what is missing is not in the file


@pytest.fixture(scope="module")
def truths():
    """Causes of many cases, whose recordings are not made."""
    from noise.training.causes.cases import draw

    return [draw._draw_cause(RIG, np.random.default_rng(seed)) for seed in range(800)]


def test_all_kinds_and_all_effects_occur_about_as_often_as_is_said(truths):
    kinds = Counter(truth.kind for truth, _ in truths)
    assert set(kinds) == set(KINDS)
    assert sum(KINDS.values()) == pytest.approx(1.0)
    for kind, share in KINDS.items():
        assert kinds[kind] / len(truths) == pytest.approx(share, abs=0.05)
    named = Counter(n for truth, _ in truths if truth.kind != "unknown" for n in truth.effects)
    assert set(named) == set(EFFECTS)
    assert min(named.values()) > 0.4 * max(named.values())
    strange = Counter(n for truth, _ in truths if truth.kind == "unknown" for n in truth.effects)
    assert set(strange) == set(UNKNOWN_EFFECTS)
    assert not set(UNKNOWN_EFFECTS) & set(EFFECTS)


def test_effects_occur_in_the_simulators_forms_and_in_others(truths):
    own, other = set(), set()
    for truth, _ in truths:
        if truth.kind != "unknown":
            for name, form in zip(truth.effects, truth.forms, strict=True):
                (own if form in EFFECTS[name].forms else other).add(name)
    assert own == other == set(EFFECTS)


def test_a_truth_has_as_much_as_its_kind_says(truths):
    counts = {"none": 0, "parameters": 0, "one": 1, "pair": 2, "triple": 3, "unknown": 1}
    for truth, effects in truths:
        assert len(truth.effects) == len(truth.forms) == len(truth.strengths) == len(effects)
        assert len(effects) == counts[truth.kind]
        assert len(set(truth.effects)) == len(truth.effects)
        assert all(WEAKEST <= a <= 1.0 for a in truth.strengths)
        assert bool(truth.offsets) == (truth.kind == "parameters")
        for name, factor in truth.offsets:
            assert name in OFFSETS
            assert 0.08 <= abs(factor - 1.0) <= 0.2


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_a_stronger_effect_has_a_larger_strength_and_none_at_zero(name):
    effect = EFFECTS[name]
    for seed in range(4):
        weak, strong = (
            effect.active(drawn_effect(name, a, np.random.default_rng(seed)).parameters)
            for a in (0.1, 1.0)
        )
        assert abs(strong.values[effect.strength]) > 5 * abs(weak.values[effect.strength])
        assert not weak.is_off
        assert effect.active(
            drawn_effect(name, 0.0, np.random.default_rng(seed)).parameters
        ).is_off  # fmt: skip


def _strange(name, strength, seed):
    effect = draw_unknown_effect(name, strength, 8.0, 665.0, np.random.default_rng(seed))
    # "strength" as a parameter would switch it off; here what it does at that strength is meant
    return run(
        at(2.0), ("unknown_effect", {}), seed=1, library={**EFFECTS, "unknown_effect": effect}
    )


@cache
def _plain():
    return run(at(2.0), seed=1)


@pytest.mark.parametrize("name", sorted(UNKNOWN_EFFECTS))
def test_a_stranger_of_no_strength_does_nothing_and_a_strong_one_does(name):
    plain = _plain()
    rest = _strange(name, 0.0, 0).samples - plain.samples
    # chance draws of the effect's own may shift those of noise and gains, but do no more
    gains = 4.0 * math.sqrt(2.0) * Scatter().gain
    assert (np.std(rest, axis=1) <= gains * np.std(plain.samples, axis=1) + 0.02).all()
    shares = (
        np.std(_moving(_strange(name, 1.0, seed)) - _moving(plain), axis=1)
        / np.std(_moving(plain), axis=1)
        for seed in range(3)
    )
    assert any(share.max() > 0.1 for share in shares)  # one that shows is enough


def _moving(recording):
    """Torque, acceleration and pressure, and how far the angle goes in 2 ms."""
    x = recording.samples
    steps = round(2e-3 * recording.rate)
    return np.concatenate([x[:3, steps:], x[3:, steps:] - x[3:, :-steps]])


def test_offsets_change_what_they_name_in_every_fit():
    setting = draw_setting(np.random.default_rng(1))
    changed = with_offsets(setting.rig, {"elastomer_stiffness": 1.2, "damping": 0.8})
    for before, after in zip(setting.rig.fits, changed.fits, strict=True):
        assert after.elastomer_stiffness == pytest.approx(1.2 * before.elastomer_stiffness)
        for support, c in before.damping.items():
            assert after.damping[support] == pytest.approx(0.8 * c)
        assert (after.critical_torque, after.kinetic_torque) == (
            before.critical_torque, before.kinetic_torque,
        )  # fmt: skip
    assert with_offsets(setting.rig, {}) == replace(setting.rig, fits=setting.rig.fits)


def test_a_critical_torque_never_falls_below_the_kinetic_one():
    changed = with_offsets(RIG, {"critical_torque": 0.5, "kinetic_torque": 1.1})
    assert all(fit.critical_torque >= fit.kinetic_torque for fit in changed.fits)


def test_rigs_differ_and_stay_rigs():
    settings = [draw_setting(np.random.default_rng(seed)) for seed in range(40)]
    assert len({s.rig.elastomer_inertia for s in settings}) == 40
    for s in settings:
        assert 0.3 <= s.bench.seconds <= 5.0
        assert all(fit.critical_torque >= fit.kinetic_torque for fit in s.rig.fits)
        if not s.bench.departures:
            assert all(0.5 <= c.speed <= 10.0 for c in s.conditions)
            assert SECONDS <= s.bench.seconds <= 1.0
