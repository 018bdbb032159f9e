"""Segments with other borders or labels: what they keep, and how they are measured."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile

from models.recording import Channel, Recording
from noise.app.corrected_segments import NOT_MEASURED, Correction
from noise.base.tables import write_table
from noise.labels.labelling import label
from noise.labels.summary import ASSUMED
from noise.labels.table import COLUMNS
from noise.recordings import write_recording
from tests.helpers.corrected_table import correct, labels_of
from tests.helpers.labelled_folder import made_row as row


def logged_run(path, seconds):
    """A tone that grows twentyfold in its middle, and hiss beside it."""
    time = np.arange(int(8000 * seconds)) / 8000.0
    tone = np.where(time < 0.5 * seconds, 0.002, 0.04) * np.sin(2.0 * np.pi * 800.0 * time)
    hiss = 1e-4 * np.random.default_rng(0).normal(size=time.size)
    return write_recording(path, Recording((tone + hiss)[None], 8000.0, (Channel("pressure"),)))


LOGGED = {
    "speed_rad_s": 5.0, "speed_rad_s_source": "logged", "interference_mm": 0.2,
    "interference_mm_source": "logged", "material": "EPDM", "material_source": "logged",
    "note": "heard at the left rear", "calibrated": True,
}  # fmt: skip


def test_a_segment_that_is_split_keeps_what_was_logged_and_is_measured(tmp_path):
    logged_run(tmp_path / "a.wav", 20.0)
    write_table(tmp_path / "labels.csv", COLUMNS, [row("a.wav", end=20.0, level_db=50.0, **LOGGED)])
    found = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 10.0, "none"), Correction(10.0, 20.0, "squeal")]
    )
    assert [{name: one[name] for name in LOGGED} for one in found] == [LOGGED] * 2
    quiet, loud = found
    assert loud["level_dba"] - quiet["level_dba"] == pytest.approx(26.0, abs=0.2)
    assert loud["snr_dba"] == pytest.approx(26.0, abs=0.5)
    assert loud["frequency_hz"] == pytest.approx(800.0, rel=0.01)


def test_of_a_long_recording_what_is_new_is_measured_and_the_rest_says_that_it_is_not(tmp_path):
    logged_run(tmp_path / "a.wav", 150.0)
    numbers = {"level_db": 50.0, "level_dba": 50.0, "snr_dba": 3.0}
    before = row("a.wav", end=150.0, **numbers, **LOGGED)
    write_table(tmp_path / "labels.csv", COLUMNS, [before])
    rest, piece = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 140.0, "none"), Correction(140.0, 150.0, "squeal")]
    )
    kept = LOGGED | {"note": f"{LOGGED['note']}; {NOT_MEASURED}"}
    assert {name: rest[name] for name in LOGGED} == kept
    assert rest["level_db"] is rest["snr_dba"] is None
    assert {name: piece[name] for name in LOGGED} == LOGGED
    assert piece["level_db"] == pytest.approx(20.0 * np.log10(0.04 / np.sqrt(2.0) / 2e-5), abs=0.1)
    assert piece["snr_dba"] is None  # the background is that of the whole recording


def test_a_split_segment_is_as_calibrated_as_its_table(tmp_path):
    tone = 0.1 * np.sin(2.0 * np.pi * 800.0 * np.arange(32_000) / 16_000.0)
    soundfile.write(tmp_path / "a.wav", tone, 16_000)
    (before,) = label([tmp_path], out=tmp_path / "labels.csv", full_scale=2.0)
    found = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 1.0, "squeal"), Correction(1.0, 2.0, "none")]
    )
    for one in found:
        assert one["calibrated"] is True
        for name in ("level_db", "level_dbfs", "level_dba"):
            assert one[name] == pytest.approx(before[name], abs=0.05), name


def test_another_label_ends_what_was_inferred_by_the_one_before(tabled):
    inferred = {"speed_rad_s": 5.0, "speed_rad_s_low": 4.0, "speed_rad_s_high": 6.0}
    inferred |= {"speed_rad_s_source": "inferred", "snr_dba": 7.5}
    inferred["note"] = f"left door; conditions inferred {ASSUMED}"
    write_table(tabled / "labels.csv", COLUMNS, [row("a.wav", "creak", **inferred)])
    (found,) = correct(labels_of(tabled), 0, [Correction(0.0, 2.0, "none")])
    assert (found["speed_rad_s"], found["speed_rad_s_source"]) == (None, "missing")
    assert (found["note"], found["snr_dba"]) == ("left door", 7.5)
