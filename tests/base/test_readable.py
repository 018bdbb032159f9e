"""Names that hold anything: shown on a terminal, written to tables, found again."""

from __future__ import annotations

import os

import numpy as np
import pytest
import soundfile
from hypothesis import given, strategies as st

from noise.base.progress import note, readable, say
from noise.base.tables import write_table
from noise.cli import main
from noise.labels.corrections import with_corrections
from noise.labels.table import read_label_table
from noise.recordings import find_recordings

NO_UTF8 = os.fsdecode(b"caf\xe9.wav")


@given(st.text() | st.binary().map(os.fsdecode))
def test_what_is_shown_can_be_written_and_controls_no_terminal(text):
    shown = readable(text)
    shown.encode("utf-8")
    assert not any(ord(letter) < 0x20 or 0x7F <= ord(letter) < 0xA0 for letter in shown)
    assert readable(shown) == shown


def test_messages_bring_no_control_characters_to_the_terminal(capsys):
    say("\x1b]0;title\x07\x1b[2Jrun.wav:\nis empty\x9b31m")
    note("\r\b\x7f")
    told = capsys.readouterr().err
    assert told.replace("\n", "").isprintable()
    assert r"\x1b]0;title\x07\x1b[2Jrun.wav: is empty\x9b31m" in told


@pytest.fixture
def odd(tmp_path):
    """Recordings of odd names, in a folder."""
    folder = tmp_path / "runs"
    folder.mkdir()
    for name in (NO_UTF8, "=1+1.wav", "\x1b[2J.wav"):
        with (folder / name).open("wb") as file:
            soundfile.write(file, np.full((4800, 1), 0.1), 48_000, format="WAV")
    return folder


def test_recordings_of_odd_names_are_labelled_once_and_corrections_stay_theirs(
    odd, tmp_path, capsys
):
    table = tmp_path / "labels.csv"
    assert main(["label", str(odd), "--out", str(table)]) == 0
    rows = read_label_table(table)
    assert [row["file"] for row in rows] == [r"\x1b[2J.wav", "=1+1.wav", r"caf\xe9.wav"]
    assert {row["file"] for row in rows} == {name for _, name in find_recordings(odd)}
    assert "\x1b" not in table.read_text(encoding="utf-8")
    for row in rows:
        row |= {"label": "squeal", "label_source": "human"}
    write_table(table, list(rows[0]), rows)
    again = [{**row, "label": "none", "label_source": "classifier"} for row in rows]
    assert {row["label"] for row in with_corrections(table, again)} == {"squeal"}
    capsys.readouterr()
    assert main(["label", str(odd), "--out", str(table)]) == 0
    assert "3 of 3 recordings are done already" in capsys.readouterr().err
