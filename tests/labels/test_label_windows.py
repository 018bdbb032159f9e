"""Windows of a recording: the same numbers at any rate and gain, in memory or from a file."""

import numpy as np
import pytest
import soundfile
from scipy.signal import resample_poly

from features.table import WINDOW_FEATURES
from features.windows.table import WINDOW_NAMES, window_count
from models.recording import Channel, Recording, RecordingBlocks
from noise.labels.levels import cell_edges, rms_level
from noise.labels.segmentation import change_points, viterbi_path
from noise.labels.windows import FEATURE_NAMES, window_features
from noise.recordings import files as blocks_module
from noise.recordings.files import open_blocks
from noise.training.draws import coloured_noise


def recording(*rows, rate=48_000.0, names=("pressure", "acceleration", "torque")):
    channels = tuple(Channel(name) for name in names[: len(rows)])
    return Recording(np.stack(rows), float(rate), channels, calibrated=False)


def described(samples, rate):
    return window_features(RecordingBlocks.of(recording(samples, rate=rate)))


def noise(seconds, rate=48_000, seed=0):
    """Blows at 40 a second over a tone and pink noise."""
    rng = np.random.default_rng(seed)
    n = round(seconds * rate)
    time = np.arange(n) / rate
    since = np.mod(time, 0.025)
    blows = np.exp(-since / 0.004) * np.sin(2 * np.pi * 3100.0 * since)
    return blows + 0.3 * np.sin(2 * np.pi * 880.0 * time) + 0.02 * coloured_noise(n, 1.0, rng)


def test_each_feature_of_a_window_has_its_own_name_a_unit_and_a_definition():
    assert len(set(WINDOW_NAMES)) == len(WINDOW_NAMES)
    for feature in WINDOW_FEATURES:
        assert feature.unit
        assert feature.definition.endswith(".")


@pytest.fixture(scope="module")
def reference():
    return described(noise(2.0, 192_000), 192_000.0)


@pytest.mark.parametrize("rate", [16_000, 22_050, 44_100, 96_000])
def test_features_do_not_depend_on_the_sampling_rate(reference, rate):
    found = described(resample_poly(noise(2.0, 192_000), rate, 192_000), rate)
    inside = slice(1, -1)  # the resampler's own ends
    for name, tolerance in {
        "peak_frequency": 0.01,
        "tone_share": 0.02,
        "period_rate": 0.02,
        "period_strength": 0.05,
        "line_frequency": 0.005,
        "line_count": 1.0,
        "high_blow_rate": 0.05,
        "flatness": 1.0,
        "above_2": 0.5,
        "band_5": 0.3,
    }.items():
        column = FEATURE_NAMES.index(f"pressure_{name}")
        expected = reference.features[inside, column]
        assert found.features[inside, column] == pytest.approx(expected, abs=tolerance), name


def test_features_do_not_depend_on_the_gain():
    samples = noise(2.0)
    one, other = described(samples, 48e3), described(1e-4 * samples, 48e3)
    assert np.allclose(one.features, other.features, rtol=1e-3, atol=1e-3, equal_nan=True)
    assert one.level - other.level == pytest.approx(80.0, abs=0.01)


def test_a_tone_and_a_row_of_blows_are_described_as_such(reference):
    values = dict(zip(WINDOW_NAMES, reference.features[3], strict=False))
    assert 1000.0 * 2.0 ** values["line_frequency"] == pytest.approx(880.0, rel=0.01)
    assert 10.0 * 2.0 ** values["high_period_rate"] == pytest.approx(40.0, rel=0.02)
    assert 10.0 * 2.0 ** values["high_blow_rate"] == pytest.approx(40.0, rel=0.1)


@pytest.mark.parametrize("seconds", [0.15, 0.3])
def test_a_short_tone_in_faint_noise_is_described_as_if_it_went_on(seconds):
    rate, begin = 16_000, 0.9
    faint = 0.01 * np.random.default_rng(0).standard_normal(3 * rate)
    time = np.arange(faint.size) / rate
    tone = np.sin(2 * np.pi * 2900.0 * time)
    short = np.where((time > begin) & (time < begin + seconds), tone, 0.0)
    one, steady = described(faint + short, rate).features, described(faint + tone, rate).features
    whole = [w for w in range(len(one)) if 0.25 * w < begin and 0.25 * w + 0.5 > begin + seconds]
    assert whole
    for name, tolerance in {
        "peak_frequency": 0.01,
        "line_frequency": 0.01,
        "tone_share": 0.02,
        "tone_steady": 0.05,
        "flux": 0.05,
        "onset_mean": 3.0,
        "band_rise": 10.0,
    }.items():
        column = FEATURE_NAMES.index(f"pressure_{name}")
        assert one[whole, column] == pytest.approx(steady[whole, column], abs=tolerance), name


@pytest.mark.parametrize("seconds", [1e-3, 0.02, 0.2, 0.49, 0.51, 1.0, 7.1, 14.3, 21.0])
def test_windows_and_levels_reach_to_the_end(seconds):
    samples = noise(seconds, 16_000)
    found = described(samples, 16e3)
    assert len(found.features) == window_count(samples.size)
    assert cell_edges(16e3, samples.size)[-1] == samples.size
    level = rms_level(RecordingBlocks.of(recording(samples, rate=16e3)), 0, 0, samples.size)
    assert level == pytest.approx(20.0 * np.log10(samples.std()), abs=1e-6)


def test_from_a_file_in_blocks_comes_the_same_as_from_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(blocks_module, "_LARGE", 0)
    monkeypatch.setattr("noise.recordings.files._CHUNK", 8 * 50_000)
    rng = np.random.default_rng(1)
    samples = (0.1 * noise(23.3, 22_050) * rng.uniform(0.5, 1.0)).astype(np.float32)
    soundfile.write(tmp_path / "long.wav", samples, 22_050, subtype="FLOAT")
    whole = described(samples.astype(np.float64), 22_050.0)
    with open_blocks(tmp_path / "long.wav") as blocks:
        parts = window_features(blocks)
    assert parts.features.tobytes() == whole.features.tobytes()
    assert parts.frames.tobytes() == whole.frames.tobytes()


def test_channels_that_are_not_there_have_no_features():
    sound = noise(1.0, 30_000)
    both = window_features(RecordingBlocks.of(recording(sound, 2.0 * sound, rate=30e3)))
    alone = described(sound, 30e3)
    pressure = [name.startswith("pressure_") for name in FEATURE_NAMES]
    torque = [name.startswith("torque_") for name in FEATURE_NAMES]
    assert np.array_equal(both.features[:, pressure], alone.features[:, pressure], equal_nan=True)
    assert np.isnan(alone.features[:, ~np.array(pressure)]).all()
    assert np.isnan(both.features[:, torque]).all()


@pytest.mark.parametrize("at", [0.83, 1.47, 2.002, 2.61])
def test_the_change_from_noise_to_tone_is_found_to_50_ms(at):
    rate = 32_000
    samples = noise(4.0, rate)
    time = np.arange(samples.size) / rate
    tone = np.sin(2 * np.pi * 1500.0 * time)
    found = described(np.where(time < at, samples, tone), rate)
    before = int(np.floor(at / 0.25 - 1.0))
    (change,) = change_points(found.frames, np.array([before]))
    assert change == pytest.approx(at, abs=0.05)


def test_a_short_doubt_is_no_segment_but_a_long_one_is():
    sure, other = [0.9, 0.1], [0.1, 0.9]
    doubt = [0.45, 0.55]
    assert not viterbi_path(np.array([sure] * 4 + [doubt] * 2 + [sure] * 4)).any()
    course = viterbi_path(np.array([sure] * 4 + [other] * 4 + [sure] * 4))
    assert course.tolist() == [0] * 4 + [1] * 4 + [0] * 4


def tone_in_noise(n, rate=48_000):
    noise = np.random.default_rng(0).standard_normal(n)
    return 0.1 * noise + np.sin(2 * np.pi * 900.0 * np.arange(n) / rate)


@pytest.mark.parametrize("stored", [8_000, 16_000, 22_050])
def test_a_recording_brought_back_to_48_khz_is_described_as_it_was_stored(stored):
    low = resample_poly(tone_in_noise(96_000), stored, 48_000)
    back = resample_poly(low, 48_000, stored)
    a, b = described(low, stored).features, described(back, 48_000).features
    assert np.array_equal(np.isnan(a), np.isnan(b))
    known = np.isfinite(a)
    assert np.median(np.abs(a - b)[known]) < 0.01
