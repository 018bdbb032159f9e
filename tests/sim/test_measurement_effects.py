"""What sensors and cables add to the signals."""

import numpy as np
import pytest
from scipy.signal import welch

from sim.effects import EFFECTS
from tests.helpers.sensor_signals import RATE, read, rms, tone

MEASUREMENT = (
    "background_noise", "mains_hum", "mount_resonance", "clipping", "gain_error", "channel_delay",
)  # fmt: skip


@pytest.mark.parametrize("name", MEASUREMENT)
def test_further_channels_of_a_kind_are_read_as_the_first_and_other_kinds_are_left(name):
    signals = {"acceleration_2": tone(900.0), "speed": np.full(48_000, 5.0)}
    changed = read(signals, name)
    assert not np.allclose(changed["acceleration_2"], signals["acceleration_2"])
    assert np.array_equal(changed["speed"], signals["speed"])


# Noise.


@pytest.mark.parametrize("form", EFFECTS["background_noise"].forms)
def test_a_level_of_noise_is_what_a_level_meter_shows_from_20_hz_to_20_khz(form):
    silence = {"pressure": np.zeros(480_000), "torque": np.zeros(480_000)}
    noise = read(silence, "background_noise", form=form, pressure_level=60.0, torque=0.3)
    assert 20.0 * np.log10(in_band(noise["pressure"]) / 20e-6) == pytest.approx(60.0, abs=0.5)
    assert in_band(noise["torque"]) == pytest.approx(0.3, rel=0.06)


def in_band(signal):
    spectrum = np.fft.rfft(signal)
    frequency = np.fft.rfftfreq(signal.size, 1.0 / RATE)
    spectrum[(frequency < 20.0) | (frequency > 20e3)] = 0.0
    return rms(np.fft.irfft(spectrum))


@pytest.mark.parametrize(("form", "slope"), [("white", 0.0), ("pink", -3.01), ("brown", -6.02)])
def test_noise_falls_by_so_many_decibel_an_octave(form, slope):
    noise = read({"torque": np.zeros(960_000)}, "background_noise", form=form)["torque"]
    frequency, density = welch(noise, RATE, nperseg=8192)
    inside = (frequency > 100.0) & (frequency < 20e3)
    octaves, levels = np.log2(frequency[inside]), 10.0 * np.log10(density[inside])
    assert np.polyfit(octaves, levels, 1)[0] == pytest.approx(slope, abs=0.1)


# Hum.


@pytest.mark.parametrize("form", EFFECTS["mains_hum"].forms)
@pytest.mark.parametrize("frequency", [16.0, 50.0, 60.0, 400.0])
def test_hum_has_its_rms_no_mean_and_only_harmonics_of_the_mains(form, frequency):
    silence = {"acceleration": np.zeros(96_000)}
    hum = read(silence, "mains_hum", form=form, frequency=frequency, acceleration=2.0)
    hum = hum["acceleration"]
    assert rms(hum) == pytest.approx(2.0, rel=1e-3)
    assert abs(hum.mean()) < 1e-3
    power = np.abs(np.fft.rfft(hum)) ** 2
    assert power[:: round(frequency)].sum() == pytest.approx(power.sum(), rel=1e-6)
