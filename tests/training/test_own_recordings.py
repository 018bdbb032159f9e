"""The user's own labelled recordings: read, cut, weighted, held out, learned from."""

from __future__ import annotations

import json
from typing import ClassVar

import numpy as np
import pytest

from models.errors import RecordingError
from models.recording import Channel, Recording
from noise.classifier import load_classifier
from noise.cli import main
from noise.labels.tracks import label_track, read_label_track
from noise.recordings import write_recording
from noise.training.classifier.own_recordings import read_labelled

RATE = 16_000.0


def write(path, seconds=1.0, tracks=1, seed=0):
    noise = np.random.default_rng(seed).normal(size=(tracks, round(seconds * RATE)))
    names = ("pressure", "pressure_2")[:tracks]
    return write_recording(path, Recording(noise, RATE, tuple(Channel(name) for name in names)))


def labels_of(windows):
    return [(window.name.rsplit("/", 1)[-1], window.label) for window in windows]


def test_the_nearest_folder_named_as_a_label_says_it(tmp_path):
    write(tmp_path / "creak" / "day1" / "a")
    write(tmp_path / "creak" / "Squeal" / "b")
    windows, refusals = read_labelled(tmp_path)
    assert sorted(labels_of(windows)) == [("a.wav", "creak"), ("b.wav", "squeal")]
    assert refusals == []


def test_a_label_track_is_finer_than_a_table_and_a_table_than_a_folder(tmp_path):
    for name in ("a", "b", "c"):
        write(tmp_path / "none" / name)
    (tmp_path / "none" / "labels.csv").write_text("file,label\na.wav,creak\nb.wav,creak\n")
    (tmp_path / "none" / "a.txt").write_text("0.0\t0.5\tsqueal\n")
    windows, _ = read_labelled(tmp_path)
    assert labels_of(windows) == [("a.wav", "squeal"), ("b.wav", "creak"), ("c.wav", "none")]


def test_of_a_table_that_somebody_has_corrected_the_corrections_count_alone(tmp_path):
    for name in ("a", "b", "creak/c"):
        write(tmp_path / name)
    table = tmp_path / "labels.csv"
    rows = ["a.wav,squeal,human", "b.wav,squawk,classifier", "creak/c.wav,none,classifier"]
    table.write_text("\n".join(["file,label,label_source", *rows]) + "\n")
    assert labels_of(read_labelled(tmp_path)[0]) == [("a.wav", "squeal"), ("c.wav", "creak")]
    assert labels_of(read_labelled(table)[0]) == [("a.wav", "squeal")]
    assert read_labelled(tmp_path)[1] == read_labelled(table)[1] == []


def test_a_track_of_several_is_taken_by_itself(tmp_path):
    path = write(tmp_path / "a", tracks=2)
    (tmp_path / "a.wav.txt").write_text("0\t1\ttrack 2: squawk\n")
    (window,), _ = read_labelled(tmp_path)
    assert window.label == "squawk"
    assert window.recording.channel_names == ("pressure",)
    assert path.name in window.name


@pytest.mark.parametrize("seconds", [0.5, 1.01, 7.3])
def test_windows_are_half_a_second_to_one_and_cover_the_whole(tmp_path, seconds):
    write(tmp_path / "none" / "a", seconds=seconds)
    windows, _ = read_labelled(tmp_path)
    lengths = [window.recording.duration for window in windows]
    assert sum(lengths) == pytest.approx(seconds)
    assert min(lengths) >= 0.499
    assert max(lengths) <= 1.001


def test_what_cannot_be_used_is_named_in_one_line_each(tmp_path):
    write(tmp_path / "creak" / "good")
    write(tmp_path / "unnamed")
    write(tmp_path / "short", seconds=0.2)
    (tmp_path / "short.txt").write_text("0.15\t0.2\tcreak\n0\t0.2\ttrack 3: creak\n")
    write(tmp_path / "odd")
    (tmp_path / "odd.txt").write_text("0\t0.5\tdog\n0.5\t1\tnone\n")
    (tmp_path / "creak" / "bad.wav").write_bytes(b"no sound")
    (tmp_path / "labels.csv").write_text("file,label\nunnamed.wav,meow\ngone.wav,creak\n")
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    windows, refusals = read_labelled(tmp_path)
    assert labels_of(windows) == [("good.wav", "creak"), ("odd.wav", "none")]
    assert all("\n" not in line for line in refusals)
    for said in (
        "unnamed.wav: has no label", "short.wav: creak", "short.wav: has no track '3'",
        "label 1 is 'dog'", "bad.wav", "label 'meow'",
        "gone.wav, which is not there", "other.csv",
    ):  # fmt: skip
        assert sum(said in line for line in refusals) == 1, said
    assert len(refusals) == 8


def test_a_label_track_is_read_as_it_was_written(tmp_path):
    rows = [
        {"channel": "all", "start_s": 0.5, "end_s": 2.25, "label": "creak"},
        {"channel": "2", "start_s": 1.0, "end_s": 2.0, "label": "none"},
    ]
    (tmp_path / "a.txt").write_text(label_track(rows) + "\\\t100.0\t900.0\n")
    assert read_label_track(tmp_path / "a.txt") == [
        (0.5, 2.25, "all", "creak"), (1.0, 2.0, "2", "none"),
    ]  # fmt: skip


@pytest.mark.parametrize("content", [b"hello\n", b"1\t0\tcreak\n", b"nan\t1\tcreak\n", b"\xff\xfe"])
def test_what_is_no_label_track_is_refused(tmp_path, content):
    (tmp_path / "a.txt").write_bytes(content)
    with pytest.raises(RecordingError, match=r"a\.txt"):
        read_label_track(tmp_path / "a.txt")


def clicks(seed):
    """A sound that the shipped classifier does not take for a squeal."""
    rng = np.random.default_rng(seed)
    sound = 0.01 * rng.normal(size=16_000)
    sound[rng.integers(0, 16_000, 40)] += 1.0
    return Recording(sound[None], RATE, (Channel("pressure"),), calibrated=False)


@pytest.fixture
def own(tmp_path):
    for seed in range(6):
        write_recording(tmp_path / "own" / "squeal" / f"{seed}", clicks(seed))
    return tmp_path / "own"


@pytest.mark.slow
def test_own_recordings_are_learned_and_the_card_tells_before_and_after(own, tmp_path, capsys):
    (own / "creak").mkdir()
    (own / "creak" / "bad.wav").write_bytes(b"no sound")
    model = tmp_path / "mine.npz"
    assert main(["train", "--out", str(model), "--add", str(own), "--samples", "120"]) == 1
    said = load_classifier(model).card["own"]
    assert json.loads(json.dumps(said)) == said
    squeal = said["labels"]["squeal"]
    assert (said["files"], squeal["windows"]) == (6, 6)
    assert squeal["recall_before"] == 0.0
    assert squeal["recall"] == 1.0
    assert "each scored by trees grown without it" in capsys.readouterr().err


class Trained:
    """Stands in for what takes minutes."""

    card: ClassVar = {"own": {"files": 6, "labels": {}}}

    def save(self, path):
        path.touch()


@pytest.mark.parametrize("bad", [False, True])
def test_a_bad_file_among_them_gives_exit_code_1_with_the_rest_learned(
    own, tmp_path, capsys, monkeypatch, bad
):
    asked = []
    monkeypatch.setattr(
        "noise.training.classifier.fit.train", lambda **given: asked.append(given) or Trained()
    )
    if bad:
        (own / "creak").mkdir()
        (own / "creak" / "bad.wav").write_bytes(b"no sound")
    model = tmp_path / "mine.npz"
    add = ["--add", str(own), "--add", str(own)]
    assert main(["train", "--out", str(model), *add, "--samples", "50"]) == int(bad)
    assert model.exists()
    assert [sample.label for sample in asked[0]["added"]] == ["squeal"] * 6
    assert (asked[0]["n_training"], asked[0]["n_test"]) == (50, 10)
    refused = [line for line in capsys.readouterr().err.splitlines() if "refused" in line]
    assert ["bad.wav" in line for line in refused] == [True] * bad


@pytest.mark.parametrize("made", [None, "empty", "unlabelled"])
def test_nothing_usable_gives_exit_code_2_and_no_classifier(tmp_path, made):
    folder = tmp_path / "own"
    if made:
        folder.mkdir()
    if made == "unlabelled":
        write(folder / "a")
    model = tmp_path / "mine.npz"
    assert main(["train", "--out", str(model), "--add", str(folder), "--samples", "120"]) == 2
    assert not model.exists()
