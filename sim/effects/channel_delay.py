"""Delay of channels that do not share one clock.

A channel reads x(t - d(t)), with D the delay times the channel's share:

- constant: d = D, as between two front-ends, or after a filter of constant delay.
- drift: d = D t / T, from zero at the start of the recording to D at its end T: a sampling rate
  with the relative error D / T.
- jitter: d is an Ornstein-Uhlenbeck process of rms D about zero with the corner `bandwidth`, as for
  packets in a network (Gillespie 1996, Phys. Rev. E 54, 2084).

Values between samples come from splines of the fifth degree (Unser 1999, IEEE Signal Process. Mag.
16(6), 22), whose error at a sixth of the sampling rate is of the order of 1e-4; before the first
and after the last sample the signal is constant. Shares are signed. The delay adds to the travel
time through air (2.9 ms at 1 m), which is no fault. Delay zero leaves the signal unchanged.

>>> values = {"delay": 2e-3, "bandwidth": 30.0, "acceleration": 1.0, "pressure": -1.0,
...           "torque": 0.0, "angle": 0.0}
>>> step = np.where(np.arange(8) < 4, 0.0, 1.0)
>>> read = _sensors({"acceleration": step, "torque": step}, 1e3, "constant", values,
...                 np.random.default_rng(0))
>>> np.flatnonzero(read["acceleration"] > 0.5)[0], np.flatnonzero(read["torque"] > 0.5)[0]
(np.int64(6), np.int64(4))
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.signal import lfilter

from sim.chain import change_channels, channel_shares
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values

_DEGREE = 5


def _sensors(
    signals: Signals, rate: float, form: str, values: Values, rng: np.random.Generator
) -> Signals:
    def delayed(signal: NDArray[np.float64], delay: float) -> NDArray[np.float64]:
        course = _course(signal.size, form, values["bandwidth"] / rate, rng)
        return _late(signal, delay * rate * course)

    return change_channels(signals, values, "delay", delayed)


def _course(n: int, form: str, bandwidth: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the delay over time for a delay of one; `bandwidth` in cycles per sample."""
    if form == "drift":
        return np.linspace(0.0, 1.0, n)
    if form == "jitter":
        decay = math.exp(-2.0 * math.pi * bandwidth)
        increments = rng.standard_normal(n) * math.sqrt(1.0 - decay**2)
        increments[0] = rng.standard_normal()
        return np.asarray(lfilter([1.0], [1.0, -decay], increments))
    return np.ones(n)


def _late(signal: NDArray[np.float64], samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a signal delayed by a number of samples."""
    when = np.clip(np.arange(signal.size) - samples, 0.0, signal.size - 1.0)
    return np.asarray(map_coordinates(signal, [when], order=_DEGREE, mode="mirror"))


EFFECT = Effect(
    name="channel_delay",
    stage=Stage.MEASUREMENT,
    forms=("constant", "drift", "jitter"),
    parameters={
        "delay": Parameter(1e-4, "s", 0.0, 0.05, "delay: constant, at the end, or rms, by form"),
        "bandwidth": Parameter(30.0, "Hz", 0.1, 500.0, "3 dB corner of the jitter"),
        **channel_shares("delay", acceleration=1.0, pressure=1.0, torque=0.0, angle=0.0),
    },
    strength="delay",
    sensors=_sensors,
)
