"""Mains hum: the disturbance that cables pick up from the mains.

A periodic signal c h(2 pi f t + phi) is added to each channel, where f is the frequency of the
mains, c the channel's rms, and phi a random phase of the channel. All forms have the rms 1:

- sine: h = sqrt(2) sin, the electric field of a wire.
- harmonics: sum of sin(n .) / n over n = 1, 3, 5, 7, 9, the stray field of a transformer with a
  symmetrically saturating core; IEC 61000-3-2 limits the same harmonics of appliances.
- rectifier: a short half-cosine in each half-wave, less its mean: the ripple of a supply whose
  capacitors are charged only near the peaks (Schade 1943, Proc. IRE 31, 341); lines at 2 f, 4 f ...

The default frequency is Europe's; the thesis's laboratory in the United States has 60 Hz, railways
have 16.7 Hz, aircraft 400 Hz. Levels are assumed. Amount zero is no hum. An encoder counts lines
and picks up none, so the angle has none by default; a potentiometer like the thesis's, 10 rad/V
(Appendix B), reads 1e-3 rad for 0.1 mV.

>>> values = {"amount": 1.0, "frequency": 50.0, "pressure_level": 94.0, "acceleration": 0.1,
...           "torque": 0.05, "angle": 1e-3}
>>> hum = _sensors({"pressure": np.zeros(96_000)}, 96e3, "sine", values,
...                np.random.default_rng(0))
>>> round(float(hum["pressure"].std()), 2)
1.0
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.chain import channel_level
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values

_ODD = (1, 3, 5, 7, 9)

_CONDUCTION = 0.2
"""Share of each half-wave in which a rectifier conducts."""


def _sensors(
    signals: Signals, rate: float, form: str, values: Values, rng: np.random.Generator
) -> Signals:
    humming = {}
    for name, signal in signals.items():
        level = values["amount"] * channel_level(name, values)
        turns = values["frequency"] / rate * np.arange(signal.size, dtype=float) + rng.uniform()
        humming[name] = signal + level * _hum(form, turns)
    return humming


def _hum(form: str, turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return hum of rms 1 at a phase in periods of the mains."""
    if form == "rectifier":
        from_peak = (2.0 * turns) % 1.0 - 0.5
        pulse = np.where(
            np.abs(from_peak) < 0.5 * _CONDUCTION, np.cos(math.pi * from_peak / _CONDUCTION), 0.0
        )
        mean = 2.0 / math.pi * _CONDUCTION
        return np.asarray((pulse - mean) / math.sqrt(0.5 * _CONDUCTION - mean**2))
    orders = _ODD if form == "harmonics" else (1,)
    hum = np.zeros_like(turns)
    for n in orders:
        hum += np.sin(2.0 * math.pi * n * turns) / n
    return hum * math.sqrt(2.0 / sum(n**-2 for n in orders))


EFFECT = Effect(
    name="mains_hum",
    stage=Stage.MEASUREMENT,
    forms=("sine", "harmonics", "rectifier"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 100.0, "factor on the hum of all channels"),
        "frequency": Parameter(50.0, "Hz", 15.0, 450.0, "frequency of the mains"),
        "pressure_level": Parameter(60.0, "dB re 20 uPa", -40.0, 130.0, "level of the hum"),
        "acceleration": Parameter(0.5, "m/s2", 0.0, 1e3, "rms of the hum"),
        "torque": Parameter(0.1, "Nm", 0.0, 100.0, "rms of the hum"),
        "angle": Parameter(0.0, "rad", 0.0, 1.0, "rms of the hum; 0 for an encoder"),
    },
    strength="amount",
    sensors=_sensors,
)
