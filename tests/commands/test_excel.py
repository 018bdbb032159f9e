"""Tables that a spreadsheet opens: every command that writes one, and nothing infinite in any."""

import csv
import re

import pytest

from noise.cli import main

CONDITIONS = ["--speed", "1..12/3", "--support-stiffness", "2214,fixed", "--interference", "0.279"]
COMMANDS = {
    "label": (["label", "run.wav", "fixed.wav", "--out", "t.csv"], "t.csv"),
    "features": (["features", "run.wav", "--out", "f.csv"], "f.csv"),
    "render": (["render", "run.wav", "fixed.wav", "--out", "set"], "set/levels.csv"),
    "simulate": (["simulate", "--speed", "5", "--sound-power", "p.csv"], "p.csv"),
    "map": (["label", "run.wav", "fixed.wav", "--out", "l.csv", "--map", "m.png"], "m.csv"),
    "screen": (["screen", "PDMS", *CONDITIONS, "--sounds", "0", "--out", "s"], "s/map.csv"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("excel")
    simulate = ["simulate", "--speed", "5", "--seconds", "0.6", "--out"]
    assert main([*simulate, str(folder / "run")]) == 0
    assert main([*simulate, str(folder / "fixed"), "--support-stiffness", "fixed"]) == 0
    return folder


@pytest.mark.parametrize("command", COMMANDS)
def test_every_table_that_a_german_excel_saved_stays_so(command, folder, monkeypatch):
    monkeypatch.chdir(folder)
    call, table = COMMANDS[command]
    (folder / table).parent.mkdir(exist_ok=True)
    (folder / table).write_bytes("\ufefffile;label;x\r\nrun.wav;none;0,5\r\n".encode())
    assert main(call) == 0
    content = (folder / table).read_bytes()
    assert content.startswith(b"\xef\xbb\xbf")
    header, *rows = csv.reader(content.decode("utf-8-sig").splitlines(), delimiter=";")
    assert rows
    assert {len(row) for row in rows} == {len(header)}
    cells = [cell for row in rows for cell in row]
    assert any(re.fullmatch(r"-?\d+,\d+", cell) for cell in cells)
    assert not any(re.fullmatch(r"-?\d+\.\d+", cell) for cell in cells)


@pytest.mark.parametrize(
    "command",
    [pytest.param(one, marks=[pytest.mark.slow] * (one == "simulate")) for one in COMMANDS],
)
def test_no_number_of_a_table_is_infinite(command, folder, monkeypatch):
    monkeypatch.chdir(folder)
    call, table = COMMANDS[command]
    assert main(call) == 0
    for path in {folder / table, *(folder / table).parent.glob("*.csv")}:
        cells = re.split(r"[,;\n]", path.read_text(encoding="utf-8-sig"))
        assert not [cell for cell in cells if re.fullmatch(r"[+-]?(inf|nan)\w*", cell, re.I)]


def test_a_workbook_holds_numbers_and_logged_speeds_as_they_were_logged(folder, monkeypatch):
    openpyxl = pytest.importorskip("openpyxl")
    monkeypatch.chdir(folder)
    assert main(["label", "run.wav", "fixed.wav", "--out", "t.xlsx"]) == 0
    header, *rows = openpyxl.load_workbook(folder / "t.xlsx").active.iter_rows(values_only=True)
    first, second = (dict(zip(header, row, strict=True)) for row in rows)
    assert first["speed_rad_s"] == second["speed_rad_s"] == 5
    assert isinstance(first["level_dba"], float)
    assert {first["support_stiffness_Nm_rad"], second["support_stiffness_Nm_rad"]} == {
        "fixed",
        2214,
    }
