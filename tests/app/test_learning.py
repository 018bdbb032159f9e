"""Learning from corrections: what is learned from, what is told of it, what is labelled anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.app.labels.corrections import Correction
from noise.app.labels.store import Labels
from noise.app.labels.training_run import TrainingRun, own_classifier
from noise.app.opened import open_paths
from noise.base.label_names import LABELS
from noise.classifier import load_classifier
from noise.cli import main
from noise.labels.labelling import Labelling
from noise.labels.row_places import version
from noise.recordings import write_recording
from noise.training.classifier.own_samples import own_card
from tests.helpers.labelled_folder import made_row, write_folder
from tests.helpers.opened_app import opened_app

NAMES = ("a.wav", "b.wav", "c.wav")


class Here:
    """A command that runs here and at once."""

    running, message, progress = False, "learning", (0, 0)

    def __init__(self, ended):
        self._ended = ended
        self.code = None

    def start(self, arguments):
        self.code = main(arguments)
        self._ended(self.code)


class Labelled:
    """Labelling that is asked for."""

    def __init__(self):
        self.by = []

    def stop(self):
        pass

    def start(self, classifier):
        self.by.append(classifier)


@pytest.fixture
def folder(tmp_path):
    time = np.arange(24_000) / 16_000.0
    for number, name in enumerate(NAMES):
        tone = np.sin(2.0 * np.pi * (700.0 + 100.0 * number) * time)
        run = Recording(tone[None], 16_000.0, (Channel("pressure"),))
        write_recording(tmp_path / name, run)
    return write_folder(tmp_path, (), [made_row(name, end=1.5) for name in NAMES])


@pytest.fixture
def learning(folder, monkeypatch):
    monkeypatch.setattr("noise.app.labels.training_run.Command", Here)
    opened = open_paths([folder])
    labels = Labels(opened.jobs, opened.table, Labelling())
    labelled = Labelled()
    return labels, labelled, TrainingRun(labels, labelled, opened)


def test_what_a_person_has_said_is_learned_and_nothing_else(learning, folder, monkeypatch):
    labels, labelled, training = learning
    learned = []

    def train(*, added, **_):
        learned.extend(added)
        before = np.array([LABELS.index("none")] * len(added))
        return replace(load_classifier(), card={"own": own_card(added, before, before)})

    monkeypatch.setattr("noise.training.classifier.fit.train", train)
    said = [Correction(0.0, 0.75, "squeal"), Correction(0.75, 1.5, "none")]
    labels.correct(1, said, version(labels.rows(1)))
    training.start()
    assert [sample.label for sample in learned] == ["squeal", "none"]
    assert {sample.name for sample in learned} == {str((folder / "b.wav").resolve())}
    assert labelled.by == [own_classifier(folder / "labels.csv")]
    state = training.state()
    assert state["corrected"] == 1
    told = [(one["label"], one["windows"], one["recall"]) for one in state["scores"]["labels"]]
    assert told == [("squeal", 1, 0.0), ("none", 1, 1.0)]


def test_where_nothing_is_corrected_nothing_is_learned(learning):
    with pytest.raises(ParameterError, match="nothing is corrected"):
        learning[2].start()


def test_a_training_that_fails_says_so_and_labels_nothing(learning, monkeypatch):
    labels, labelled, training = learning

    def train(**_):
        raise ParameterError("50 training samples hold no creak; draw more of them")

    monkeypatch.setattr("noise.training.classifier.fit.train", train)
    labels.correct(1, [Correction(0.0, 1.5, "squeal")], version(labels.rows(1)))
    training.start()
    assert labelled.by == []
    assert training.state()["message"].startswith("Nothing was learned")


@pytest.mark.slow
def test_the_button_learns_and_labels_all_but_what_a_person_has_said(folder):
    with opened_app(folder, "--samples", 60) as app:
        app.correct(0, "unknown", 0.0, 1.5)
        app.json("api/train", {})
        while app.json("api/train")["running"] or app.json("api/recordings")["state"]["running"]:
            pass
        state = app.json("api/train")
        assert state["scores"]["files"] == 1, state["message"]
        assert app.json("api/recordings/0/segments")["rows"][0]["label_source"] == "human"
        assert app.json("api/recordings/1/segments")["rows"][0]["p_squeal"] is not None
        shown = app.json("api/recordings")["state"]
        assert (shown["classifier"], shown["done"]) == ("labels.classifier.npz", 3)
