"""A label table that somebody has corrected and saved: what a spreadsheet made of it is read.

Each way of saving it is tried by `label` onto it: rows by a person stay, or the call is refused and
nothing is written.
"""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
import soundfile

from noise.base.labels import LABELS
from noise.base.tables import write_table
from noise.cli import main
from noise.labels.segments import Segment
from noise.labels.table import read_label_table

FILES = ("lager.wav", "prüfstand; 1.wav", "łożysko.wav")
OWN = {"lager.wav": "left; door, 1", "prüfstand; 1.wav": "24.12", "łożysko.wav": "1,2"}


@pytest.fixture(scope="module", autouse=True)
def quick():
    """A classifier that names nothing: what it says does not matter here."""

    def label_recording(recording, classifier, **options):
        certain = {label: float(label == "none") for label in LABELS}
        return [
            Segment(
                "all", 0.0, recording.n_samples / recording.rate, "none", certain, 62.5, None, -20.0
            )
        ]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("noise.labels.labelling.label_recording", label_recording)
        yield


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rec")
    noise = 0.01 * np.random.default_rng(0).standard_normal(9600)
    for name in FILES:
        soundfile.write(folder / name, noise, 16000)
    return folder


@pytest.fixture(scope="module")
def labelled(recordings):
    """The table that `label` made, with two of three recordings corrected and a remark beside."""
    table = recordings.parent / "made.csv"
    assert main(["label", str(recordings), "--out", str(table)]) == 0
    rows = read_label_table(table)
    assert [row["file"] for row in rows] == sorted(FILES)
    for row in rows[1:]:
        row |= {"label": "creak", "label_source": "human", "level_dbfs": -41.25}
    return [row | {"own remark": OWN[row["file"]]} for row in rows]


def cells(rows, decimal=".", true="true", false="false"):
    def text(value):
        if isinstance(value, bool):
            return true if value else false
        return str(value).replace(".", decimal) if isinstance(value, float) else str(value or "")

    columns = list(rows[0])
    return [columns, *([text(row[name]) for name in columns] for row in rows)]


def as_csv(lines, separator=",", line_end="\n", quoting=csv.QUOTE_MINIMAL):
    file = io.StringIO(newline="")
    csv.writer(file, delimiter=separator, lineterminator=line_end, quoting=quoting).writerows(lines)
    return file.getvalue()


def plain(rows, *args, head="", encoding="utf-8", **form):
    return (head + as_csv(cells(rows), *args, **form)).encode(encoding)


def german(rows, *args, head="\ufeff", encoding="utf-8", true="WAHR", false="FALSCH", **form):
    lines = cells(rows, ",", true, false)
    text = as_csv(lines, *(args or ";"), **({"line_end": "\r\n"} | form))
    return (head + text).encode(encoding)


def only(rows, *files):
    return [row for row in rows if row["file"] in files]


def headers(rows, change):
    columns, *lines = cells(rows)
    return as_csv([list(map(change, columns)), *lines]).encode()


def changed(rows, column, change):
    return plain([row | {column: change(row[column])} for row in rows])


def reordered(rows):
    return plain([dict(reversed(row.items())) for row in rows])


def with_empty(rows):
    lines = [[*line, "", "", ""] for line in cells(rows)]
    return as_csv(lines + [[""] * len(lines[0])] * 3, ";").encode()


READ = {
    "plain": plain,
    "tabs": lambda rows: plain(rows, "\t"),
    "semicolons": lambda rows: plain(rows, ";"),
    "sep=,": lambda rows: plain(rows, head="sep=,\n"),
    "sep=; of German Excel": lambda rows: german(rows, head="\ufeffsep=;\r\n"),
    "a comment first": lambda rows: plain(rows, head="# J.D., 1 March\n"),
    "a comment as a row": lambda rows: plain(rows, ";", head="# J.D.;;;;;;\n"),
    "empty cells and a comment first": lambda rows: plain(rows, ";", head=";;;;\r\n\r\n#x\r\n"),
    "German Excel, CSV UTF-8": german,
    "German Excel, Unicode text": lambda rows: german(rows, "\t", encoding="utf-16-le"),
    "German Excel, CSV of western Europe": lambda rows: german(
        only(rows, *FILES[:2]), head="", encoding="cp1252"
    ),
    "English Excel": lambda rows: as_csv(
        cells(rows, true="TRUE", false="FALSE"), line_end="\r\n"
    ).encode("utf-8-sig"),
    "LibreOffice, all quoted": lambda rows: plain(rows, quoting=csv.QUOTE_ALL),
    "empty rows at the end": with_empty,
    "other order of columns": reordered,
    "columns in capitals": lambda rows: headers(rows, str.upper),
    "spaces about the columns": lambda rows: headers(rows, " {} ".format),
    "labels with a capital": lambda rows: changed(rows, "label", str.capitalize),
    "signed with a name": lambda rows: changed(
        rows, "label_source", lambda source: source.replace("human", "J.D.")
    ),
    "labels of one's own": lambda rows: plain(
        [{"file": row["file"], "label": row["label"]} for row in rows[1:]]
    ),
}
REFUSED = {
    "a title first": lambda rows: plain(rows, head="Labels of March\n"),
    "column renamed": lambda rows: headers(rows, lambda name: name.replace("label", "Etikett")),
    "a remark in no column": lambda rows: plain(rows).replace(b'1,2"', b'1,2",see below'),
    "thousands": lambda rows: changed(rows, "frequency_hz", lambda _: "1,234"),
    "cells too narrow": lambda rows: changed(rows, "end_s", lambda _: "###"),
    "a label that is none": lambda rows: changed(rows, "label", lambda _: "squeak"),
    "a quote that does not end": lambda rows: plain(rows).replace(b"24.12", b'"24.12'),
    "Excel of central Europe": lambda rows: german(
        rows, head="", encoding="cp1250", true="PRAWDA", false="FAŁSZ"
    ),
    "no table": lambda _: b"\x89PNG\r\n\x1a\n\0\0",
    "the wrong ending": lambda _: b"PK\3\4",
}


@pytest.mark.parametrize("way", READ)
def test_rows_by_a_person_stay_however_a_table_was_saved(way, labelled, recordings, tmp_path):
    table = tmp_path / "labels.csv"
    table.write_bytes(READ[way](labelled))
    saved = {row["file"] for row in read_label_table(table)}
    assert main(["label", str(recordings), "--out", str(table)]) == 0
    _check(read_label_table(table), labelled, saved)
    once = table.read_bytes()
    assert main(["label", str(recordings), "--out", str(table), "--fresh"]) == 0
    assert table.read_bytes() == once


@pytest.mark.parametrize(
    ("ending", "shape"),
    [
        (".jsonl", "as written"),
        (".xlsx", "as written"),
        (".parquet", "as written"),
        (".parquet", "texts"),
    ],
)
def test_rows_by_a_person_stay_in_other_formats(ending, shape, labelled, recordings, tmp_path):
    table = tmp_path / f"labels{ending}"
    rows = labelled
    if shape == "texts":
        columns, *lines = cells(labelled, ",")
        rows = [dict(zip(columns, line, strict=True)) for line in lines]
    write_table(table, list(rows[0]), rows)
    assert main(["label", str(recordings), "--out", str(table)]) == 0
    _check(read_label_table(table), labelled, set(FILES))


def _check(found, labelled, saved):
    """Compare the rows by a person that were in the table, and what stands beside all of them."""
    by_name = {row["file"]: row for row in found}
    assert set(by_name) == set(FILES)
    assert len(saved) > 1
    for row in labelled:
        back = by_name[row["file"]]
        if row["file"] not in saved:
            continue
        if row["label_source"] == "human":
            assert (back["label"], back["label_source"]) in [("creak", "human"), ("creak", None)]
            assert (back["level_dbfs"], back["end_s"]) in [(-41.25, row["end_s"]), (None, None)]
        own = [name for name in back if name.strip().lower() == "own remark"]
        assert [back[name] for name in own] == [OWN[row["file"]]] * len(own)


@pytest.mark.parametrize("way", REFUSED)
def test_what_cannot_be_understood_is_not_written_over(way, labelled, recordings, tmp_path, capsys):
    table = tmp_path / ("labels.parquet" if way == "the wrong ending" else "labels.csv")
    saved = REFUSED[way](labelled)
    table.write_bytes(saved)
    assert main(["label", str(recordings), "--out", str(table)]) == 2
    assert "would be lost" in capsys.readouterr().err
    assert table.read_bytes() == saved
    assert sorted(path.name for path in tmp_path.iterdir()) == [table.name]


@pytest.mark.parametrize("call", ["features {0} --out {1}", "label {1} --map {2}"])
def test_no_other_table_is_written_over_labels(call, labelled, recordings, tmp_path, capsys):
    table = tmp_path / "labels.csv"
    table.write_bytes(plain(labelled))
    given = call.format(recordings, table, table.with_suffix(".png")).split()
    assert main(given) == 2
    assert "is a label table" in capsys.readouterr().err
    assert table.read_bytes() == plain(labelled)
