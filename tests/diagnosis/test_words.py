"""A diagnosis in words."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.diagnosis.outcome import Agreement, Location, Remainder, StageFinding
from noise.diagnosis.text.sentences import (
    answer,
    closed_sentence,
    location_sentence,
)
from noise.diagnosis.text.verdict_sentences import (
    AGREES,
    agreement_sentence,
    headline,
    verdict_sentence,
)
from noise.diagnosis.text.words import (
    CAUSES,
    chance,
    percent,
)
from sim.effects import EFFECTS
from tests.helpers.made_diagnoses import (
    SLIGHT,
    none,
    one_effect,
    pressure_alone,
    unknown,
)


def test_every_shipped_effect_has_a_description_and_nothing_else_has_one():
    assert set(CAUSES) == set(EFFECTS) | {"none", "parameters", "unknown"}


def test_no_gap_is_said_to_need_no_explanation():
    assert headline(none()) == "No gap"
    assert verdict_sentence(none()) == (
        "Recordings and simulation differ no more than repeats do: there is nothing to explain "
        "(gap 0.92, floor 1, p = 0.61)."
    )
    assert location_sentence(none()) == ""


def test_one_effect_is_named_with_what_it_does_and_how_likely_it_is():
    assert headline(one_effect()) == "Missing: partial slip"
    assert verdict_sentence(one_effect()) == (
        "The simulation lacks partial slip: the contact creeps before it slips, and so lets go "
        "gradually (very likely, 96 %)."
    )


def test_unknown_names_no_effect():
    sentence = verdict_sentence(unknown())
    assert sentence == (
        "Something differs in friction while the contact sticks; none of the known effects closes "
        "it: the cause is unknown (likely, 88 %)."
    )
    assert not any(cause.name in sentence for name, cause in CAUSES.items() if name in EFFECTS)


def test_an_unlikely_cause_is_no_headline():
    doubtful = replace(one_effect(), probabilities={"partial_slip": 0.44, "static_ageing": 0.31})
    assert headline(doubtful) == "Something differs in friction"
    assert verdict_sentence(doubtful) == (
        "Something differs in friction; it may be partial slip (44 %) or static ageing (31 %)."
    )


def test_what_a_fit_closes_is_not_said_to_be_closed_by_none():
    (found,) = unknown().effects
    closed = replace(unknown(), effects=(replace(found, closed_by_effect=0.8),))
    assert "none of the known effects looks like it" in verdict_sentence(closed)


def test_what_the_table_of_stages_contradicts_is_no_headline():
    same = replace(one_effect(), stages=one_effect().stages | {"friction": SLIGHT})
    assert headline(same) == "Something differs in friction"
    assert "although friction does not differ" in verdict_sentence(same)


def test_a_place_where_repeats_differ_as_much_is_no_beginning():
    slight = replace(one_effect(), location=replace(one_effect().location, p_value=0.6))
    assert location_sentence(slight).startswith("It shows most in the friction")
    assert "; though there alone repeats differ as much (p = 0.60)." in location_sentence(slight)


def test_a_gap_does_not_begin_where_the_named_effect_does_not_act():
    elsewhere = replace(one_effect(), location=replace(one_effect().location, stage="structure"))
    said = location_sentence(elsewhere)
    assert said.startswith("It shows in the structure, as what acts in the friction can, in the ch")
    assert "begins" not in said


def test_a_surer_stage_than_that_of_the_named_effect_is_said():
    drive = Location("drive", ("angle",), (0.0, 1800.0), "all", "all", 0.35)
    stages = one_effect().stages | {"drive": SLIGHT}
    compliant = replace(
        one_effect(), verdict=("shaft_compliance",), location=drive, stages=stages, effects=()
    )
    assert "What differs surely is the friction" in location_sentence(compliant)
    assert "What differs surely" not in location_sentence(one_effect())


def test_a_surer_stage_in_which_nothing_acts_that_is_named_is_said():
    place = Location("structure", ("acceleration",), (4e3, 1e4), "all", "all", 0.09)
    stages = dict.fromkeys(one_effect().stages, SLIGHT) | {"radiation": StageFinding(9, 0.8, 0.03)}
    blow = replace(one_effect(), verdict=("slip_pulse",), location=place, stages=stages, effects=())
    said = "What differs surely is the radiation (p = 0.030), in which nothing acts that is named"
    assert said in location_sentence(blow)


def test_a_fit_that_leaves_nothing_explains_the_other_stages_too():
    """No sentence says that something else is missing where nothing is left."""
    place = Location("structure", ("acceleration",), (4e3, 1e4), "all", "all", 0.09)
    stages = dict.fromkeys(one_effect().stages, SLIGHT) | {"radiation": StageFinding(9, 0.8, 0.03)}
    (finding, *_) = one_effect().effects
    blow = replace(
        one_effect(),
        verdict=("slip_pulse",),
        location=place,
        stages=stages,
        effects=(replace(finding, name="slip_pulse", stage="structure", closed=0.99),),
        remainder=None,
    )
    said = location_sentence(blow)
    assert said.endswith("the radiation (p = 0.030), which the fit explains as well.")
    assert "missing" not in said


def test_a_quick_answer_says_that_nothing_was_fitted():
    assert answer(pressure_alone())[-1].startswith("Nothing has been fitted")
    assert not any("Nothing has been fitted" in text for text in answer(one_effect()))


def test_what_a_weak_fit_leaves_is_something_else():
    left = Remainder(3.04, ("torque",), (100.0, 450.0))
    (found, *others) = one_effect().effects
    for closed, words in ((0.2, "Missing: partial slip and something else"),
                          (0.9, "Missing: partial slip")):  # fmt: skip
        weak = replace(found, closed_by_effect=closed)
        assert headline(replace(one_effect(), effects=(weak, *others), remainder=left)) == words


def far(name, speed, gap, interference=0.279e-3, **channels):
    return Agreement(name, speed, interference, gap, channels or {"torque": gap, "pressure": 1.0})


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ((far("a", 1.0, 1.1), far("b", 4.0, 3.0)), "not above 1 rad/s"),
        ((far("a", 1.0, 3.0), far("b", 4.0, 1.0)), "not below 4 rad/s"),
        ((far("a", 1.0, 3.0, 0.4e-3), far("b", 1.0, 1.0), far("c", 1.0, 1.1)), "above 0.279 mm"),
        ((far("a", 1.0, 3.0), far("b", 2.0, 1.0), far("c", 3.0, 5.0)), "not at a and c"),
    ],
)
def test_it_is_said_where_the_rig_file_does_not_describe_the_rig(found, words):
    sentence = agreement_sentence(replace(one_effect(), agreement=found))
    assert words in sentence
    assert sentence.endswith("in the torque (all recordings together: 7.9 floors, p = 0.0004).")


@given(st.lists(st.floats(0.3, 300.0), min_size=1, max_size=6))
def test_a_rig_file_describes_the_rig_only_where_every_recording_is_near(gaps):
    found = tuple(far(f"run{i}", 1.0 + i, gap) for i, gap in enumerate(gaps))
    sentence = agreement_sentence(replace(one_effect(), agreement=found))
    near = sentence.startswith("The rig file describes the rig but for a difference that shows")
    assert near == (max(gaps) <= AGREES)
    assert ("does not describe" in sentence) == (min(gaps) > AGREES)
    assert "nan" not in sentence


@given(st.lists(st.floats(0.3, 4.0), min_size=1, max_size=6))
def test_where_nothing_is_to_explain_the_rig_file_describes_the_rig(gaps):
    found = tuple(far(f"run{i}", 1.0 + i, gap) for i, gap in enumerate(gaps))
    sentence = agreement_sentence(replace(none(), agreement=found))
    assert sentence.startswith("The rig file describes the rig")
    assert "not describe" not in sentence
    assert ("is chance" in sentence) == (max(gaps) > AGREES)


def test_the_place_says_channel_band_phase_and_condition():
    assert location_sentence(one_effect()) == (
        "The gap begins in the friction, in the channel torque, below 1.8 kHz, while the contact "
        "sticks, where speed ≥ 2.5 rad/s; repeats would hardly ever differ as much (p = 0.0004)."
    )


@pytest.mark.parametrize(
    ("figures", "words"),
    [
        ({"closed": -0.4}, "The fit explains nothing of the deviation: held-out"),
        ({"closed": None}, "How much the fit explains is not known: held-out"),
        ({"closed": 0.6, "closed_by_effect": -0.1, "closed_low": 0.2, "closed_high": 1.4},
         "and nothing of what refitted parameters leave unexplained."),
    ],
)  # fmt: skip
def test_a_fit_that_closes_nothing_is_said_to(figures, words):
    found = replace(one_effect().effects[0], gap_before=3.0, gap_after=3.4, **figures)
    assert words in closed_sentence(found)


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
