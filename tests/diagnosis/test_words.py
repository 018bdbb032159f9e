"""A diagnosis in words."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.diagnosis.text.sentences import (
    closed_sentence,
    equivalence_sentences,
    headline,
    location_sentence,
    verdict_sentence,
)
from noise.diagnosis.text.words import (
    CAUSES,
    STAGES,
    chance,
    evidence,
    frequency,
    p_number,
    percent,
)
from sim.effects import EFFECTS
from sim.effects.effect import Stage
from tests.helpers.made_diagnoses import (
    none,
    one_effect,
    pair,
    parameters,
    pressure_alone,
    unknown,
)


def test_every_shipped_effect_has_a_description_and_nothing_else_has_one():
    assert set(CAUSES) == set(EFFECTS) | {"none", "parameters", "unknown"}


def test_descriptions_differ_and_are_clauses():
    clauses = [cause.clause for cause in CAUSES.values()]
    assert len(set(clauses)) == len(clauses)
    assert not any(clause.endswith(".") or clause[0].isupper() for clause in clauses)


def test_every_stage_is_described_in_the_order_of_the_chain():
    assert list(STAGES) == list(Stage)


def test_no_gap_is_said_to_need_no_explanation():
    assert headline(none()) == "No gap"
    assert verdict_sentence(none()) == (
        "Recordings and simulation differ no more than repeats do: there is nothing to explain "
        "(gap 0.92, floor 1, p = 0.61)."
    )
    assert location_sentence(none()) == ""


def test_parameters_are_named_with_how_far_they_are_off():
    assert verdict_sentence(parameters()) == (
        "No effect is missing; values of the rig file are off (very likely, 95 %): critical torque "
        "comes out 12 to 16 % higher and damping comes out 7 to 19 % lower."
    )


def test_parameters_whose_intervals_hold_one_are_not_named():
    within = replace(parameters(), parameters={"damping": (0.9, 1.1)})
    assert verdict_sentence(within).endswith("are off (very likely, 95 %).")


def test_one_effect_is_named_with_what_it_does_and_how_likely_it_is():
    assert headline(one_effect()) == "Missing: partial slip"
    assert verdict_sentence(one_effect()) == (
        "The simulation lacks partial slip: the contact creeps before it slips, and so lets go "
        "gradually (very likely, 96 %)."
    )


def test_each_effect_of_several_has_its_own_probability():
    sentence = verdict_sentence(pair())
    assert sentence.startswith("The simulation lacks two effects: partial slip (")
    assert (
        "; very likely, 91 %) and further trouble (an effect of your own; likely, 78 %)."
        in sentence
    )


def test_unknown_names_no_effect():
    sentence = verdict_sentence(unknown())
    assert "its cause is unknown (likely, 88 %)" in sentence
    assert not any(cause.name in sentence for name, cause in CAUSES.items() if name in EFFECTS)


def test_a_probability_that_is_not_known_is_not_said():
    silent = replace(unknown(), probabilities={})
    assert verdict_sentence(silent).endswith("its cause is unknown.")


def test_the_place_says_channel_band_phase_and_condition():
    assert location_sentence(one_effect()) == (
        "The gap begins in the friction, in the channel torque, below 1.8 kHz, while the contact "
        "sticks, where speed ≥ 2.5 rad/s; repeats would hardly ever differ as much (p = 0.0004)."
    )
    assert "40 Hz to 160 Hz, in all conditions" in location_sentence(pressure_alone())


def test_what_was_not_fitted_closes_nothing_in_words():
    assert closed_sentence(pressure_alone().effects[0]) == ""


def test_effects_that_cannot_be_told_apart_are_declared():
    assert equivalence_sentences(one_effect()) == [
        "These channels cannot tell partial slip from amplitude softening."
    ]


@given(st.floats(0.0, 1.0))
def test_only_impossible_and_certain_are_written_as_0_and_100_per_cent(share):
    assert (percent(share) == "100 %") == (share == 1.0)
    assert (percent(share) == "0 %") == (share == 0.0)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_larger_probability_never_gets_a_smaller_word(one, other):
    words = ["exceptionally unlikely", "very unlikely", "unlikely", "about as likely as not",
             "likely", "very likely", "virtually certain"]  # fmt: skip
    low, high = (words.index(chance(p).partition(",")[0]) for p in sorted((one, other)))
    assert low <= high


@pytest.mark.parametrize("wrong", [-0.1, 1.1, math.nan])
def test_a_number_that_is_no_probability_is_refused(wrong):
    with pytest.raises(ParameterError, match="between 0 and 1"):
        chance(wrong)


def test_a_p_value_that_was_not_determined_is_no_evidence():
    assert evidence(math.nan) == "not determined"
    assert p_number(math.nan) == "p not determined"
    assert evidence(0.2) == "repeats differ as much"


def test_frequencies_are_read_in_the_unit_that_suits_them():
    assert (frequency(999.0), frequency(12_500.0)) == ("999 Hz", "12.5 kHz")
