from __future__ import annotations

import csv
from argparse import Namespace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import soundfile

from features import recording_feature_names
from models.blocks import RecordingBlocks
from models.condition import Condition
from models.recording import Channel, Recording
from noise.classifier import LABELS, load_classifier
from noise.cli import main
from noise.labels.segments import Segment
from noise.labels.table import COLUMNS, LabelTable, read_label_table
from noise.labels.windows import FEATURE_NAMES, describe
from noise.recordings import read_recording, write_recording


@pytest.fixture
def runs(tmp_path, monkeypatch):
    """A folder of three recordings, of which the second is none."""
    hiss = np.random.default_rng(0).normal(size=(1, 4800))
    for name in ("a", "c"):
        recording = Recording(hiss, 48e3, (Channel("pressure"),), Condition(speed=5.0))
        write_recording(tmp_path / "runs" / name, recording)
    (tmp_path / "runs" / "b.wav").write_bytes(b"no sound")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "runs"


@pytest.fixture
def labelled(monkeypatch):
    """A classifier that calls everything a squeal, and what it was asked."""
    asked = Namespace(classifiers=[], recordings=[], sensitivities=[])

    class Stand:
        card: ClassVar = {
            "real_sources_left_out": {
                "false_names_an_hour": {"1": 8.0, "2": 20.0},
                "background_hours": 0.25,
            }
        }

        def sensitive(self, sensitivity):
            asked.sensitivities.append(sensitivity)
            return self

    def load_classifier(path=None):
        asked.classifiers.append(path)
        return Stand()

    def label_recording(recording, classifier, *, per_track=False):
        assert isinstance(classifier, Stand)
        asked.recordings.append((recording, per_track))
        certain = {label: float(label == "squeal") for label in LABELS}
        end = recording.n_samples / recording.rate
        return [Segment("all", 0.0, end, "squeal", certain, 1046.0, None, -20.0)]

    monkeypatch.setattr("noise.labels.labelling.load_classifier", load_classifier)
    monkeypatch.setattr("noise.labels.labelling.label_recording", label_recording)
    return asked


def read_table(path):
    with Path(path).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_features_name_the_bad_file_in_the_table_and_go_on(runs, capsys):
    assert main(["features", "runs", "--out", "new/features.csv"]) == 1
    out, err = capsys.readouterr()
    assert out == f"{Path('new/features.csv')}\n"
    assert f"refused: {Path('runs/b.wav')}: is damaged or no sound file" in err
    assert "3 recordings, 1 refused" in err
    rows = read_table("new/features.csv")
    assert [row["file"] for row in rows] == ["a.wav", "b.wav", "c.wav"]
    assert list(rows[0]) == ["file", *recording_feature_names(), "error"]
    assert [bool(row["error"]) for row in rows] == [False, True, False]
    assert [bool(row["pressure_level"]) for row in rows] == [True, False, True]


def test_windows_are_listed_as_the_classifier_is_given_them(runs):
    assert main(["features", "runs", "--windows", "--out", "windows.csv"]) == 1
    rows = read_table("windows.csv")
    assert list(rows[0]) == ["file", "channel", "start_s", "end_s", *FEATURE_NAMES, "error"]
    assert [row["file"] for row in rows] == ["a.wav", "b.wav", "c.wav"]
    assert "damaged" in rows[1]["error"]
    assert [rows[0][name] for name in ("channel", "start_s", "end_s")] == ["all", "0.0", "0.1"]
    given = load_classifier().feature_names
    recording = RecordingBlocks.of(read_recording(Path("runs/a.wav")))
    values = describe(recording).features[:, [FEATURE_NAMES.index(name) for name in given]]
    listed = np.array([float(rows[0][name] or "nan") for name in given], dtype=np.float32)
    assert listed.tobytes() == values[0].tobytes()
    assert np.isfinite(listed).any()


def test_each_track_of_a_plain_sound_file_has_its_windows(runs):
    hiss = np.random.default_rng(0).normal(size=(48_000, 2))
    soundfile.write("two.wav", 0.1 * hiss, 48_000, subtype="FLOAT")
    assert main(["features", "two.wav", "--windows", "--out", "windows.csv"]) == 0
    rows = read_table("windows.csv")
    assert [row["channel"] for row in rows] == ["1", "1", "1", "2", "2", "2"]
    assert [row["start_s"] for row in rows] == ["0.0", "0.25", "0.5"] * 2
    assert rows[2]["end_s"] == "1.0"
    assert all(row["pressure_flatness"] and not row["torque_mean"] for row in rows)


def test_a_recording_without_windows_says_so(runs, capsys):
    turning = Recording(np.zeros((1, 4800)), 48e3, (Channel("angle"),))
    write_recording(Path("turning"), turning)
    assert main(["features", "turning.wav", "--windows"]) == 1
    assert "has no channel of pressure, acceleration or torque" in capsys.readouterr().out


def test_a_recording_named_twice_is_a_row_once(runs, labelled):
    assert main(["label", "runs/a.wav", "./runs/a.wav", "--out", "t.csv"]) == 0
    assert [row["file"] for row in read_table("t.csv")] == ["a.wav"]


@pytest.mark.parametrize(("ending", "again"), [(".csv", []), (".parquet", ["--fresh"])])
def test_what_somebody_corrected_stays_when_recordings_are_labelled_again(
    runs, labelled, ending, again
):
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


def test_the_same_call_again_repeats_nothing_but_what_was_refused(runs, labelled, capsys):
    for _ in range(2):
        assert main(["label", "runs", "--out", "labels.csv"]) == 1
        assert "refused: runs" in capsys.readouterr().err.replace("\\", "/")
        assert [row["file"] for row in read_table("labels.csv")] == ["a.wav", "b.wav", "c.wav"]
    assert len(labelled.recordings) == 2
    assert main(["label", "runs", "--out", "labels.csv", "--fresh"]) == 1
    assert len(labelled.recordings) == 4


def test_labels_come_with_a_map_and_label_tracks(runs, labelled, capsys):
    given = ["--map", "map.svg", "--audacity", "tracks"]
    assert main(["label", "runs", *given]) == 1
    out, err = capsys.readouterr()
    assert out.startswith("file,channel,")  # standard output is the table alone
    assert "map.svg" in err
    assert Path("tracks/a.txt").read_text() == "0.000000\t0.100000\tsqueal\n"
    (place,) = read_table("map.csv")
    assert (place["speed_rad_s_from"], place["label"], place["recordings"]) == (
        "4.9",
        "squeal",
        "2",
    )


@pytest.mark.parametrize("command", ["features", "label"])
def test_what_was_done_before_an_interrupt_is_in_the_table(
    runs, labelled, monkeypatch, capsys, command
):
    from noise.recordings import files

    def interrupted(path, **about):
        if path.name == "c.wav":
            raise KeyboardInterrupt
        return open_blocks(path, **about)

    open_blocks = files.open_blocks
    for place in ("noise.recordings.files", "noise.labels.labelling"):
        monkeypatch.setattr(f"{place}.open_blocks", interrupted)
    assert main([command, "runs", "--out", "t.csv"]) == 130
    assert [row["file"] for row in read_table("t.csv")] == ["a.wav", "b.wav"]
    assert "interrupted: 2 of 3 recordings" in capsys.readouterr().err


def test_an_interrupt_while_the_table_is_written_does_not_lose_it(runs, monkeypatch):
    from noise.base.tables import write_table

    calls = []

    def interrupted_once(*given):
        calls.append(given)
        if len(calls) == 1:
            raise KeyboardInterrupt
        write_table(*given)

    monkeypatch.setattr("noise.commands.batch.write_table", interrupted_once)
    assert main(["features", "runs", "--out", "t.csv"]) == 130
    assert len(read_table("t.csv")) == 3


def test_a_defect_in_one_file_does_not_end_the_batch(runs, monkeypatch, capsys):
    def recording_features(recording):
        return {} if recording.name == "c.wav" else 1 / 0

    monkeypatch.setattr("features.recording_features", recording_features)
    assert main(["features", "runs", "--out", "t.csv"]) == 1
    errors = [row["error"] for row in read_table("t.csv")]
    assert errors[0] == "unexpected, please report: ZeroDivisionError: division by zero"
    assert errors[2] == ""


@pytest.mark.parametrize("command", ["features", "label"])
@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["nowhere"], "nowhere: there is no such file"),
        (["empty"], "empty: there are no recordings"),
        (["runs", "--out", "t.txt"], "t.txt: tables end in .csv, .xlsx, .jsonl or .parquet"),
        (["runs", "--out", "runs/a.wav/t.csv"], "is a file, not a folder"),
        (["runs", "--full-scale", "0"], "--full-scale"),
        (["runs", "--workers", "0"], "--workers is '0', expected a whole number"),
        (["runs", "--workers", "2", "--scheduler", "x"], "not allowed with"),
        ([], "PATH"),
    ],
)
def test_calls_that_cannot_be_used_are_refused(runs, labelled, capsys, command, given, said):
    Path("empty").mkdir()
    assert main([command, *given]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in err
    assert err.count("\n") == 1


def test_labels_are_linked_to_conditions_and_bad_files_to_reasons(runs, labelled, capsys):
    assert main(["label", "runs", "--out", "labels.csv"]) == 1
    rows = read_table("labels.csv")
    assert list(rows[0]) == list(COLUMNS)
    assert [row["label"] for row in rows] == ["squeal", "", "squeal"]
    assert rows[0]["speed_rad_s"] == "5.0"
    reason = "is damaged or no sound file (Format not recognised)"
    assert rows[1]["error"] == f"{Path('runs/b.wav')}: {reason}"
    assert labelled.classifiers == [None]


def test_a_classifier_of_ones_own_is_used(runs, labelled):
    Path("mine.npz").write_bytes(b"trained")
    assert main(["label", "runs/a.wav", "--out", "t.csv", "--classifier", "mine.npz"]) == 0
    assert labelled.classifiers == [Path("mine.npz")]


def test_tracks_of_a_plain_sound_file_stand_for_themselves(runs, labelled, capsys):
    soundfile.write("runs/d.wav", np.random.default_rng(0).uniform(-0.1, 0.1, (4800, 2)), 48000)
    given = ["runs/a.wav", "runs/d.wav", "--out", "t.csv"]
    assert main(["label", *given]) == 0
    assert [per_track for _, per_track in labelled.recordings] == [False, True]
    assert "1 recording without calibration" in capsys.readouterr().err
    assert main(["label", *given, "--full-scale", "2"]) == 0
    assert [recording.calibrated for recording, _ in labelled.recordings] == [
        True,
        False,
        True,
        True,
    ]
    assert "without calibration" not in capsys.readouterr().err


def test_another_sensitivity_is_taken_and_its_false_names_are_told(runs, labelled, capsys):
    assert main(["label", "runs/a.wav", "--out", "t.csv", "--sensitivity", "2"]) == 0
    assert labelled.sensitivities == [2.0]
    said = capsys.readouterr().err
    assert "20 false names an hour" in said
    assert "in 0.25 h: 5 names (2)" in said


def test_train_saves_what_it_made(tmp_path, monkeypatch, capsys):
    asked = []

    def train(*, seed, added, progress, growing, **_):
        assert not added
        assert list(growing(range(6), 6)) == [0, 1, 2, 3, 4, 5]
        asked.append((seed, list(progress(iter([1, 2]), 2))))
        card = {"pressure": {"n": 600, "macro_f1": 0.9}}
        return Namespace(save=lambda path: path.write_bytes(b"trained"), card=card)

    monkeypatch.setattr("noise.training.classifier.fit.train", train)
    out = tmp_path / "mine.npz"
    assert main(["train", "--out", str(out), "--seed", "3"]) == 0
    printed, err = capsys.readouterr()
    assert printed == f"{out}\n"
    assert out.read_bytes() == b"trained"
    assert asked == [(3, [1, 2])]
    assert "growing trees 6 fits" in err
    assert "pressure: n 600, macro f1 0.9" in err


@pytest.mark.parametrize("given", [[], ["--out", "mine.pkl"], ["--out", "file.txt/mine.npz"]])
def test_train_refuses_a_target_before_the_work(tmp_path, monkeypatch, capsys, given):
    monkeypatch.chdir(tmp_path)
    Path("file.txt").touch()
    assert main(["train", *given]) == 2
    assert "--out" in capsys.readouterr().err


def test_demo_names_its_report(tmp_path, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr("noise.demo.run_demo", lambda out, *, seed: asked.append((out, seed)))
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    assert main(["demo", "--out", "there", "--seed", "2"]) == 0
    assert asked == [(Path("bushing-noise-demo"), 0), (Path("there"), 2)]
    reports = [str(folder / "report.html") for folder, _ in asked]
    assert capsys.readouterr().out.splitlines() == reports
