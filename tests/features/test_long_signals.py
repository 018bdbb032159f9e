"""A signal that is read piece by piece has the features of the signal as a whole."""

from __future__ import annotations

import math

import numpy as np
import pytest

from features.kernels.slip_drops import torque_slips
from features.kernels.spectra import welch
from features.long.prepared import prepare_long
from features.long.slips import long_torque_slips
from features.long.sums import Moments, WelchSum
from features.long.turning_points import TurningPoints
from features.named.prepared import prepare
from features.registry import features_of, recording_features
from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.recordings import write_recording
from noise.recordings.blocks import open_blocks
from tests.features.test_feature_rates import RHYTHM
from tests.features.test_feature_sounds import MASTER_RATE, SOUNDS

SECONDS = 12.0

CLOSE = ("level", "third_octave", "line", "centroid", "spread", "hum", "tone", "harmonic_count")
"""Features that agree within a hundredth of what sampling rates agree within, by how they begin."""


def torque(rate, seconds=SECONDS, *, swing=False):
    """Sticks and slips 35 times a second, about a mean that drifts; or to and fro."""
    t = np.arange(round(rate * seconds)) / rate
    held = 8.0 + np.interp(35.0 * t % 1.0, [0.0, 0.95, 1.0], [-3.0, 3.0, -3.0])
    held += 0.3 * np.sin(2 * np.pi * 0.1 * t) + 0.05 * np.random.default_rng(3).normal(size=t.size)
    return held * np.where(np.sin(2 * np.pi * 0.25 * t) < 0.0, -1.0, 1.0) if swing else held


def pieces_of(x, size=70_001):
    return lambda: (x[at : at + size] for at in range(0, x.size, size))


def both(x, rate, kind):
    whole = prepare(x, rate, kind, stick_rate=200.0)
    long = prepare_long(lambda first, last: x[first:last], x.size, rate, kind, stick_rate=200.0)
    for feature in features_of(kind):
        yield feature, feature(whole), feature(long)


@pytest.mark.parametrize("kind", ["pressure", "acceleration"])
@pytest.mark.parametrize("sound", sorted(SOUNDS))
def test_a_long_sound_has_the_features_of_the_whole(sound, kind):
    x = 0.4 + SOUNDS[sound](SECONDS)[:: 2 if kind == "pressure" else 1]
    rate = MASTER_RATE / (2 if kind == "pressure" else 1)
    for feature, whole, long in both(x, rate, kind):
        if feature.name in RHYTHM and sound != "creak":
            continue
        tolerance = max(feature.tolerance[0] * abs(whole), feature.tolerance[1])
        if feature.name.startswith(CLOSE):
            tolerance *= 0.01
        assert long == pytest.approx(whole, rel=0.0, abs=tolerance, nan_ok=True), feature.name


@pytest.mark.parametrize("swing", [False, True])
@pytest.mark.parametrize("rate", [30e3, 44.1e3])
def test_a_long_torque_has_the_features_of_the_whole(rate, swing):
    for feature, whole, long in both(torque(rate, swing=swing), rate, "torque"):
        tolerance = max(feature.tolerance[0] * abs(whole), feature.tolerance[1])
        assert long == pytest.approx(whole, rel=0.0, abs=tolerance, nan_ok=True), feature.name


@pytest.mark.parametrize("swing", [False, True])
@pytest.mark.parametrize("size", [1_000, 70_001, 1_000_000])
def test_slips_do_not_depend_on_the_pieces(swing, size):
    x = torque(30e3, swing=swing)
    whole, long = torque_slips(x, 30e3), long_torque_slips(pieces_of(x, size), x.size, 30e3)
    np.testing.assert_array_equal(long.times, whole.times)
    for name in ("mean_drop", "drop_variation", "glide", "stick_slope", "stick_curvature"):
        assert getattr(long, name) == pytest.approx(getattr(whole, name), rel=1e-9), name
    assert long.asymmetry == pytest.approx(whole.asymmetry, rel=1e-9)


def test_silence_and_a_constant_torque_are_described_as_ever():
    for kind, x in (("pressure", np.zeros(200_000)), ("torque", np.full(200_000, 5.0))):
        for feature, whole, long in both(x, 48e3, kind):
            assert long == pytest.approx(whole, nan_ok=True), feature.name


def test_a_spectrum_does_not_depend_on_the_pieces():
    x = np.random.default_rng(1).normal(size=100_000)
    whole, total = welch(x, 48e3, 1.4), WelchSum(x.size, 48e3, 1.4)
    for piece in np.array_split(x, 7):
        total.add(piece)
    assert total.spectrum().n_segments == whole.n_segments
    np.testing.assert_allclose(total.spectrum().density, whole.density, rtol=1e-9)


def test_moments_of_an_offset_keep_their_digits():
    x, moments = 1e6 + np.random.default_rng(1).normal(size=100_000), Moments()
    for piece in np.array_split(x, 7):
        moments.add(piece)
    assert moments.mean == pytest.approx(x.mean(), rel=1e-14)
    assert moments.variance == pytest.approx(x.var(), rel=1e-9)


def test_maxima_are_those_of_the_whole():
    from scipy.signal import find_peaks

    x = np.cumsum(np.random.default_rng(1).normal(size=20_000))
    points = TurningPoints(5.0)
    for piece in np.array_split(x, 9):
        points.add(piece)
    peaks, _ = find_peaks(x, prominence=5.0)
    np.testing.assert_array_equal(points.peaks, peaks)
    ends = np.append(peaks[1:], x.size)
    lowest = [p + x[p:e].argmin() for p, e in zip(peaks, ends, strict=True)]
    np.testing.assert_array_equal(points.troughs, lowest)


def test_a_sample_that_is_no_number_is_named():
    x = np.zeros(200_000)
    x[150_000] = math.inf
    with pytest.raises(ParameterError, match="sample 150000 is inf"):
        prepare_long(lambda first, last: x[first:last], x.size, 48e3, "pressure")


def test_a_long_file_has_the_features_of_the_recording_in_memory(tmp_path, monkeypatch):
    rate = 30_000.0
    turning = 5.0 * np.arange(round(rate * SECONDS)) / rate
    run = Recording(
        np.stack([torque(rate), SOUNDS["creak"](SECONDS)[::3][: turning.size], turning]),
        MASTER_RATE / 3.2,
        (Channel("torque"), Channel("pressure"), Channel("angle")),
        Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon"),
    )
    path = write_recording(tmp_path / "run.wav", run)
    stored = Recording(
        run.samples.astype(np.float32).astype(float), run.rate, run.channels, run.condition
    )
    in_memory = recording_features(stored)
    monkeypatch.setattr("noise.recordings.blocks._LARGE", 0)
    monkeypatch.setattr("features.registry.LONG", 0)
    with open_blocks(path) as blocks:
        assert blocks is not None
        found = recording_features(blocks)
    assert found.keys() == in_memory.keys()
    for name in ("torque_slope_ratio", "torque_drop", "pressure_level", "pressure_pulse_rate"):
        assert found[name] == pytest.approx(in_memory[name], rel=1e-3), name
