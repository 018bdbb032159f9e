"""A diagnosis in words."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from noise.diagnosis.outcome import Agreement
from noise.diagnosis.sentences import (
    AGREES,
    agreement_sentence,
    fit_sentence,
    headline,
    location_sentence,
    parameters_off,
    verdict_sentence,
)
from noise.diagnosis.words import CAUSES, percent
from sim.effects import EFFECTS
from tests.helpers.made_diagnoses import SLIGHT, none, one_effect, unknown


def test_every_shipped_effect_has_a_description_and_nothing_else_has_one():
    assert set(CAUSES) == set(EFFECTS) | {"none", "parameters", "unknown"}


def test_one_effect_is_named_with_what_it_does_and_how_likely_it_is():
    assert headline(one_effect()) == "Missing: partial slip"
    assert verdict_sentence(one_effect()) == (
        "The simulation lacks partial slip: the contact creeps before it slips, and so lets go "
        "gradually (96 %)."
    )


def test_unknown_names_no_effect():
    sentence = verdict_sentence(unknown())
    assert sentence == (
        "Something differs in friction and no known effect is likely: the cause is unknown (88 %)."
    )
    assert not any(cause.name in sentence for name, cause in CAUSES.items() if name in EFFECTS)


def test_an_unlikely_cause_is_no_headline():
    doubtful = replace(one_effect(), probabilities={"partial_slip": 0.44, "static_ageing": 0.31})
    assert headline(doubtful) == "Something differs in friction"
    assert verdict_sentence(doubtful) == (
        "Something differs in friction; it may be partial slip (44 %) or static ageing (31 %)."
    )


def test_what_the_table_of_stages_contradicts_is_no_headline():
    same = replace(one_effect(), stages=one_effect().stages | {"friction": SLIGHT})
    assert headline(same) == "Something differs in friction"
    assert "although friction does not differ" in verdict_sentence(same)


def test_the_place_says_channel_band_phase_and_condition_and_other_stages_that_differ():
    assert location_sentence(one_effect()) == (
        "The gap shows in the friction (71 % of the gap, p = 0.0004): in the torque, below "
        "1.8 kHz, while the contact sticks, where speed ≥ 2.5 rad/s. It shows in the structure "
        "(15 % of the gap, p = 0.031) as well."
    )
    slight = replace(one_effect(), location=replace(one_effect().location, p_value=0.6))
    assert location_sentence(slight).startswith("The gap shows in the structure (15 % of the gap")
    assert "It may show in the friction" in location_sentence(slight)


def test_one_of_five_intervals_that_just_misses_one_is_no_difference():
    agreeing = {f"agreeing_{i}": (0.94, 1.06) for i in range(4)}
    assert parameters_off(agreeing | {"elastomer_inertia": (0.871, 0.998)}) == {}
    assert list(parameters_off(agreeing | {"damping": (1.12, 1.16)})) == ["damping"]


@given(st.lists(st.floats(0.3, 300.0), min_size=1, max_size=6), st.booleans())
def test_a_rig_file_describes_the_recordings_that_are_near(gaps, explained):
    found = tuple(Agreement(f"run{i}", 1.0, 2.79e-4, gap, {}) for i, gap in enumerate(gaps))
    sentence = agreement_sentence(replace(none() if explained else one_effect(), agreement=found))
    near = sum(gap <= AGREES for gap in gaps)
    assert ("Farthest is" in sentence) == (near < len(gaps))
    counted = f"describes {near or 'none'} of {len(gaps)} recordings" in sentence
    assert counted == (near < len(gaps))
    assert "nan" not in sentence


@pytest.mark.parametrize(
    ("figures", "words"),
    [
        ({"closed": -0.4}, "The fit explains nothing of the deviation beyond that of repeats."),
        ({"closed": None}, "How much the fit explains is not known. Held-out"),
        ({"closed": 0.6, "closed_low": 0.2, "closed_high": 1.4}, "(90 % interval 20 % to 100 %)"),
    ],
)  # fmt: skip
def test_a_fit_that_closes_nothing_is_said_to(figures, words):
    found = replace(one_effect().effects[0], gap_before=3.0, gap_after=3.4, **figures)
    assert words in fit_sentence(found)


@given(st.floats(0.0, 1.0))
def test_only_impossible_and_certain_are_written_as_0_and_100_per_cent(share):
    assert (percent(share) == "100 %") == (share == 1.0)
    assert (percent(share) == "0 %") == (share == 0.0)


def test_a_gap_below_that_of_repeats_is_not_more_than_they_differ_by():
    sentence = verdict_sentence(replace(none(), gap=0.66, p_value=0.001))
    assert "as repeats do" in sentence
    assert "more than" not in sentence


def test_a_gap_without_a_likely_cause_names_what_the_table_has_first():
    chances = {"partial_slip": 0.47, "none": 0.43, "parameters": 0.04}
    sentence = verdict_sentence(replace(none(), gap=1.31, p_value=0.005, probabilities=chances))
    assert "it may be partial slip (47 %) or chance (43 %)" in sentence


def test_a_fit_whose_interval_holds_nothing_says_so():
    effect = replace(one_effect().effects[0], closed=0.06, closed_low=-0.01, closed_high=0.13)
    assert "which may be nothing" in fit_sentence(effect)
