"""The report of a diagnosis as files."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.diagnosis.outcome import Diagnosis, Illustration, StageFinding, as_json
from noise.diagnosis.sentences import verdict_sentence
from noise.pages.diagnosis import likely_causes, parameter_rows, waterfall, write_diagnosis
from tests.helpers.made_diagnoses import (
    KINDS,
    none,
    one_effect,
    pair,
    parameters,
    unknown,
)

RATE = 30_000


def tone(amplitude, seconds=0.2, frequency=1000.0):
    t = np.arange(round(seconds * RATE)) / RATE
    signal = amplitude * np.sin(2.0 * np.pi * frequency * t)
    return Recording(signal[np.newaxis], RATE, (Channel("pressure"),))


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_says_the_verdict_and_the_data_are_beside_it(kind, tmp_path):
    diagnosis = KINDS[kind]()
    write_diagnosis(tmp_path / "new" / "out", diagnosis)
    page = (tmp_path / "new" / "out" / "report.html").read_text(encoding="utf-8")
    words = verdict_sentence(diagnosis).replace(" %", "\u00a0%").replace("p = ", "p\u00a0=\u00a0")
    assert f'<p class="verdict">{words}</p>' in page
    data = json.loads((tmp_path / "new" / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert data == as_json(diagnosis)


@pytest.mark.parametrize("hindered", ["report.html", "diagnosis.json"])
def test_where_one_file_cannot_be_written_neither_is(hindered, tmp_path):
    (tmp_path / hindered).mkdir()
    with pytest.raises(ParameterError, match=hindered):
        write_diagnosis(tmp_path, none())
    assert [path.name for path in tmp_path.iterdir()] == [hindered]


def test_names_cannot_bring_markup_or_scripts_into_the_page(tmp_path):
    bad = "</h3><script>alert(1)</script>"
    hostile = replace(
        pair(), notes=(bad,), next_measurement=bad, held_out=(bad,), verdict=(bad,),
        illustrations=(Illustration(bad, tone(1.0), tone(1.0), None),),
    )  # fmt: skip
    write_diagnosis(tmp_path, hostile)
    assert "<script>alert" not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_diagnosis_of_which_nothing_is_known_is_said_to_be_undetermined(tmp_path):
    empty = Diagnosis(
        ("unknown",), (), None, {"drive": StageFinding(math.nan, math.nan, math.nan)}, (), {}, {},
        "", (), math.nan, math.nan, math.nan, math.nan,
    )  # fmt: skip
    write_diagnosis(tmp_path, empty)
    page = (tmp_path / "report.html").read_text("utf-8")
    text = re.sub(r"<(style|script)\b.*?</\1>", "", page, flags=re.S)  # what code says is not read
    assert "nan" not in re.sub(r"<[^>]*>", " ", text).lower().replace("determinan", "").split()
    assert text.count("not determined") >= 8


@pytest.mark.parametrize("made", [one_effect, pair, unknown, parameters])
def test_each_bar_begins_where_the_one_above_ends(made):
    whole, *steps, left = (cell.bars[0] for _, cell in waterfall(made())[0].rows)
    gap = whole.width
    for step in steps:
        assert step.look == "cause"
        assert step.left + step.width == pytest.approx(gap)
        gap = step.left
    assert (left.left, left.width) == (0.0, pytest.approx(gap))


def test_the_verdict_leads_the_causes_and_all_are_counted():
    chances, more = likely_causes(one_effect())
    first, *rest = chances
    assert first == "partial_slip"
    assert [chances[name] for name in rest] == sorted((chances[k] for k in rest), reverse=True)
    assert len(chances) + more == len(one_effect().probabilities)
    assert more > 0


def test_a_parameter_is_off_only_where_its_interval_excludes_one():
    rows = parameter_rows({"a": (0.9, 1.1), "b": (1.02, 1.1), "c": (0.8, 0.97)})
    assert [words == "differs" for _, _, words in rows] == [False, True, True]


def test_an_interval_that_just_misses_one_is_not_said_to_agree():
    agreeing = {f"agreeing_{i}": (0.94, 1.06) for i in range(4)}
    *same, last = parameter_rows(agreeing | {"elastomer_inertia": (0.871, 0.998)})
    assert {words for _, _, words in same} == {"agrees with the rig file"}
    assert last[2] == "no clear difference"


def test_the_changes_of_a_gap_are_those_of_the_figures_shown():
    found = replace(
        one_effect().effects[0], gap_before=4.906, gap_recalibrated=4.814, gap_after=1.118
    )
    table, *_ = waterfall(replace(one_effect(), effects=(found,)))
    assert [cell.text for _, cell in table.rows][:3] == [
        "4.91", "4.81 (0.10 less)", "1.12 (3.69 less)",
    ]  # fmt: skip


@pytest.mark.parametrize("p_value", [0.0004, 0.06])
def test_the_place_of_the_sentences_has_a_row_in_the_details(p_value, tmp_path):
    place = replace(one_effect().location, stage="structure", p_value=p_value)
    write_diagnosis(tmp_path, replace(one_effect(), location=place))
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    details = page.partition("Where it differs most surely")[2].partition("</table>")[0]
    assert "structure" in details
    assert ("not certain" in details) == (p_value > 0.05)
