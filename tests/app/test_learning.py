"""Learning from corrections by the app: what is learned from, and what is labelled anew."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.app.label_view import LabellingRun
from noise.app.labels import Correction
from noise.app.opened import open_paths
from noise.base.tables import read_table
from noise.labels.corrections import version
from noise.recordings import write_recording
from tests.helpers.labelled_folder import made_row, write_folder

NAMES = ("a.wav", "b.wav", "c.wav")


@pytest.fixture
def folder(tmp_path):
    t = np.arange(24_000) / 16_000.0
    for number, name in enumerate(NAMES):
        tone = np.sin(2.0 * np.pi * (700.0 + 100.0 * number) * t)
        run = Recording(tone[None], 16_000.0, (Channel("pressure"),))
        write_recording(tmp_path / name, run)
    return write_folder(tmp_path, (), [made_row(name, end=1.5) for name in NAMES])


def test_what_a_person_has_corrected_is_learned_and_nothing_else(folder, monkeypatch):
    asked = []
    monkeypatch.setattr("noise.app.commands.Command.start", lambda _, call: asked.append(call))
    opened = open_paths([folder], samples=60)
    run = LabellingRun(opened, opened.table)
    with pytest.raises(ParameterError, match="nothing is corrected"):
        run.learn()
    segments = [Correction(0.0, 0.75, "squeal"), Correction(0.75, 1.5, "none", confirmed=True)]
    run.labels.correct(1, segments, version(run.labels.rows(1)))
    run.learn()
    ((command, _, table, _, out, *rest),) = asked
    assert (command, out, rest[-2:]) == (
        "train", str(folder / "labels.classifier.npz"), ["--samples", "60"]
    )  # fmt: skip
    rows = read_table(Path(table))[1]
    assert [(row["file"], row["label"]) for row in rows] == [
        (str(folder / "b.wav"), "squeal"), (str(folder / "b.wav"), "none")
    ]  # fmt: skip
    opened.leaving.close()
