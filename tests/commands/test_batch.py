"""``label``, ``features``, ``train``: many recordings into one table, and what stands beside it."""

from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest
import soundfile

from features import recording_feature_names
from models.condition import Condition
from noise.cli import main
from noise.labels.summary import result_lines
from noise.labels.table import COLUMNS, LabelTable, read_label_table
from tests.helpers.files import csv_rows, pressure_file


@pytest.fixture
def runs(tmp_path, monkeypatch):
    """A folder of three recordings, of which the second is none."""
    hiss = np.random.default_rng(0).normal(size=(1, 4800))
    for name in ("a", "c"):
        pressure_file(tmp_path / "runs" / name, hiss, 48e3, Condition(speed=5.0))
    (tmp_path / "runs" / "b.wav").write_bytes(b"no sound")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "runs"


def test_features_name_the_bad_file_in_the_table_and_go_on(runs, capsys):
    assert main(["features", "runs", "./runs/a.wav", "--out", "new/f.csv"]) == 1
    out, err = capsys.readouterr()
    assert out.splitlines() == [f"{Path('new/f.csv')}"]
    assert f"refused: {Path('runs/b.wav')}: is damaged or no sound file" in err
    assert "3 recordings, 1 refused" in err
    rows = csv_rows("new/f.csv")
    assert [row["file"] for row in rows] == ["a.wav", "b.wav", "c.wav"]
    assert list(rows[0]) == ["file", *recording_feature_names(), "error"]
    assert [bool(row["error"]) for row in rows] == [False, True, False]
    assert [bool(row["pressure_level"]) for row in rows] == [True, False, True]


def test_labels_are_linked_to_conditions_with_a_map_and_label_tracks(runs, capsys):
    given = ["--map", "map.svg", "--sensitivity", "2"]
    assert main(["label", "runs", "--out", "t.csv", *given]) == 1
    out, err = capsys.readouterr()
    paths = [line for line in out.splitlines() if "  " not in line]
    assert paths == ["t.csv", "map.svg", "map.csv"]
    assert "false names per hour" in err
    rows = csv_rows("t.csv")
    assert list(rows[0]) == list(COLUMNS)
    assert [(row["file"], row["speed_rad_s"]) for row in rows] == [
        ("a.wav", "5.0"), ("b.wav", ""), ("c.wav", "5.0"),
    ]  # fmt: skip
    reason = "is damaged or no sound file (Format not recognised)"
    assert rows[1]["error"] == f"{Path('runs/b.wav')}: {reason}"
    (place,) = csv_rows("map.csv")
    assert (place["speed_rad_s_from"], place["recordings"]) == ("5.0", "2")


@pytest.mark.parametrize(("ending", "again"), [(".csv", []), (".parquet", ["--fresh"])])
def test_what_somebody_corrected_stays_when_recordings_are_labelled_again(runs, ending, again):
    out = f"labels{ending}"
    assert main(["label", "runs", "--out", out]) == 1
    first, refused, last = read_label_table(Path(out))
    corrected = [
        first | {"end_s": 0.05, "label_source": "classifier"},
        first | {"start_s": 0.05, "label": "creak", "label_source": "human"},
    ]
    LabelTable([*corrected, refused, last | {"label": "none"}]).write(out)
    assert main(["label", "runs", "--out", out, *again]) == 1
    assert read_label_table(Path(out)) == [*corrected, refused, last]
    # Recordings of another folder do not drive it out either.
    assert main(["label", "runs/c.wav", "--out", out, *again]) == 0
    assert read_label_table(Path(out)) == [last, *corrected]


def test_tracks_of_a_plain_sound_file_stand_for_themselves(runs, capsys):
    noise = np.random.default_rng(0).uniform(-0.1, 0.1, (4800, 2))
    soundfile.write("runs/d.wav", noise, 48000)
    given = ["runs/a.wav", "runs/d.wav", "--out", "t.csv"]
    assert main(["label", *given]) == 0
    assert [row["channel"] for row in csv_rows("t.csv")] == ["all", "1", "2"]
    assert "1 recording without calibration" in capsys.readouterr().err
    assert main(["label", *given, "--full-scale", "2"]) == 0
    assert "without calibration" not in capsys.readouterr().err
    assert float(csv_rows("t.csv")[1]["level_db"]) == pytest.approx(
        20 * np.log10(2 * noise[:, 0].std() / 2e-5), abs=0.01
    )


def test_a_calibrator_makes_levels_in_decibels(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, frequency, pascal in (("tone", 1000.0, 1.0024), ("sound", 700.0, 0.2)):
        time = np.arange(96_000) / 48e3
        sine = 0.05 * pascal * np.sqrt(2.0) * np.sin(2 * np.pi * frequency * time)
        soundfile.write(f"{name}.wav", sine, 48_000)
    by_tone = ["sound.wav", "--calibrator", "tone.wav", "--level", "94", "--out"]
    for command, out, column in (
        ("features", "f.csv", "pressure_level"),
        ("render", "set/", "level_db"),
    ):
        Path("set").mkdir(exist_ok=True)
        assert main([command, *by_tone, out]) == 0
        assert "tone.wav: 94 dB at 1000 Hz make full scale 20" in capsys.readouterr().err
        (row,) = csv_rows("set/levels.csv" if command == "render" else out)
        assert float(row[column]) == pytest.approx(80.0, abs=0.1)
    assert main(["review", *by_tone, "page.html", "--no-labelling"]) == 0
    assert "Calibrated sounds" in Path("page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("command", ["features", "label"])
def test_what_was_done_before_an_interrupt_is_in_the_table(runs, monkeypatch, capsys, command):
    from noise.recordings import files

    def interrupted(path, **about):
        if path.name == "c.wav":
            raise KeyboardInterrupt
        return open_blocks(path, **about)

    open_blocks = files.open_blocks
    for place in ("noise.recordings.files", "noise.labels.labelling"):
        monkeypatch.setattr(f"{place}.open_blocks", interrupted)
    assert main([command, "runs", "--out", "t.csv"]) == 130
    assert [row["file"] for row in csv_rows("t.csv")] == ["a.wav", "b.wav"]
    assert "interrupted: 2 of 3 recordings" in capsys.readouterr().err


def test_train_saves_what_it_made(tmp_path, monkeypatch, capsys):
    asked = []

    def train(*, seed, added, progress, **_):
        assert not added
        asked.append((seed, list(progress(iter([1, 2]), 2))))
        card = {"pressure_kinds_left_out": {"n": 600, "macro_f1": 0.9}}
        return Namespace(save=lambda path: path.write_bytes(b"trained"), card=card)

    monkeypatch.setattr("noise.training.classifier.fit.train", train)
    out = tmp_path / "mine.npz"
    assert main(["train", "--out", str(out), "--seed", "3"]) == 0
    printed, err = capsys.readouterr()
    assert printed == f"{out}\n"
    assert out.read_bytes() == b"trained"
    assert asked == [(3, [1, 2])]
    assert "pressure: n 600, macro f1 0.9" in err


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
UNKNOWN = SQUEAL | {"label": "unknown", "p_unknown": 0.3, "p_squeal": 0.65}


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        (
            [NONE, SQUEAL, CREAK],
            "run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93"
            "  also creak 83 Hz  51.0 dB(A)  6.01-7.00 s  p 0.70",
        ),
        ([UNKNOWN], "run07.wav  unknown 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.30 (squeal 0.65)"),
        (
            [SQUEAL | {"level_dba": None, "frequency_hz": None, "label_source": "human"}],
            "run07.wav  squeal  -34.0 dBFS  1.99-6.01 s  by hand",
        ),
    ],
)
def test_a_recording_is_told_in_one_line(rows, line):
    assert list(result_lines(rows)) == [line]
