"""Recordings that are described in pieces have the features that they have as a whole."""

import numpy as np
import pytest

import features.table
from features.table import features_of, piece_count, recording_features
from models.condition import Condition
from models.recording import Channel, Recording
from noise.recordings import write_recording
from noise.recordings.files import open_blocks
from tests.features.test_feature_rates import sawtooth
from tests.features.test_feature_sounds import SOUNDS

RATE = 48_000.0


def stationary(kind, sound, seconds):
    x = sawtooth(seconds)[::4] if kind == "torque" else SOUNDS[sound](seconds)[::2]
    return Recording(x[np.newaxis], RATE, (Channel(kind),))


def first(run, seconds):
    return Recording(run.samples[:, : round(seconds * RATE)], RATE, run.channels)


def check_alike(kind, run, one, other):
    """Two descriptions of stretches differ by no more than twice what three of `run` do."""
    n = run.samples.shape[1] // 3
    parts = [Recording(run.samples[:, i * n : (i + 1) * n], RATE, run.channels) for i in range(3)]
    found = [recording_features(part) for part in parts]
    for feature in features_of(kind):
        name = f"{kind}_{feature.name}"
        values = np.array([values[name] for values in found])
        scatter = float(np.ptp(values)) if not np.isnan(values).any() else 0.0
        tolerance = max(feature.tolerance[0] * abs(one[name]), feature.tolerance[1], 2 * scatter)
        assert other[name] == pytest.approx(one[name], rel=0.0, abs=tolerance, nan_ok=True), name


@pytest.mark.parametrize(
    ("kind", "sound"), [("pressure", "creak"), ("pressure", "squeal"), ("torque", "")]
)
def test_there_is_no_jump_where_pieces_begin(kind, sound, monkeypatch):
    assert (piece_count(round(43 * RATE)), piece_count(round(45 * RATE))) == (1, 5)
    monkeypatch.setattr(features.table, "LONG", 1 << 19)
    monkeypatch.setattr(features.table, "PIECE", 1 << 17)
    run = stationary(kind, sound, 11.5)
    shorter = first(run, 10.5)
    assert [piece_count(one.samples.shape[1]) for one in (shorter, run)] == [1, 5]
    check_alike(kind, run, recording_features(shorter), recording_features(run))


def test_a_long_file_has_the_features_of_the_recording_in_memory(tmp_path, monkeypatch):
    n = 300_000
    samples = np.stack([sawtooth(n / RATE)[::4][:n], 5.0 * np.arange(n) / RATE])
    known = Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon")
    run = Recording(
        samples.astype(np.float32).astype(float), RATE, (Channel("torque"), Channel("angle")), known
    )
    path = write_recording(tmp_path / "run.wav", run)
    monkeypatch.setattr("noise.recordings.files._LARGE", 0)
    monkeypatch.setattr(features.table, "LONG", 1)
    monkeypatch.setattr(features.table, "PIECE", 100_000)
    in_memory = recording_features(run)
    with open_blocks(path) as blocks:
        assert blocks is not None
        assert recording_features(blocks) == pytest.approx(in_memory, nan_ok=True)
