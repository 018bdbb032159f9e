"""What is measured of a recording's tracks when a person has named its segments."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile

from noise.app.corrected_segments import Correction
from noise.app.labels import Labels
from noise.base.tables import write_table
from noise.batch.work import find_jobs
from noise.labels.corrections import version
from noise.labels.table import COLUMNS
from tests.helpers.labelled_folder import made_row

RATE = 8000


def write_tone(path, seconds, n_tracks):
    tone = 0.1 * np.sin(2.0 * np.pi * 800.0 * np.arange(int(RATE * seconds)) / RATE)
    soundfile.write(path, np.stack([tone] * n_tracks, axis=1), RATE)


def correct(folder, said):
    labels = Labels(find_jobs([folder]), folder / "labels.csv")
    return labels.correct(0, said, version(labels.rows(0)))


def test_one_track_of_a_long_recording_is_corrected_and_the_other_stays(tmp_path):
    write_tone(tmp_path / "a.wav", 130.0, 2)
    rows = [made_row("a.wav", "none", 0.0, 130.0, channel=track) for track in "12"]
    write_table(tmp_path / "labels.csv", COLUMNS, rows)
    pieces = [Correction(0.0, 125.0, "none", "2"), Correction(125.0, 130.0, "squeal", "2")]
    found = correct(tmp_path, [Correction(0.0, 130.0, "none", "1"), *pieces])
    assert [row["label_source"] for row in found] == ["classifier", "classifier", "human"]
    assert found[2]["level_dbfs"] == pytest.approx(-23.01, abs=0.02)


def test_a_label_of_all_of_a_plain_file_with_several_tracks_is_taken(tmp_path):
    write_tone(tmp_path / "a.wav", 2.0, 2)
    (found,) = correct(tmp_path, [Correction(0.0, 2.0, "squeal")])
    assert (found["channel"], found["label"]) == ("all", "squeal")
