"""Background sounds are as their rows state."""

import numpy as np
import pytest
from scipy.signal import hilbert

from features.kernels.harmonics import analyse_harmonics
from noise.base.labels import SURROUNDINGS
from noise.training.classifier.background_sounds import BACKGROUND_SOUNDS, background_sound
from noise.training.classifier.places import quiet
from noise.training.classifier.synthesis import synthesised, voiced

RATE = 48e3


def made(name, seed, n=96_000):
    return synthesised(BACKGROUND_SOUNDS[name], n, RATE, np.random.default_rng(seed))


def spectrum(sound):
    return np.abs(np.fft.rfft(sound)) ** 2


@pytest.mark.parametrize("name", BACKGROUND_SOUNDS)
@pytest.mark.parametrize("rate", [8_000, 48_000])
def test_every_row_makes_a_sound_that_can_be_made_again(name, rate):
    for seed in range(2):
        sound, again = (
            background_sound(rate // 2, float(rate), np.random.default_rng(seed), name)
            for _ in range(2)
        )
        assert sound.shape == (rate // 2,)
        assert np.isfinite(sound).all()
        assert sound.tobytes() == again.tobytes()
    assert {*BACKGROUND_SOUNDS[name]["surroundings"]} <= {*SURROUNDINGS}


def cricket(seed, carrier, pulses, on, period):
    layer = {
        "source": "harmonics", "n": 1, "pitch": {"at": carrier, "wander": [0.004, 3.0]},
        "changes": [{"pulsed": [pulses, 0.6, on, period]}],
    }  # fmt: skip
    return synthesised({"layer": [layer]}, 96_000, RATE, np.random.default_rng(seed))


def test_a_cricket_sings_at_its_carrier_in_pulses_of_its_rate():
    song = cricket(3, 4200.0, 30.0, 1, 1)
    power = spectrum(song)
    assert power[2 * 500 :].argmax() / 2 + 500 == pytest.approx(4200, rel=0.03)
    beat = spectrum(np.abs(hilbert(song)) - np.abs(hilbert(song)).mean())
    assert beat[2 * 15 : 2 * 45].argmax() / 2 + 15 == pytest.approx(30.0, abs=1.0)


def test_a_crickets_chirp_has_the_pulses_stated():
    song = cricket(5, 5000.0, 40.0, 3, 20)
    loud = np.abs(hilbert(song)) > 0.25 * np.abs(song).max()
    sounding = np.convolve(loud.astype(float), np.ones(240), mode="same") > 0
    starts = np.flatnonzero(np.diff(sounding.astype(int)) > 0)
    assert 10 <= starts.size <= 14


def peaks_of_bursts(sound):
    """Strongest frequency [Hz], to 20 Hz, of every loud piece of 50 ms."""
    pieces = [sound[a : a + 2400] * np.hanning(2400) for a in range(0, 93_600, 1200)]
    return [20 * spectrum(p)[15:].argmax() + 300 for p in pieces if p.std() > 0.4 * sound.std()]


def test_an_alarm_has_a_few_exact_notes_where_a_bird_has_many():
    def distinct(name, seed):
        peaks = peaks_of_bursts(made(name, seed))
        return len(set(peaks)) / len(peaks)

    alarms = [distinct("alarm", seed) for seed in range(12)]
    birds = [distinct("birds", seed) for seed in range(12)]
    assert np.median(alarms) < 0.25 < np.median(birds)


def test_a_voice_has_the_pitch_asked_for():
    sound = voiced(48_000, RATE, np.full(48_000, 310.0), (900.0,), np.random.default_rng(0))
    assert analyse_harmonics(sound, RATE).fundamental == pytest.approx(310.0, rel=0.05)


def test_ticks_of_a_clock_keep_their_beat():
    for seed in range(6):
        sound = made("clock_tick", seed, 144_000)
        envelope = np.convolve(np.abs(sound), np.ones(480), mode="same")
        above = envelope > 0.3 * envelope.max()
        starts = np.flatnonzero(np.diff(above.astype(int)) > 0)
        gaps = np.diff(starts[np.concatenate([[True], np.diff(starts) > 2400])]) / RATE
        assert gaps.std() < 0.25 * gaps.mean() + 0.01


def test_quiet_knows_digital_silence_and_hum():
    drawn = [quiet(24_000, RATE, np.random.default_rng(seed)) for seed in range(120)]
    assert any(not sound.any() for sound in drawn)
    assert all(np.isfinite(sound).all() for sound in drawn)

    def low(sound):
        power = spectrum(sound)
        return power[: round(24_000 * 1500 / RATE)].sum() > 0.9 * power.sum() > 0

    assert 10 < sum(map(low, drawn)) < 110
