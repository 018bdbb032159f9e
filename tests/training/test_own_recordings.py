"""The user's own labelled recordings: read, cut, weighted, held out, learned from."""

from __future__ import annotations

import json
from typing import ClassVar

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.classifier import load_classifier
from noise.cli import main
from noise.recordings import write_recording
from noise.training.classifier.own_recordings import OWN_WEIGHT, own_samples

RATE = 16_000.0


def write(path, seconds=1.0, tracks=1, seed=0):
    noise = np.random.default_rng(seed).normal(size=(tracks, round(seconds * RATE)))
    names = ("pressure", "pressure_2")[:tracks]
    return write_recording(path, Recording(noise, RATE, tuple(Channel(name) for name in names)))


def labels_of(samples):
    return [(sample.source.rsplit("/", 1)[-1], sample.label) for sample in samples]


def test_the_nearest_folder_named_as_a_label_says_it(tmp_path):
    write(tmp_path / "creak" / "day1" / "a")
    write(tmp_path / "creak" / "Squeal" / "b")
    windows, refusals = own_samples(tmp_path)
    assert sorted(labels_of(windows)) == [("a.wav", "creak"), ("b.wav", "squeal")]
    assert refusals == []


def test_of_a_table_that_somebody_has_corrected_the_corrections_count_alone(tmp_path):
    for name in ("a", "b", "creak/c"):
        write(tmp_path / name)
    table = tmp_path / "labels.csv"
    rows = ["a.wav,squeal,human", "b.wav,squawk,classifier", "creak/c.wav,none,classifier"]
    table.write_text("\n".join(["file,label,label_source", *rows]) + "\n")
    samples, refusals = own_samples(table)
    assert (labels_of(samples), refusals) == ([("a.wav", "squeal")], [])
    samples, refusals = own_samples(tmp_path)  # by folders
    assert labels_of(samples) == [("c.wav", "creak")]
    assert sum("labels.csv: is not read" in line for line in refusals) == 1


def test_a_table_beside_the_folder_of_its_recordings_is_enough(tmp_path):
    write(tmp_path / "hall" / "run")
    table = tmp_path / "hall-labels.csv"
    table.write_text("file,label,label_source\nrun.wav,creak,human\n")
    samples, refusals = own_samples(table)
    assert (labels_of(samples), refusals) == ([("run.wav", "creak")], [])
    write(tmp_path / "yard" / "run")
    samples, refusals = own_samples(table)
    assert samples == []
    assert "names run.wav, of which there is none or several" in refusals[0]


def test_a_stretch_of_a_track_counts_by_its_seconds(tmp_path):
    write(tmp_path / "a", seconds=7.3, tracks=2)
    (tmp_path / "labels.csv").write_text("file,channel,label\na.wav,2,squawk\n")
    samples, refusals = own_samples(tmp_path / "labels.csv")
    assert labels_of(samples) == [("a.wav", "squawk")]
    assert samples[0].weight == 8 * OWN_WEIGHT
    assert refusals == []


def test_what_cannot_be_used_is_named_in_one_line_each(tmp_path):
    write(tmp_path / "creak" / "good")
    write(tmp_path / "unnamed")
    write(tmp_path / "short", seconds=0.2)
    (tmp_path / "creak" / "bad.wav").write_bytes(b"no sound")
    table = tmp_path / "labels.csv"
    table.write_text(
        "file,start_s,channel,label\nunnamed.wav,,,meow\ngone.wav,,,creak\n"
        "short.wav,0.15,,creak\nshort.wav,0,3,creak\ncreak/good.wav,,,none\n"
    )
    samples, refusals = own_samples(table)
    assert labels_of(samples) == [("good.wav", "none")]
    assert len(refusals) == 4
    for part in (
        "short.wav: creak",
        "no track '3'",
        "label 'meow'",
        "gone.wav, of which there is none or several",
    ):
        assert sum(part in line for line in refusals) == 1, part
    samples, refusals = own_samples(tmp_path)
    assert labels_of(samples) == [("good.wav", "creak")]
    for part in ("unnamed.wav: has no label", "short.wav: has no label", "bad.wav", "labels.csv"):
        assert sum(part in line for line in refusals) == 1, part


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
    assert (said["files"], squeal["stretches"]) == (6, 6)
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
    assert asked[0]["n_training"] == 50
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
