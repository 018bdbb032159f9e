"""Data acquisition: anti-alias filter, sampling, noise and converter.

A signal passes, as in a laboratory,

1. an analogue anti-alias filter: Butterworth, order 8 (assumed), 3 dB down at the corner that
   `models.sensors.Sensor` states. It is causal, made discrete by the bilinear transform at the rate
   of the computation with the corner preserved, and starts settled at its first sample. A corner at
   or above half that rate has no effect on the samples and is left out.
2. the sampling, with a steep linear-phase filter of its own. What the analogue filter passes above
   half the sampling rate is not folded back.
3. the noise.
4. the converter, which rounds to its steps and clips at its range.

Gains and range of the thesis's converter are those of Section 3.1.2 and Appendices B to E: 12 bits
over +-1.25 V, 82 Nm/V, 781.4 m/s2/V, 23.088 Pa/V, 9.9 rad/V. One bit is 0.05 Nm, 0.48 m/s2, 14 mPa
(53.9 dB re 20 uPa rms for a sine) and 6 mrad. It is an option, because it would hide a quiet sound.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, firwin, resample_poly, sosfilt, sosfilt_zi, upfirdn

from models.sensors import Sensor, Sensors

THESIS_CONVERTER = Sensors(
    {
        kind: Sensor(full_scale=1.25 * gain, bits=12)  # 12 bits over +-1.25 V
        for kind, gain in (
            ("torque", 82.0),
            ("acceleration", 781.4),
            ("pressure", 23.088),
            ("angle", 9.9),
        )
    }
)
"""Converter board of the thesis (3.1.2)."""

_FILTER_ORDER = 8
"""Order of the analogue anti-alias filter; assumed."""

_FILTER_HALF_LENGTH = 10
"""Half length of the linear-phase anti-alias filter, in output samples."""


@dataclass(frozen=True)
class Acquisition:
    """Sampling rate, noise and sensors of a recording.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    noise : mapping of str to float
        Standard deviation of the white noise on each kind of channel, in its unit. The defaults
        are a quiet room (32 dB re 20 uPa up to 15 kHz) and good amplifiers; assumed.
    sensors : Sensors
        Sensors of the channels; a noise that they state takes precedence over `noise`.

    Examples
    --------
    >>> Acquisition(rate=48e3).noise["torque"]
    0.005
    """

    rate: float = 30e3
    noise: Mapping[str, float] = field(
        default_factory=lambda: {
            "torque": 0.005,
            "acceleration": 0.02,
            "pressure": 0.8e-3,
            "angle": 1e-4,
        }
    )
    sensors: Sensors = field(default_factory=Sensors)

    def over(self, sensors: Sensors) -> Acquisition:
        """Return the acquisition with sensors that it does not state taken from a rig's."""
        return replace(self, sensors=self.sensors.over(sensors))


def sample(
    signals: Mapping[str, NDArray[np.float64]],
    decimation: int,
    acquisition: Acquisition,
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    """Sample and digitise signals as the rig's data acquisition does.

    Parameters
    ----------
    signals : mapping of str to ndarray, shape (n,)
        By kind of channel, at `decimation` times the sampling rate.
    decimation : int
        Ratio of the rates.
    acquisition : Acquisition
    rng : numpy.random.Generator
        Generator of the noise.

    Returns
    -------
    dict of str to ndarray, shape (ceil(n / decimation),)

    Examples
    --------
    >>> quiet = Acquisition(noise={})
    >>> samples = sample({"torque": np.full(80, 3.0)}, 4, quiet, np.random.default_rng(0))
    >>> samples["torque"].shape, samples["torque"].round(6).max()
    ((20,), np.float64(3.0))
    """
    fine = decimation * acquisition.rate
    return {
        kind: digitise(
            decimate_sensed(signal, decimation, fine, acquisition.sensors.of(kind)),
            kind, acquisition, rng,
        )
        for kind, signal in signals.items()
    }  # fmt: skip


def decimate_sensed(
    signal: NDArray[np.float64], factor: int, rate: float, sensor: Sensor
) -> NDArray[np.float64]:
    """Apply a sensor's anti-alias filter to a signal, and decimate it.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    factor : int
        Ratio of the rates.
    rate : float
        Rate of `signal` [Hz].
    sensor : Sensor

    Returns
    -------
    ndarray, shape (ceil(n / factor),)
        In the unit of the signal [unit].

    Examples
    --------
    >>> decimate_sensed(np.full(9, 2.0), 3, 9e3, Sensor(antialias=1e3)).round(9)
    array([2., 2., 2.])
    """
    if sensor.antialias is not None and sensor.antialias < 0.5 * rate:
        sections, settled = _analogue_filter(sensor.antialias, rate)
        signal, _ = sosfilt(sections, signal, zi=settled * signal[0])
    return decimate(signal, factor)


def digitise(
    values: NDArray[np.float64], kind: str, acquisition: Acquisition, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add the noise of a channel, and apply its converter.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples at the sampling rate [unit of the channel].
    kind : str
        Kind of channel.
    acquisition : Acquisition
    rng : numpy.random.Generator
        Generator of the noise.

    Returns
    -------
    ndarray, shape (n,)
        [unit of the channel]

    Examples
    --------
    >>> coarse = Acquisition(noise={}, sensors=Sensors({"torque": Sensor(full_scale=8.0, bits=4)}))
    >>> digitise(np.array([2.4, 2.6, 9.0]), "torque", coarse, np.random.default_rng(0))
    array([2., 3., 7.])
    """
    sensor = acquisition.sensors.of(kind)
    level = acquisition.noise.get(kind, 0.0) if sensor.noise is None else sensor.noise
    values = values + level * rng.standard_normal(values.size)
    if sensor.full_scale is None:
        return values
    if sensor.bits is None:
        return np.clip(values, -sensor.full_scale, sensor.full_scale)
    most = 2 ** (sensor.bits - 1)  # a two's complement has one step more below zero than above
    return np.asarray(np.clip(np.round(values / sensor.step), -most, most - 1) * sensor.step)


@lru_cache(maxsize=16)
def _analogue_filter(corner: float, rate: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sections of the low-pass filter of a corner, and their state at a value of one."""
    sections = np.asarray(butter(_FILTER_ORDER, corner, fs=rate, output="sos"), np.float64)
    return sections, np.asarray(sosfilt_zi(sections), np.float64)


def decimate(signal: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Decimate a signal after a linear-phase anti-alias filter.

    Beyond its ends the signal is extended by a straight line.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    factor : int
        Ratio of the rates; 1 leaves the signal unchanged.

    Returns
    -------
    ndarray, shape (ceil(n / factor),)
        In the unit of the signal [unit].

    Examples
    --------
    >>> decimate(np.linspace(0.0, 9.0, 10), 3).round(9)
    array([0., 3., 6., 9.])
    """
    if factor == 1 or signal.size == 1:
        return signal
    taps = _anti_alias_filter(factor)
    return np.asarray(resample_poly(signal, 1, factor, window=taps, padtype="line"))


@lru_cache(maxsize=8)
def _anti_alias_filter(factor: int) -> NDArray[np.float64]:
    """Return the default filter of `resample_poly`, shape (20 factor + 1,)."""
    size = 2 * _FILTER_HALF_LENGTH * factor + 1
    taps = np.asarray(firwin(size, 1.0 / factor, window=("kaiser", 5.0)), np.float64)
    taps.flags.writeable = False  # shared by all callers
    return taps


class Decimation:
    """Block-wise decimation after a linear-phase anti-alias filter.

    The output lags behind the input by half the filter's length. Before its first sample the signal
    is extended by the straight line through its first two.

    Parameters
    ----------
    factor : int
        Ratio of the rates.
    skip : int
        Samples at the start that only serve the filter.

    Examples
    --------
    >>> third = Decimation(3)
    >>> [third(np.full(60, 2.0)).size for _ in range(3)]
    [10, 20, 20]
    """

    def __init__(self, factor: int, skip: int = 0) -> None:
        self._factor, self._skip = factor, skip
        self._filter = _anti_alias_filter(factor) if factor > 1 else np.ones(1)
        self._half = self._filter.size // 2
        self._pending: NDArray[np.float64] | None = None

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the output samples that the input so far determines."""
        if self._pending is None:
            before = np.arange(-self._half, 0)
            self._pending = block[0] + before * (block[1:2] - block[:1])
        pending = np.concatenate([self._pending, block])
        dropped = min(self._skip, pending.size)
        pending, self._skip = pending[dropped:], self._skip - dropped
        count = (pending.size - 2 * self._half - 1) // self._factor + 1
        if count <= 0 or self._skip > 0:
            self._pending = pending
            return np.empty(0)
        used = pending[: (count - 1) * self._factor + 2 * self._half + 1]
        filtered = upfirdn(self._filter, used, 1, self._factor)
        first = 2 * self._half // self._factor
        self._pending = pending[count * self._factor :]
        return np.asarray(filtered[first : first + count])
