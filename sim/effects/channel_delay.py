"""Delay of channels that do not share one clock.

A channel reads x(t - d(t)), with D the delay times the channel's share:

- constant: d = D, as between two front-ends, or behind a filter of constant delay.
- drift: d = D t / T, from none at the start of the recording to D at its end T: a sampling rate
  that is wrong by the share D / T.
- jitter: d is an Ornstein-Uhlenbeck process of rms D about zero with the corner `bandwidth`, as of
  packets over a network (Gillespie 1996, Phys. Rev. E 54, 2084).

Values between samples come from splines of the fifth degree (Unser 1999, IEEE Signal Process. Mag.
16(6), 22), whose error at a sixth of the sampling rate is of the order of 1e-4; before the first
and after the last sample the nearest is held. Shares are signed. A microphone at 1 m is late by
2.9 ms through the air already, which is no fault: the delay here comes on top. At delay zero all
are the signal itself.

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
    """Delay over time, of size one; `bandwidth` in cycles a sample."""
    if form == "drift":
        return np.linspace(0.0, 1.0, n)
    if form == "jitter":
        decay = math.exp(-2.0 * math.pi * bandwidth)
        kicks = rng.standard_normal(n) * math.sqrt(1.0 - decay**2)
        kicks[0] = rng.standard_normal()
        return np.asarray(lfilter([1.0], [1.0, -decay], kicks))
    return np.ones(n)


def _late(signal: NDArray[np.float64], samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Read a signal so many samples late."""
    when = np.clip(np.arange(signal.size) - samples, 0.0, signal.size - 1.0)
    return np.asarray(map_coordinates(signal, [when], order=_DEGREE, mode="mirror"))


EFFECT = Effect(
    name="channel_delay",
    stage=Stage.MEASUREMENT,
    forms=("constant", "drift", "jitter"),
    parameters={
        "delay": Parameter(1e-4, "s", 0.0, 0.05, "constant, at the end, or rms; by the form"),
        "bandwidth": Parameter(30.0, "Hz", 0.1, 500.0, "3 dB corner of the jitter"),
        **channel_shares("delay", acceleration=1.0, pressure=1.0, torque=0.0, angle=0.0),
    },
    strength="delay",
    sensors=_sensors,
)
