"""What a fit leaves tells how likely one effect more is, and what it closes whether it is named."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.condition import Condition
from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.causes.verdict import likeliest, normalised
from noise.diagnosis.fit import decide
from noise.diagnosis.fit.decide import (
    CaseFits,
    HypothesisFit,
    fit_hypotheses,
    fit_notes,
    settled,
    updated,
    weakened,
)
from noise.diagnosis.fit.fit import Fitted, split
from noise.diagnosis.simulated.model_runs import Model
from sim.effects import EFFECTS

PARTIAL, WEAK, PAIR = (
    frozenset(names)
    for names in (
        {"partial_slip"}, {"velocity_weakening"}, {"partial_slip", "velocity_weakening"}
    )
)  # fmt: skip
NONE, PARAMETERS, UNKNOWN = frozenset(), frozenset({"parameters"}), frozenset({"unknown"})
gaps = st.floats(0.5, 40.0)


def squared(gap):
    """Squared distances of four recordings, the last two held out."""
    return np.broadcast_to(np.square(gap), 4).copy()


def fits_of(before, recalibrated, after, comparison=None, remaining=(), unlearned=()):
    of = {h: HypothesisFit(tuple(h), None, squared(gap)) for h, gap in after.items()}
    start = SimpleNamespace(model=None)
    return CaseFits(
        comparison, (0, 1), (2, 3), start, squared(before), squared(recalibrated), of,
        dict(remaining), frozenset(unlearned),
    )  # fmt: skip


def chances(more, unknown=0.1, parameters=0.05, none=0.01):
    return normalised({NONE: none, PARAMETERS: parameters, UNKNOWN: unknown} | more)


def left_by(*rows):
    return {h: {"velocity_weakening": p, "partial_slip": 0.1} for h, p in rows}


def test_an_effect_that_shows_in_what_a_fit_leaves_is_named_beside_it():
    before = chances({PARTIAL: 0.5, PAIR: 0.3})
    fits = {PARTIAL: 5.0, PAIR: 4.0}
    shows, hidden = (
        updated(before, fits_of(8.0, 7.9, fits, remaining=left_by((PARTIAL, p))))
        for p in (0.9, 0.02)
    )
    assert set(likeliest(shows)) == PAIR
    assert likeliest(hidden) == ("partial_slip",)


@given(gaps, gaps, gaps)
def test_of_two_fits_the_one_that_leaves_less_is_favoured(recalibrated, one, other):
    before = chances({PARTIAL: 0.3, WEAK: 0.3})
    now = updated(before, fits_of(40.0, recalibrated, {PARTIAL: one, WEAK: other}))
    assert (now[PARTIAL] - now[WEAK]) * (other - one) >= 0.0


def test_where_parameters_close_all_they_gain_and_names_keep_their_odds():
    before = chances({PARTIAL: 0.5}, unknown=0.4)
    now = updated(before, fits_of(6.0, 1.0, {PARTIAL: 1.0}))
    assert now[PARTIAL] / now[UNKNOWN] == pytest.approx(before[PARTIAL] / before[UNKNOWN])
    assert now[PARAMETERS] / now[UNKNOWN] > before[PARAMETERS] / before[UNKNOWN]


def test_a_fit_that_makes_it_worse_hands_half_of_its_chance_to_the_unknown():
    fits = fits_of(6.0, 5.0, {PARTIAL: 6.5, WEAK: 3.0})
    before = chances({PARTIAL: 0.6, WEAK: 0.1})
    now = settled(before, fits)
    assert now[UNKNOWN] == pytest.approx(before[UNKNOWN] + 0.5 * before[PARTIAL])
    assert now[WEAK] == pytest.approx(before[WEAK])
    assert likeliest(now, [WEAK]) == ("unknown",)


def test_a_pair_whose_search_stopped_short_leaves_what_one_of_it_leaves():
    fits = fits_of(6.0, 5.0, {PARTIAL: 1.5, PAIR: 4.0})
    assert fits.least(PAIR).tolist() == fits.least(PARTIAL).tolist() == squared(1.5).tolist()


@pytest.mark.parametrize(
    ("before", "recalibrated", "after", "closes"),
    [
        (6.0, 5.0, 6.0, False),
        (6.0, 5.0, [1.0, 1.0, 6.0, 6.0], False),  # only what was fitted to
        (6.0, 5.0, [6.0, 6.0, 1.0, 1.0], True),
        (6.0, 5.0, 5.0, True),  # as much as parameters, which may stand for the effect
        ([6.0, 6.0, 1.0, 1.0], [5.0, 5.0, 1.0, 1.0], [2.0, 2.0, 1.1, 1.1], True),
        ([6.0, 6.0, 1.0, 1.0], [5.0, 5.0, 1.0, 1.0], [2.0, 2.0, 1.6, 1.6], False),
    ],
)
def test_a_name_closes_some_of_the_gap_of_recordings_held_out(before, recalibrated, after, closes):
    assert fits_of(before, recalibrated, {PARTIAL: after}).closes(PARTIAL) == closes


@pytest.mark.parametrize(("strength", "share"), [(0.29, 1.0), (0.5, 0.5), (0.9, 0.25), (9.0, 1.0)])
def test_a_fit_that_overshoots_where_it_was_not_fitted_is_taken_in_part(strength, share):
    def left(model, chosen):  # the gap is 6 without the effect, and all closed by 0.15 of it
        return np.full(
            len(chosen), (1.0 + abs(model.effects[0].parameters["gain"] - 0.15) / 0.03) ** 2
        )

    spec = LawSpec("velocity_strengthening", {"gain": strength})
    model = Model((0.1, 0.0, 0.0, 0.0, 0.0), (spec,))
    comparison = SimpleNamespace(effect_of=lambda spec: EFFECTS[spec.name], squared=left)
    fits = fits_of(6.0, 5.0, {}, comparison)
    fitted = Fitted(model, comparison, (0, 1))
    fit = weakened(fits, HypothesisFit((spec.name,), fitted, left(model, range(4))))
    assert fit.share == share
    assert fit.fitted.model.offsets[0] == 0.1 * share
    assert fit.fitted.model.effects[0].parameters["gain"] == pytest.approx(share * strength)
    judged = decide.Judged(None, (2, 3), replace(fits, of={WEAK: fit}), {}, {}, tuple(WEAK))
    assert bool(fit_notes(judged)) == (share < 1.0)


def test_what_is_held_out_has_a_gap_where_more_than_one_condition_has():
    at = [Condition(speed=v) for v in (1.0, 1.5, 2.0, 2.5, 3.0)]
    gaps = [1.0, 4.0, 3.0, 1.0, 1.1]
    fitted, held = split(at, gaps)
    assert max(gaps[i] for i in held) == 3.0
    assert max(gaps[i] for i in fitted) == 4.0
    assert split(at, [4.0, 1.0, 1.0, 1.0, 1.0]) == split(at)
    alike = [at[0], *at]  # where one condition alone has a gap, its repeats are parted
    fitted, held = split(alike, [4.0, 4.0, 1.0, 1.0, 1.0, 1.0])
    assert 0 in fitted
    assert 1 in held


@pytest.fixture
def fitted(monkeypatch):
    """Gaps that fits leave, in place of fits; what was fitted is noted."""
    noted = []

    def fit(comparison, chosen, names, start, seed, begun=None):
        if "transfer_film" in names:
            raise ParameterError("steps of 1e-07 s cannot follow")
        assert begun is None or begun < frozenset(names)
        noted.append(frozenset(names))
        return SimpleNamespace(model=frozenset(names))

    monkeypatch.setattr(decide, "fit_effects", fit)
    monkeypatch.setattr(decide, "weakened", lambda _fits, fit: fit)

    def tried(before, after, always=(), left_by=lambda _model: {}):
        comparison = SimpleNamespace(squared=lambda model, _: squared(after.get(model, 5.9)))
        fits = fits_of(6.0, 5.9, {}, comparison, (), always)
        return fit_hypotheses(fits, before, left_by), noted

    return tried


def test_the_first_three_are_fitted_where_the_likeliest_closes_nothing(fitted):
    third = frozenset({"static_ageing"})
    before = chances({PARTIAL: 0.96, WEAK: 0.01, third: 0.005}, unknown=0.001, parameters=0.001)
    assert fitted(before, {PARTIAL: 6.5, WEAK: 6.5})[1] == [PARTIAL, WEAK, third]


def test_a_cause_that_cannot_be_simulated_is_left_out_and_ends_no_diagnosis(fitted):
    film = frozenset({"transfer_film"})
    fits, noted = fitted(chances({film: 0.6, PARTIAL: 0.3}, unknown=0.04), {PARTIAL: 1.0})
    assert noted == [PARTIAL]
    assert fits.impossible == {film: "steps of 1e-07 s cannot follow"}
    (note,) = fit_notes(SimpleNamespace(fits=fits, verdict=()))
    assert note.startswith("transfer_film was not fitted")
