"""Levels in the label table: those that every other table has, and over the background."""

import numpy as np
import pytest

from models.recording import Channel, Recording, RecordingBlocks
from models.rig_file import load_material_rig
from noise.audio.assessment import assess
from noise.classifier import load_classifier
from noise.labels.levels import with_levels
from noise.labels.rows import label_rows
from noise.labels.segments import Segment, label_recording
from sim.run import simulate

CLASSIFIER = load_classifier()
RATE = 30_000


def recorded(pressure, *, calibrated=True):
    return Recording(pressure[None, :], float(RATE), (Channel("pressure"),), calibrated=calibrated)


def rows_of(recording):
    return label_rows("run.wav", recording, label_recording(recording, CLASSIFIER))


def segment(start, end, label):
    return Segment("all", start, end, label, {label: 1.0}, None, None, None)


@pytest.fixture(scope="module")
def squeal():
    rig = load_material_rig("fluorocarbon")
    return simulate(rig, 10.0, support_stiffness=3745.0, seconds=2.0).recording["pressure"]


def noise(seconds, rms):
    return rms * np.random.default_rng(0).standard_normal(round(seconds * RATE))


def test_a_squeal_stands_over_its_background_by_what_it_is_louder(squeal):
    weighted = assess(recorded(squeal)).levels.level_a
    hiss = noise(6.0, 1.0)
    hiss *= 10 ** (0.05 * (weighted - 20.0 - assess(recorded(hiss)).levels.level_a))
    sound = hiss.copy()
    sound[2 * RATE : 4 * RATE] += squeal
    for calibrated in (True, False):
        rows = rows_of(recorded(sound, calibrated=calibrated))
        (named,) = (row for row in rows if row["label"] == "squeal")
        assert named["snr_dba"] == pytest.approx(20.0, abs=0.5)
        assert (named["level_dba"] is None) == (not calibrated)
        assert all(abs(row["snr_dba"]) < 1.0 for row in rows if row["label"] == "none")


def test_a_slam_does_not_raise_the_background():
    sound = noise(4.0, 0.01)
    parts = [segment(0.0, 3.0, "unknown"), segment(3.0, 4.0, "squeal")]
    before = with_levels(RecordingBlocks.of(recorded(sound)), parts)
    sound[RATE : RATE + RATE // 10] *= 300.0
    after = with_levels(RecordingBlocks.of(recorded(sound)), parts)
    assert after[1].snr == pytest.approx(before[1].snr, abs=0.1)
    assert after[0].level_a > before[0].level_a + 20.0


@pytest.mark.parametrize(
    ("sound", "parts"),
    [
        (noise(2.0, 0.1), [segment(0.0, 2.0, "squeal")]),
        (noise(2.0, 0.1), [segment(0.0, 0.5, "none"), segment(0.5, 2.0, "creak")]),
        (
            np.concatenate([np.zeros(2 * RATE), noise(2.0, 0.1)]),
            [segment(0.0, 1.9, "none"), segment(1.9, 4.0, "creak")],
        ),
    ],
    ids=["nothing else", "too little else", "digital silence"],
)
def test_where_there_is_no_background_nothing_is_over_it(sound, parts):
    found = with_levels(RecordingBlocks.of(recorded(sound)), parts)
    assert [one.snr for one in found] == [None] * len(parts)
    assert found[-1].level_a is not None


@pytest.mark.parametrize("calibrated", [True, False])
@pytest.mark.parametrize(
    "silence", [np.zeros(4 * RATE), 1e-12 * noise(4.0, 1.0)], ids=["zeros", "what a fade left"]
)
def test_digital_silence_is_no_background(squeal, silence, calibrated):
    hiss = noise(3.0, 0.001)
    amid = rows_of(recorded(np.concatenate([hiss, squeal]), calibrated=calibrated))
    gated = rows_of(recorded(np.concatenate([silence, hiss, squeal]), calibrated=calibrated))
    assert gated[-1]["label"] == "squeal"
    assert gated[-1]["snr_dba"] == pytest.approx(amid[-1]["snr_dba"], abs=0.2)
    alone = rows_of(recorded(np.concatenate([silence, squeal]), calibrated=calibrated))
    assert all(row["snr_dba"] is None for row in alone)
