"""Random noise on the channels: the room, the amplifiers, whatever else runs in the laboratory.

Gaussian noise n(t), independent on each channel, with the power spectral density
S(f) proportional to f**(-b): white (b = 0, amplifiers), pink (b = 1, contacts, machines far away)
and brown (b = 2, ventilation, vibration of the building), constant below 20 Hz. It is white noise
shaped through its Fourier transform (Timmer & Koenig 1995, Astron. Astrophys. 300, 707), scaled
such that the *expected* rms from 20 Hz to 20 kHz is the level given: levels hold for any sampling
rate, and a recording at 30 kHz shows 1.4 dB less of the white one. A loudness of the room comes in
dB re 20 uPa, as a sound level meter shows it unweighted; the others as rms in the channel's unit.
The defaults are an ordinary workshop and plain amplifiers; assumed. Amount zero is no noise. The
angle's is that of a potentiometer as the thesis's, 10 rad to the volt (Appendix B), behind an
amplifier of 0.1 mV; an encoder counts lines and has none, which ``angle=0`` says.

>>> quiet = {"pressure": np.zeros(90_000)}
>>> values = {"amount": 1.0, "pressure_level": 50.0, "acceleration": 0.2, "torque": 0.05,
...           "angle": 1e-3}
>>> room = _sensors(quiet, 90e3, "pink", values,
...                 {"rng": np.random.default_rng(0), "whole": True})["pressure"]
>>> 49.0 < float(20.0 * np.log10(room.std() / 20e-6)) < 52.0
True
"""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

from sim.chain import channel_level
from sim.effects.effect import Effect, Memory, Parameter, Signals, Stage, Values

_LOWEST, _HIGHEST = 20.0, 20e3
"""Band that levels are those of [Hz]."""

_STRETCH = 0.3
"""Length of noise that is made at once, at least, of a run that goes on [s]."""

_EXPONENTS = {"white": 0.0, "pink": 1.0, "brown": 2.0}


def _sensors(signals: Signals, rate: float, form: str, values: Values, memory: Memory) -> Signals:
    noisy = {}
    for name, signal in signals.items():
        level = values["amount"] * channel_level(name, values)
        noisy[name] = signal + level * _next_noise(signal.size, rate, form, name, memory)
    return noisy


def _next_noise(n: int, rate: float, form: str, name: str, memory: Memory) -> NDArray[np.float64]:
    """Return what follows of a channel's noise.

    Stretches that know nothing of each other overlap by half; the squares of their weights add up
    to one, so that the level is the same everywhere. A run in one block is one stretch.
    """
    if "whole" in memory:
        return _noise(n, rate, _EXPONENTS[form], memory["rng"])
    half = next_fast_len(round(0.5 * _STRETCH * rate), real=True)
    angle = 0.5 * np.pi * (np.arange(half) + 0.5) / half
    key = f"{name} {form}"
    fading, ready = memory.get(key, (None, np.empty(0)))
    while ready.size < n:
        made = _noise(2 * half, rate, _EXPONENTS[form], memory["rng"])
        if fading is not None:
            ready = np.append(ready, fading * np.cos(angle) + made[:half] * np.sin(angle))
        fading = made[half:]
    memory[key] = fading, ready[n:]
    return np.asarray(ready[:n])


def _noise(n: int, rate: float, exponent: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Noise with the expected rms 1 in the band of levels."""
    length = next_fast_len(n, real=True)
    frequency = rfftfreq(length, 1.0 / rate)
    gain = np.maximum(frequency, _LOWEST) ** (-0.5 * exponent)
    # Mean square of white noise: each line but the first and the last stands for two, and for what
    # is nearer to it than to the next, of which part may be out of the band.
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
        "pressure_level": Parameter(50.0, "dB re 20 uPa", -40.0, 130.0, "20 Hz to 20 kHz"),
        "acceleration": Parameter(0.2, "m/s2", 0.0, 1e3, "rms, 20 Hz to 20 kHz"),
        "torque": Parameter(0.05, "Nm", 0.0, 100.0, "rms, 20 Hz to 20 kHz"),
        "angle": Parameter(1e-3, "rad", 0.0, 1.0, "rms, 20 Hz to 20 kHz"),
    },
    strength="amount",
    sensors=_sensors,
    in_blocks=True,
)
