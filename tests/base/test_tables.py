from __future__ import annotations

import json
import math

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.base.tables import read_table, table_columns, write_table

COLUMNS = ("file", "level_db", "count", "calibrated", "error")


def read_json_lines(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize("ending", [".csv", ".jsonl", ".parquet", ".xlsx"])
def test_no_text_controls_what_it_is_shown_on(tmp_path, ending):
    rows = [{"file": "\x1b[2J\a.wav"}, {"file": "\udcff\n.wav"}]
    write_table(tmp_path / f"t{ending}", ["file"], rows)
    _, found = read_table(tmp_path / f"t{ending}")
    assert [row["file"] for row in found] == [r"\x1b[2J\x07.wav", r"\xff\x0a.wav"]


@given(st.floats())
def test_finite_numbers_come_back_as_they_were_and_others_are_none(tmp_path_factory, value):
    folder = tmp_path_factory.mktemp("tables")
    for name in ("t.csv", "t.jsonl"):
        write_table(folder / name, ["x"], [{"x": value, "y": 0}])
    text = (folder / "t.csv").read_text().splitlines()[1].strip('"')
    of_json = read_json_lines(folder / "t.jsonl")[0]["x"]
    if math.isfinite(value):
        assert float(text) == of_json == value
    else:
        assert (text, of_json) == ("", None)


@pytest.mark.parametrize("name", ["t.ods", "t", "t.json", "."])
def test_other_endings_are_refused(tmp_path, name):
    with pytest.raises(ParameterError, match=r"\.csv, \.xlsx, \.jsonl or \.parquet"):
        write_table(tmp_path / name, ["a"], [])


NAMES = ("=1+1.wav", "+r.wav", "-2.wav", "@r.wav", "'=r.wav", "ä; 1,5.wav", "'s.wav", r"a\x07b.wav")
LEVELS = [{"file": name, "level_db": 59.9 + n, "count": n} for n, name in enumerate(NAMES)]


@pytest.mark.parametrize("ending", [".csv", ".xlsx", ".parquet", ".jsonl"])
def test_every_format_is_read_as_it_was_written(tmp_path, ending):
    path = tmp_path / f"t{ending}"
    write_table(path, ("file", "level_db", "support_stiffness_Nm_rad"), LEVELS[:-1])
    _, rows = read_table(path)
    assert [row["file"] for row in rows] == list(NAMES[:-1])
    assert [float(row["level_db"]) for row in rows] == [row["level_db"] for row in LEVELS[:-1]]
    assert table_columns(path) == {"file", "level_db", "support_stiffness_Nm_rad"}


def test_a_bolted_clamp_is_fixed_and_any_other_infinity_is_nothing(tmp_path):
    path = tmp_path / "t.csv"
    columns = ("support_stiffness_Nm_rad", "level_db", "label")
    write_table(path, columns, [dict.fromkeys(columns[:2], math.inf) | {"label": "none"}])
    _, (row,) = read_table(path)
    assert (row["support_stiffness_Nm_rad"], row["level_db"] or None) == ("fixed", None)


FORMS = {
    "plain": "file,level_db,count,calibrated,error,own\n",
    "de": "\ufefffile;level_db;count;calibrated;error;own\r\nx;0,5\r\n",
    "en": "\ufefffile,level_db,count,calibrated,error,own\r\n",
    "de-ch": "file;level_db;count;calibrated;error;own\r\nx;0.5\r\n",
}
OWN = {"file": "-2.wav", "level_db": -3.7, "count": 5, "calibrated": True, "error": "=1, 5; x"}


@pytest.mark.parametrize(
    ("form", "line"),
    [
        ("plain", '-2.wav,-3.7,5,true,"\'=1, 5; x",-0.25'),
        ("de", "'-2.wav;-3,7;5;true;\"'=1, 5; x\";-0,25"),
        ("en", "'-2.wav,-3.7,5,true,\"'=1, 5; x\",-0.25"),
        ("de-ch", "'-2.wav;-3.7;5;true;\"'=1, 5; x\";-0.25"),
    ],
)
def test_csv_is_written_over_another_in_its_form_and_without_a_formula(tmp_path, form, line):
    path, columns = tmp_path / "t.csv", [*COLUMNS, "own"]
    path.write_bytes(FORMS[form].encode())
    write_table(path, columns, [OWN | {"own": own} for own in (-0.25, 1e-7, None)])
    before = path.read_bytes()
    head, *_ = FORMS[form].partition("file")
    assert before.decode().startswith(f"{head}file")
    assert line.removeprefix("'") in before.decode()
    _, rows = read_table(path, numbers=["level_db", "own"])
    assert [float(row["own"] or 0) for row in rows] == [-0.25, 1e-7, 0]
    assert {(row["file"], row["error"]) for row in rows} == {("-2.wav", "=1, 5; x")}
    write_table(path, *read_table(path))
    assert path.read_bytes() == before


def test_a_workbook_with_further_sheets_is_not_written_over(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    path = tmp_path / "t.xlsx"
    write_table(path, ["a"], [{"a": 1.0}])
    book = openpyxl.load_workbook(path)
    book.create_sheet("pivot")
    book.save(path)
    saved = path.read_bytes()
    with pytest.raises(ParameterError, match="several sheets"):
        write_table(path, ["a"], [{"a": 2.0}])
    assert path.read_bytes() == saved
