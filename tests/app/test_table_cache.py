"""The label table as the app writes it again: as whoever opens it beside the app has it."""

from __future__ import annotations

import datetime as dt

import pytest

from noise.app.labels.summary import plain
from noise.app.labels.table_cache import TableCache
from noise.base.tables import write_table
from noise.labels.labelling import COLUMNS
from noise.labels.table import read_label_table
from tests.helpers.labelled_folder import made_row

ROWS = [
    made_row("a.wav", level_dba=-3.5) | {"own": -0.25, "remark": "left; door, 1"},
    made_row("b.wav", level_dba=62.5) | {"own": 1e-7, "remark": None},
]


@pytest.mark.parametrize("form", ["\ufefffile;x\r\n1;0,5\r\n", "\ufefffile,x\r\n", "file,x\n"])
def test_a_table_stays_as_excel_opens_it_but_for_what_is_corrected(tmp_path, form):
    path = tmp_path / "labels.csv"
    path.write_bytes(form.encode())
    write_table(path, (*COLUMNS, "own", "remark"), ROWS)
    before = path.read_bytes()
    table = TableCache(path)
    first, second = table.read()
    table.write([first, second | {"level_dba": 61.5}])
    assert path.read_bytes() == before.replace(b"62", b"61")
    assert [row["level_dba"] for row in read_label_table(path)] == [-3.5, 61.5]


def test_a_workbook_stays_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    path = tmp_path / "labels.xlsx"
    write_table(path, (*COLUMNS, "own", "remark"), ROWS)
    table = TableCache(path)
    first, second = table.read()
    table.write([first, second | {"level_dba": 61.5}])
    head, _, row = openpyxl.load_workbook(path).active.iter_rows(values_only=True)
    assert dict(zip(head, row, strict=True))["level_dba"] == 61.5
    assert dict(zip(head, row, strict=True))["own"] == 1e-7


def test_a_workbook_of_ones_own_keeps_its_dates_and_columns(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    day = dt.datetime(2026, 3, 1, 10, 5)
    book = openpyxl.Workbook()
    book.active.append(["file", None, "label", "driven"])
    book.active.append(["a.wav", None, "creak", day])
    book.save(path := tmp_path / "labels.xlsx")
    table = TableCache(path)
    (row,) = table.read()
    assert plain([row])[0]["driven"] == "2026-03-01 10:05:00"
    table.write([row | {"label": "squeal"}])
    (row,) = table.read()
    assert (row["label"], row["driven"]) == ("squeal", day)


def test_what_is_true_in_excel_is_true(tmp_path):
    path = tmp_path / "labels.csv"
    path.write_text("file,label,calibrated\na.wav,creak,TRUE\nb.wav,creak,FALSE\n")
    assert [row["calibrated"] for row in read_label_table(path)] == [True, False]
