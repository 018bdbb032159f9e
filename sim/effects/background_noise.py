"""Random noise on the channels: of the room, the amplifiers and other machines.

Gaussian noise n(t), independent on each channel, with the power spectral density
S(f) proportional to f**(-b): white (b = 0, amplifiers), pink (b = 1, contacts, machines far away)
and brown (b = 2, ventilation, vibration of the building), constant below 20 Hz. It is white noise
shaped through its Fourier transform (Timmer & Koenig 1995, Astron. Astrophys. 300, 707), scaled so
that the *expected* rms from 20 Hz to 20 kHz is the level: levels hold for any sampling rate, and a
recording at 30 kHz shows 1.4 dB less of white noise. The level of the sound is in dB re 20 uPa,
unweighted; the others are rms values in the channel's unit. The defaults are those of an ordinary
workshop and plain amplifiers (assumed). Amount zero is no noise. The default of the angle is that
of a potentiometer like the thesis's, 10 rad/V (Appendix B), behind an amplifier with 0.1 mV of
noise; an encoder counts lines and has none (``angle=0``).

>>> quiet = {"pressure": np.zeros(90_000)}
>>> values = {"amount": 1.0, "pressure_level": 50.0, "acceleration": 0.2, "torque": 0.05,
...           "angle": 1e-3}
>>> room = _sensors(quiet, 90e3, "pink", values,
...                 np.random.default_rng(0))["pressure"]
>>> 49.0 < float(20.0 * np.log10(room.std() / 20e-6)) < 52.0
True
"""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

from sim.chain import channel_level
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values

_LOWEST, _HIGHEST = 20.0, 20e3
"""Band of the levels [Hz]."""

_EXPONENTS = {"white": 0.0, "pink": 1.0, "brown": 2.0}


def _sensors(
    signals: Signals, rate: float, form: str, values: Values, rng: np.random.Generator
) -> Signals:
    noisy = {}
    for name, signal in signals.items():
        level = values["amount"] * channel_level(name, values)
        noisy[name] = signal + level * _noise(signal.size, rate, _EXPONENTS[form], rng)
    return noisy


def _noise(n: int, rate: float, exponent: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return noise with the expected rms 1 in the band of levels."""
    length = next_fast_len(n, real=True)
    frequency = rfftfreq(length, 1.0 / rate)
    gain = np.maximum(frequency, _LOWEST) ** (-0.5 * exponent)
    # Mean square of white noise: each line but the first and the last counts twice, and covers the
    # frequencies nearest to it, of which part may be out of the band.
    width = rate / length
    counted = np.clip((frequency - _LOWEST) / width + 0.5, 0.0, 1.0)
    counted *= np.clip((_HIGHEST - frequency) / width + 0.5, 0.0, 1.0)
    power = 2.0 * float(np.sum(counted * gain**2)) / length
    noise = irfft(gain * rfft(rng.standard_normal(length)), length)[:n]
    return np.asarray(noise / np.sqrt(power))


EFFECT = Effect(
    name="background_noise",
    stage=Stage.MEASUREMENT,
    forms=("white", "pink", "brown"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 100.0, "factor on the noise of all channels"),
        "pressure_level": Parameter(
            50.0, "dB re 20 uPa", -40.0, 130.0, "level from 20 Hz to 20 kHz"
        ),
        "acceleration": Parameter(0.2, "m/s2", 0.0, 1e3, "rms from 20 Hz to 20 kHz"),
        "torque": Parameter(0.05, "Nm", 0.0, 100.0, "rms from 20 Hz to 20 kHz"),
        "angle": Parameter(1e-3, "rad", 0.0, 1.0, "rms from 20 Hz to 20 kHz"),
    },
    strength="amount",
    sensors=_sensors,
)
