"""A diagnosis in words."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.diagnosis.outcome import Agreement, Location, Remainder, StageFinding
from noise.diagnosis.text.sentences import (
    agreement_sentence,
    answer,
    fit_sentence,
    location_sentence,
    strength_sentence,
)
from noise.diagnosis.text.verdict_sentences import (
    AGREES,
    headline,
    parameters_off,
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
        "(0.92 times as much as repeats, p = 0.61)."
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
    slight = replace(slight, stages=dict.fromkeys(slight.stages, SLIGHT))
    sentence = location_sentence(slight)
    assert sentence.startswith("The gap shows most in the friction")
    assert sentence.endswith("; though repeats often differ as much there.")


def test_a_gap_does_not_begin_where_the_named_effect_does_not_act():
    elsewhere = replace(one_effect(), location=replace(one_effect().location, stage="structure"))
    sentence = location_sentence(elsewhere)
    start = "As what acts in the friction can, the gap shows in the structure (15 % of the gap, p"
    assert sentence.startswith(start)
    assert "begins" not in sentence


BLOW = replace(
    one_effect(),
    verdict=("slip_pulse",),
    location=Location("structure", ("acceleration",), (2.8e3, 1e4), "all", "all", 0.06),
    stages=dict.fromkeys(one_effect().stages, SLIGHT)
    | {"structure": StageFinding(3.5, 0.03, 0.06), "radiation": StageFinding(13.4, 0.78, 0.02)},
    differences=(Location("radiation", ("pressure",), (2.8e3, 4e3), "all", "all", 0.02),),
    effects=(replace(one_effect().effects[0], name="slip_pulse", stage="structure"),),
)
"""Differs surely in another stage than its effect acts in, as that of the README."""


def test_the_stage_that_surely_differs_comes_first_with_its_own_channel_and_figures():
    assert location_sentence(BLOW) == (
        "The gap shows in the radiation (78 % of the gap, p = 0.020): in the pressure, 2.8 kHz to "
        "4 kHz. The fit explains that as well. Slip pulse acts in the structure (3 % of the gap, "
        "p = 0.060): in the acceleration, 2.8 kHz to 10 kHz; about 1 in 17 sets of repeats "
        "differs as much there."
    )


def test_the_second_largest_stage_is_named_beside_a_smaller_one():
    stages = BLOW.stages | {"measurement": StageFinding(7.04, 0.19, 0.055)}
    sentence = location_sentence(replace(BLOW, stages=stages))
    assert "Slip pulse acts in the structure (3 % of the gap, p = 0.060)" in sentence
    assert sentence.endswith(
        "What shows in the measurement (19 % of the gap, p = 0.055) is uncertain."
    )


def test_a_stage_with_more_of_the_gap_is_said_beside_a_sure_one():
    sure = replace(BLOW, location=replace(BLOW.location, p_value=0.004))
    said = location_sentence(sure)
    assert said.startswith("The gap begins in the structure (3 % of the gap, p = 0.060): in the")
    assert "Most of it shows in the radiation (78 % of the gap, p = 0.020)" in said


@pytest.mark.parametrize(
    ("changed", "meaning"),
    [
        ({"effects": (), "held_out": ()}, "Only a fit tells whether slip pulse explains that"),
        ({"remainder": Remainder(3.0, ("pressure",), (1e3, 4e3))}, "The fit leaves a gap, so"),
        ({"verdict": ("shaft_compliance",), "effects": (), "stages": one_effect().stages,
          "location": Location("drive", ("angle",), (0.0, 1800.0), "all", "all", 0.35)},
         "as it can where something acts in the drive. Shaft compliance acts in the drive"),
    ],
)  # fmt: skip
def test_what_a_difference_in_another_stage_means_depends_on_the_fit(changed, meaning):
    sentence = location_sentence(replace(BLOW, **changed))
    assert meaning in sentence
    assert ("missing" in sentence) == ("remainder" in changed)


def test_a_strength_is_said_to_be_of_the_form_that_was_fitted():
    fitted = replace(
        BLOW.effects[0], parameters={"form": "exponential", "amplitude": 104.7}, strength=(68, 161)
    )
    assert strength_sentence(fitted) == (
        "Slip pulse as fitted: amplitude 68 to 161 N (form exponential), a 90 % interval that "
        "allows for other forms. The effect's other numbers can shift it further."
    )


def test_one_of_five_intervals_that_just_misses_one_is_no_difference():
    agreeing = {f"agreeing_{i}": (0.94, 1.06) for i in range(4)}
    assert parameters_off(agreeing | {"elastomer_inertia": (0.871, 0.998)}) == {}
    assert list(parameters_off(agreeing | {"damping": (1.12, 1.16)})) == ["damping"]


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
    assert ", most in the torque (" in sentence
    assert sentence.endswith("All recordings together deviate 7.9 times as much (p = 0.0004).")


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
    diagnosis = replace(none(), agreement=found)
    sentence = agreement_sentence(diagnosis)
    assert sentence.startswith("The rig file describes the rig")
    assert "not describe" not in sentence
    assert ("is chance" in sentence) == (max(gaps) > AGREES)


def test_the_place_says_channel_band_phase_and_condition():
    assert location_sentence(one_effect()) == (
        "The gap begins in the friction (71 % of the gap, p = 0.0004): in the torque, below "
        "1.8 kHz, while the contact sticks, where speed ≥ 2.5 rad/s; repeats would hardly ever "
        "differ as much."
    )


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
    assert fit_sentence(found).endswith("times as much as repeats without it, 3.40 times with it.")


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
