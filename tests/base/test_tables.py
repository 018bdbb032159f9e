from __future__ import annotations

import csv
import json
import math
import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.base.tables import check_table_path, write_table

COLUMNS = ("file", "level_db", "count", "calibrated", "error")
ROWS = [
    {"file": "a, b.wav", "level_db": np.float64(81.25), "count": np.int64(3), "calibrated": True},
    {"file": "bad.wav", "error": "is empty", "count": None, "calibrated": np.bool_(False)},
]


def read_csv(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def read_json_lines(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_all_columns_are_in_every_row_of_a_csv(tmp_path):
    write_table(tmp_path / "t.csv", COLUMNS, ROWS)
    first, second = read_csv(tmp_path / "t.csv")
    assert first == dict(zip(COLUMNS, ("a, b.wav", "81.25", "3", "true", ""), strict=True))
    assert second == dict(zip(COLUMNS, ("bad.wav", "", "", "false", "is empty"), strict=True))


def test_json_lines_keep_the_types(tmp_path):
    write_table(tmp_path / "t.jsonl", COLUMNS, ROWS)
    first, second = read_json_lines(tmp_path / "t.jsonl")
    assert first == dict(zip(COLUMNS, ("a, b.wav", 81.25, 3, True, None), strict=True))
    assert second == dict(zip(COLUMNS, ("bad.wav", None, None, False, "is empty"), strict=True))


def test_parquet_keeps_the_types(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    write_table(tmp_path / "t.parquet", COLUMNS, ROWS)
    first, second = parquet.read_table(tmp_path / "t.parquet").to_pylist()
    assert first == dict(zip(COLUMNS, ("a, b.wav", 81.25, 3, True, None), strict=True))
    assert second == dict(zip(COLUMNS, ("bad.wav", None, None, False, "is empty"), strict=True))


def test_a_table_without_rows_has_its_columns(tmp_path):
    write_table(tmp_path / "t.csv", COLUMNS, [])
    assert (tmp_path / "t.csv").read_text().strip() == ",".join(COLUMNS)


def test_a_table_without_a_path_goes_to_standard_output(capsys):
    write_table(None, ["a", "b"], [{"a": 1.5, "c": "left out"}])
    assert capsys.readouterr().out == "a,b\n1.5,\n"


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


def test_names_that_are_no_text_are_still_written(tmp_path):
    name = b"run\xff.wav".decode("utf-8", "surrogateescape")
    for table in ("t.csv", "t.jsonl"):
        write_table(tmp_path / table, ["file"], [{"file": name}])
    assert read_csv(tmp_path / "t.csv")[0]["file"] == "run\\udcff.wav"
    assert "run" in (tmp_path / "t.jsonl").read_text(encoding="utf-8")


def test_the_ending_decides_in_either_case_and_folders_are_made(tmp_path):
    target = tmp_path / "new" / "T.JSONL"
    write_table(target, ["a"], [{"a": 1}])
    assert read_json_lines(target) == [{"a": 1}]


@pytest.mark.parametrize("name", ["t.xlsx", "t", "t.json", "."])
def test_other_endings_are_refused(tmp_path, name):
    with pytest.raises(ParameterError, match=r"\.csv, \.jsonl or \.parquet"):
        write_table(tmp_path / name, ["a"], [])
    with pytest.raises(ParameterError):
        check_table_path(tmp_path / name)


def test_a_folder_is_no_table(tmp_path):
    (tmp_path / "t.csv").mkdir()
    with pytest.raises(ParameterError, match="is a folder"):
        check_table_path(tmp_path / "t.csv")


def test_missing_pyarrow_is_told_with_the_command_that_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ParameterError) as refusal:
        check_table_path(tmp_path / "t.parquet")
    assert 'pip install "bushing-noise[parquet]"' in str(refusal.value)
    assert not (tmp_path / "t.parquet").exists()


def test_a_table_that_fails_half_way_leaves_the_old_one(tmp_path):
    target = tmp_path / "t.csv"
    target.write_text("old")

    def rows():
        yield {"a": 1}
        raise RuntimeError

    with pytest.raises(RuntimeError):
        write_table(target, ["a"], rows())
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
