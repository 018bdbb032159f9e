"""What follows from a label table: joined again, as a map of conditions."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest

from models.errors import RecordingError
from noise.base.tables import write_table
from noise.cli import main
from noise.labels.conditions import conditions_map
from noise.labels.table import COLUMNS, read_label_table
from noise.pictures.conditions import plot_conditions


def row(file="a.wav", label="creak", speed=5.0, fit=0.279, support=2214.0, **more):
    known = {
        "file": file, "channel": "all", "start_s": 0.0, "end_s": 1.5, "label": label,
        "speed_rad_s": speed, "interference_mm": fit, "support_stiffness_Nm_rad": support,
        "support_stiffness_Nm_rad_source": "missing" if support is None else "logged",
        "calibrated": True, "material": "PDMS",
    }  # fmt: skip
    return dict.fromkeys(COLUMNS) | known | more


TABLE = [
    row(),
    row("day1/b.wav", "squeal", support=math.inf),
    row("day1/b.wav", "none", start_s=1.5, end_s=2.0, support=math.inf),
    row("c.wav", "unknown", None, None, None, material=None),
    dict.fromkeys(COLUMNS) | {"file": "d.wav", "error": "is damaged"},
]


@pytest.mark.parametrize("ending", [".csv", ".jsonl", ".parquet", ".xlsx"])
def test_a_table_is_read_back_as_it_was_written(tmp_path, ending):
    path = tmp_path / f"labels{ending}"
    write_table(path, COLUMNS, TABLE)
    back = read_label_table(path)
    assert [{k: v for k, v in r.items() if k != "calibrated"} for r in back] == [
        {k: v for k, v in r.items() if k != "calibrated"} for r in TABLE
    ]
    assert [r["calibrated"] for r in back] == [True] * 4 + [None]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("t.csv", b"a,b\n1,2\n", "no column 'file'"),
        ("t.csv", b"file,label\na.wav,dog\n", "row 1 has label 'dog'"),
        ("t.csv", b"file,label,start_s\na.wav,none,soon\n", "start_s 'soon', expected a number"),
        ("t.csv", b"\xff\xfe\x00", "is damaged"),
        ("t.jsonl", b"[1]\n", "row 1 lacks file"),
        ("t.jsonl", b"{", "is damaged"),
        ("t.parquet", b"PAR1", "is damaged"),
    ],
)
def test_what_is_no_label_table_is_refused_with_the_reason(tmp_path, name, content, said):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RecordingError, match=said):
        read_label_table(tmp_path / name)


def test_jitter_of_the_logged_speed_does_not_split_a_place_but_a_step_does():
    rows = [row(speed=v) for v in (4.97, 5.0, 5.02, -5.01, 6.0, 12.0)]
    assert [sum(p.segments.values()) for p in conditions_map(rows)] == [4, 1, 1]


def test_the_picture_shows_each_count_and_a_panel_for_each_support():
    figure = plot_conditions(conditions_map(TABLE), title="all")
    titles = [axes.get_title("left") for axes in figure.axes]
    assert titles == [
        "PDMS, 2214 Nm/rad",
        "PDMS, clamp fixed",
        "material not known, support not known",
    ]
    assert [text.get_text() for text in figure.axes[1].texts] == ["1", "1"]


def test_a_map_comes_from_a_table_without_labelling(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_table("one.jsonl", COLUMNS, TABLE[:1])
    write_table("two.csv", COLUMNS, TABLE[1:])
    given = ["one.jsonl", "two.csv", "--map", "m/map.png"]
    assert main(["label", *given, "--out", "both.csv"]) == 0
    out, _ = capsys.readouterr()
    assert out.split() == [str(Path(p)) for p in ("both.csv", "m/map.png", "m/map.csv")]
    assert read_label_table(Path("both.csv")) == read_label_table(Path("one.jsonl")) + (
        read_label_table(Path("two.csv"))
    )
    with Path("m/map.csv").open() as file:
        assert [r["label"] for r in csv.DictReader(file)] == ["creak", "squeal", "unknown"]
    assert Path("m/map.png").read_bytes()[:4] == b"\x89PNG"


def test_a_table_without_labels_has_no_map(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_table("t.csv", COLUMNS, TABLE[-1:])
    assert main(["label", "t.csv", "--map", "m.png"]) == 0
    assert "no segment is labelled" in capsys.readouterr().err
    assert not Path("m.png").exists()
