"""What `label` prints on standard output: a line a recording for people, the table for programs."""

import os
import pty
import subprocess
import sys

import pytest

from noise.cli import main
from noise.labels.table import result_lines

SQUEAL = {
    "file": "run07.wav", "channel": "all", "label": "squeal", "start_s": 1.99, "end_s": 6.01,
    "frequency_hz": 974.2, "level_dba": 59.9, "level_dbfs": -34.0, "p_squeal": 0.93,
    "label_source": "classifier", "error": None,
}  # fmt: skip
CREAK = SQUEAL | {
    "label": "creak", "start_s": 6.01, "end_s": 7.0, "frequency_hz": 83.0, "level_dba": 51.0,
    "p_creak": 0.7,
}  # fmt: skip
NONE = SQUEAL | {"label": "none", "start_s": 0.0, "end_s": 1.99, "p_none": 0.99}


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ([SQUEAL], "run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93"),
        (
            [NONE, SQUEAL, CREAK],
            "run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93"
            "  also creak 83 Hz  51.0 dB(A)  6.01-7.00 s  p 0.70",
        ),
        (
            [
                SQUEAL | {"label": "unknown", "p_unknown": 0.81, "p_squeal": 0.1},
                CREAK,
                CREAK | {"end_s": 6.5},
            ],
            "run07.wav  unknown 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.81"
            "  also creak 83 Hz  51.0 dB(A)  6.01-7.00 s  p 0.70",
        ),
        (
            [SQUEAL | {"label": "unknown", "p_unknown": 0.3, "p_squeal": 0.65}],
            "run07.wav  unknown 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.30 (squeal 0.65)",
        ),
        (
            [SQUEAL | {"level_dba": None, "frequency_hz": None}],
            "run07.wav  squeal  -34.0 dBFS  1.99-6.01 s  p 0.93",
        ),
        (
            [SQUEAL | {"label_source": "human"}],
            "run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  by hand",
        ),
        (
            [dict.fromkeys(SQUEAL) | {"file": "b.wav", "error": "is empty"}],
            "b.wav  refused: is empty",
        ),
    ],
)
def test_a_recording_is_told_in_one_line(rows, line):
    assert list(result_lines(rows)) == [line]


def test_every_recording_has_a_line_and_a_track_of_another_file_none_of_its_own():
    rows = [SQUEAL, SQUEAL | {"channel": "2"}, SQUEAL | {"file": "run08.wav"}]
    assert [line.split()[0] for line in result_lines(rows)] == ["run07.wav", "run08.wav"]


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["simulate", "--speed", "10", "--support-stiffness", "3745", "--out", "run"]) == 0
    return tmp_path


def test_a_terminal_gets_the_line_and_a_pipe_the_table(run):
    call = [sys.executable, "-m", "noise", "label", "run.wav"]
    piped = subprocess.run(call, capture_output=True, text=True, check=True)
    assert piped.stdout.startswith("file,channel,")
    ours, theirs = pty.openpty()
    done = subprocess.run(call, stdout=theirs, stderr=subprocess.PIPE, text=True, check=True)
    os.close(theirs)
    assert os.read(ours, 65536).decode().startswith("run.wav  squeal 9")
    os.close(ours)
    assert "takes the whole table" in done.stderr
