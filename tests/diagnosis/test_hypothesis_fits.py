"""What a fit closes says how likely its hypothesis is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.diagnosis.causes.verdict import likeliest, normalised
from noise.diagnosis.findings import StageFinding
from noise.diagnosis.fit import hypothesis_fits
from noise.diagnosis.fit.closing import closed_of, load_closing_odds, room_of
from noise.diagnosis.fit.hypothesis_fits import (
    CaseFits,
    HypothesisFit,
    fit_hypotheses,
    fit_notes,
    settled,
    updated,
)
from sim.effects import EFFECTS

NAMES = ("partial_slip", "velocity_weakening", "background_noise")
STAGES = {
    "friction": StageFinding(7.0, 0.9, 0.001),
    "measurement": StageFinding(1.0, 0.0, 1.0),
}
gaps = st.floats(0.5, 40.0)


def squared(gap):
    """Squared distances of four recordings."""
    return np.full(4, gap**2)


def fits_of(before, recalibrated, **after):
    """Fits of sets of effects, by names joined by ``_and_``, and the gaps that they leave."""
    comparison = SimpleNamespace(library=EFFECTS)
    of = {
        frozenset(names.split("_and_")): HypothesisFit(
            tuple(names.split("_and_")), None, squared(g)
        )
        for names, g in after.items()
    }
    return CaseFits(comparison, (0, 1), (2, 3), None, squared(before), squared(recalibrated), of)


def chances(unknown=0.1, parameters=0.05, none=0.01, **effects):
    weights = {frozenset(): none, frozenset({"parameters"}): parameters}
    weights |= {frozenset({"unknown"}): unknown}
    return normalised(weights | {frozenset(k.split("_and_")): p for k, p in effects.items()})


def test_a_name_whose_fit_closes_the_gap_gains_and_one_whose_fit_does_not_loses():
    before = chances(partial_slip=0.5, unknown=0.4)
    partial, unknown = frozenset({"partial_slip"}), frozenset({"unknown"})
    closing, idle = (
        updated(before, fits_of(6.0, 5.9, partial_slip=left), STAGES) for left in (1.2, 5.89)
    )
    assert closing[partial] / closing[unknown] > before[partial] / before[unknown]
    assert idle[partial] / idle[unknown] < before[partial] / before[unknown]
    assert likeliest(closing) == ("partial_slip",)


def test_a_likely_name_that_closes_nothing_is_unknown_where_its_stage_does_not_differ():
    now = updated(
        chances(background_noise=0.44, unknown=0.3, parameters=0.01),
        fits_of(6.45, 6.4, background_noise=6.6),
        STAGES,
    )
    assert likeliest(now) == ("unknown",)


@given(gaps, gaps, gaps)
def test_of_two_fits_the_one_that_leaves_less_is_favoured_more(recalibrated, one, other):
    odds = load_closing_odds()
    least, most = sorted((one, other))
    assert odds.of_effects(recalibrated, least) >= odds.of_effects(recalibrated, most)


@given(gaps, gaps)
def test_shares_stay_within_what_they_are_shares_of(before, after):
    assert -1.0 <= closed_of(before, after) <= room_of(before) < 1.0


def test_where_parameters_close_all_names_keep_their_odds():
    before = chances(partial_slip=0.5, unknown=0.4)
    seen = {"friction": StageFinding(0.0, 0.0, 1.0)}
    now = updated(before, fits_of(6.0, 1.0, partial_slip=1.0), seen)
    partial, unknown = frozenset({"partial_slip"}), frozenset({"unknown"})
    assert now[partial] / now[unknown] == pytest.approx(before[partial] / before[unknown])
    off = frozenset({"parameters"})
    assert now[off] / now[unknown] > before[off] / before[unknown]


def test_where_no_stage_differs_none_speaks_against_a_name():
    before = chances(speed_fluctuation=0.3, unknown=0.3)
    drive, unknown = frozenset({"speed_fluctuation"}), frozenset({"unknown"})
    fits = fits_of(2.5, 2.4, speed_fluctuation=1.2)
    stages = {"drive": StageFinding(1.0, 0.0, 1.0), "measurement": StageFinding(4.0, 0.9, 0.001)}
    faint = stages | {"measurement": StageFinding(1.6, 0.9, 0.9)}
    sure, unsure = (updated(before, fits, looked) for looked in (stages, faint))
    assert unsure[drive] / unsure[unknown] > sure[drive] / sure[unknown]


def test_a_second_effect_that_closes_nothing_more_is_superfluous():
    two = "partial_slip_and_velocity_weakening"
    now = updated(
        chances(partial_slip=0.3, **{two: 0.5}),
        fits_of(8.0, 7.9, partial_slip=1.4, **{two: 1.4}),
        STAGES,
    )
    assert likeliest(now) == ("partial_slip",)
    now = updated(
        chances(partial_slip=0.5, **{two: 0.3}),
        fits_of(8.0, 7.9, partial_slip=5.0, **{two: 1.2}),
        STAGES,
    )
    assert set(likeliest(now)) == {"partial_slip", "velocity_weakening"}


def test_a_gap_as_of_repeats_speaks_for_nothing_being_the_matter():
    before = chances(partial_slip=0.5, none=0.1)
    small, large = (
        updated(before, fits_of(gap, gap, partial_slip=gap), STAGES)[frozenset()]
        for gap in (1.0, 6.0)
    )
    assert small > large


def test_a_fit_that_makes_it_worse_hands_its_chance_to_the_unknown():
    fits = fits_of(6.0, 5.0, partial_slip=5.5, velocity_weakening=3.0)
    before = chances(partial_slip=0.6, velocity_weakening=0.1, unknown=0.1)
    now = settled(before, fits)
    assert likeliest(now, fits.of) == ("unknown",)
    idle, unknown = frozenset({"partial_slip"}), frozenset({"unknown"})
    assert now[unknown] == pytest.approx(before[unknown] + before[idle])
    assert sum(now.values()) == pytest.approx(1.0)


def test_a_pair_whose_search_stopped_short_leaves_what_one_of_it_leaves():
    pair = frozenset({"partial_slip", "velocity_weakening"})
    fits = fits_of(6.0, 5.0, partial_slip=1.5, partial_slip_and_velocity_weakening=4.0)
    assert fits.least(pair).tolist() == squared(1.5).tolist()
    assert fits.least(frozenset({"partial_slip"})).tolist() == squared(1.5).tolist()


def test_what_the_model_cannot_let_be_heard_closes_nothing_and_is_not_named():
    fits = fits_of(6.0, 5.0, room_reflections=5.0, partial_slip=4.2)
    room, partial = frozenset({"room_reflections"}), frozenset({"partial_slip"})
    now = settled(chances(room_reflections=0.6, partial_slip=0.1, unknown=0.2), fits)
    assert likeliest(now, fits.of) == ("unknown",)
    assert not fits.closes(room)
    assert fits.closes(partial)


def test_what_closes_only_recordings_that_were_fitted_to_is_not_named():
    fits = fits_of(6.0, 5.0, partial_slip=3.0)
    (fit,) = fits.of.values()
    fit.squared[:] = [1.0, 1.0, 36.0, 36.0]  # the last two are held out
    assert not fits.closes(frozenset({"partial_slip"}))
    fit.squared[:] = [36.0, 36.0, 1.0, 1.0]
    assert fits.closes(frozenset({"partial_slip"}))


def test_of_a_gap_that_parameters_close_a_little_less_has_to_be_left():
    assert fits_of(6.0, 1.2, partial_slip=1.1).closes(frozenset({"partial_slip"}))
    assert not fits_of(6.0, 1.2, partial_slip=1.2).closes(frozenset({"partial_slip"}))


@pytest.fixture
def closed(monkeypatch):
    """Gaps that fits leave, in place of fits; what was fitted is noted."""
    left, fitted = {}, []

    def fit(comparison, chosen, names, start, seed, begun=None):
        assert begun is None or begun < frozenset(names)
        fitted.append(frozenset(names))
        return SimpleNamespace(model=frozenset(names))

    monkeypatch.setattr(hypothesis_fits, "fit_effect", fit)
    return left, fitted


def tried(closed, before, always=()):
    left, fitted = closed
    fits = fits_of(6.0, 5.9)
    fits.comparison.squared = lambda model, _chosen: squared(left.get(model, 5.9))
    fits = CaseFits(**(vars(fits) | {"alone": SimpleNamespace(model=None)}))
    return fit_hypotheses(fits, before, always, STAGES), fitted


def test_the_likeliest_is_fitted_first_and_no_more_once_it_closes(closed):
    closed[0][frozenset({"partial_slip"})] = 1.0
    _, fitted = tried(closed, chances(partial_slip=0.9, velocity_weakening=0.05, unknown=0.04))
    assert fitted == [frozenset({"partial_slip"})]


def test_nothing_is_added_to_what_closes_all(closed):
    closed[0][frozenset({"partial_slip"})] = 1.0
    two = {"partial_slip_and_velocity_weakening": 0.25}
    _, fitted = tried(closed, chances(partial_slip=0.65, unknown=0.05, **two))
    assert fitted == [frozenset({"partial_slip"})]


def test_others_are_fitted_where_the_likeliest_closes_nothing(closed):
    _, fitted = tried(closed, chances(partial_slip=0.6, velocity_weakening=0.3, unknown=0.04))
    assert fitted == [frozenset({"partial_slip"}), frozenset({"velocity_weakening"})]


def test_effects_of_the_users_own_are_fitted_whatever_their_chance(closed):
    _, fitted = tried(closed, chances(partial_slip=0.01, parameters=0.9), ["background_noise"])
    assert fitted == [frozenset({"background_noise"})]


def test_a_cause_that_cannot_be_simulated_is_left_out_and_ends_no_diagnosis(closed, monkeypatch):
    fit = hypothesis_fits.fit_effect

    def breaks_down(comparison, chosen, names, *others, **more):
        if "transfer_film" in names:
            raise ParameterError("steps of 1e-07 s cannot follow")
        return fit(comparison, chosen, names, *others, **more)

    monkeypatch.setattr(hypothesis_fits, "fit_effect", breaks_down)
    closed[0][frozenset({"partial_slip"})] = 1.0
    fits, fitted = tried(closed, chances(transfer_film=0.6, partial_slip=0.3, unknown=0.04))
    assert fitted == [frozenset({"partial_slip"})]
    assert fits.impossible == {frozenset({"transfer_film"}): "steps of 1e-07 s cannot follow"}
    (note,) = fit_notes(SimpleNamespace(fits=fits, among=()))
    assert note.startswith("transfer_film was not fitted")
