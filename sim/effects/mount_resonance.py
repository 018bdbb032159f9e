"""Resonance of a sensor on a soft mount.

With G(s) = s**2 / (s**2 + 2 zeta omega s + omega**2), the reading is H(s) times the true signal:

- single: H = 1 - a G, one local mode of participation a. At a = 1 it is the transmissibility of a
  mass on spring and damper, (2 zeta omega s + omega**2) / (s**2 + 2 zeta omega s + omega**2).
- roll_off: H = 1 - a + a omega**2 / ((s**2 + 2 zeta omega s + omega**2) (1 + s / (2 omega))): a
  mass whose damping acts on its own motion only, on an adhesive that yields besides; nothing
  passes far above.
- double: H = 1 - a (2 G(omega) + G(2.3 omega)) / 3: the sensor also rocks.

All are 1 far below the resonance, and everywhere at amount a = 0. ISO 5348 covers the mounts of
accelerometers: a stud resonates near 30 kHz, wax and adhesives a little below, a magnet near 7
kHz, a hand-held tip at 2 kHz. The share of each kind of channel extends this to torque cells and
to microphones on flexible stands. Filters are bilinear transforms, exact at the resonance, in the
steady state of the first value at the start.

>>> values = {"amount": 1.0, "frequency": 5e3, "damping_ratio": 0.05, "acceleration": 1.0,
...           "pressure": 0.0, "torque": 0.0}
>>> tone = np.sin(2.0 * np.pi * 5e3 / 96e3 * np.arange(9600))
>>> read = _sensors({"acceleration": tone}, 96e3, "single", values, np.random.default_rng(0))
>>> round(float(2.0**0.5 * read["acceleration"][-960:].std()), 2)
10.05
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, lfilter, lfilter_zi

from sim.chain import change_channels, channel_shares
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values

_SECOND = 2.3
"""Frequency of the rocking over that of the first mode; assumed."""

_SOFT = 2.0
"""Corner of the adhesive over the frequency of the mode; assumed."""

_HIGHEST_SHARE = 0.45
"""Modes above this share of the sampling rate are left out."""


def _sensors(
    signals: Signals, rate: float, form: str, values: Values, _rng: np.random.Generator
) -> Signals:
    def read(signal: NDArray[np.float64], amount: float) -> NDArray[np.float64]:
        lost = _lost(signal, form, values["frequency"] / rate, values["damping_ratio"])
        return signal - amount * lost

    return change_channels(signals, values, "amount", read)


def _lost(
    signal: NDArray[np.float64], form: str, frequency: float, damping: float
) -> NDArray[np.float64]:
    """Return what a fully participating mount removes; `frequency` in cycles per sample."""
    if frequency > _HIGHEST_SHARE:
        return np.zeros_like(signal)
    if form == "double":
        first = _lost(signal, "single", frequency, damping)
        return (2.0 * first + _lost(signal, "single", _SECOND * frequency, damping)) / 3.0
    mode = [1.0, 2.0 * damping, 1.0]
    if form == "single":
        return _filtered(signal, [1.0, 0.0, 0.0], mode, frequency)
    yielding = [1.0 / _SOFT, 1.0]
    passed = _filtered(signal, [1.0], np.polymul(mode, yielding).tolist(), frequency)
    return np.asarray(signal - passed)


def _filtered(
    signal: NDArray[np.float64],
    numerator: list[float],
    denominator: list[float],
    frequency: float,
) -> NDArray[np.float64]:
    """Filter a signal by a quotient of polynomials in s / omega."""
    b, a = bilinear(numerator, denominator, fs=0.5 / math.tan(math.pi * frequency))
    filtered, _ = lfilter(b, a, signal, zi=lfilter_zi(b, a) * signal[0])
    return np.asarray(filtered)


EFFECT = Effect(
    name="mount_resonance",
    stage=Stage.MEASUREMENT,
    forms=("single", "roll_off", "double"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 1.0, "participation of the mount in the reading"),
        "frequency": Parameter(
            6e3, "Hz", 200.0, 30e3, "resonance frequency of the sensor on its mount"
        ),
        "damping_ratio": Parameter(0.03, "", 1e-3, 1.0, "damping ratio of the resonance"),
        **channel_shares("amount", low=0.0, acceleration=1.0, pressure=0.0, torque=0.0),
    },
    strength="amount",
    sensors=_sensors,
)
