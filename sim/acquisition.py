# mypy: allow-untyped-decorators
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
from numba import njit
from numpy.typing import NDArray
from scipy.signal import butter, firwin, sosfilt, sosfilt_zi, upfirdn

from models.compilation import COMPILED
from models.sensors import Sensor, Sensors
from models.show import short_repr

CONVERTER_GAIN = {
    "torque": 82.0,
    "acceleration": 781.4,
    "pressure": 23.088,
    "angle": 9.9,
}
"""Gain of each transducer in units per volt (Appendices B to E)."""

_CONVERTER_RANGE = 1.25
"""Largest voltage of the converter, either sign [V]."""

THESIS_CONVERTER = Sensors(
    {
        kind: Sensor(full_scale=_CONVERTER_RANGE * gain, bits=12)
        for kind, gain in CONVERTER_GAIN.items()
    }
)
"""Converter board of the thesis (3.1.2)."""

_FILTER_ORDER = 8
"""Order of the analogue anti-alias filter; assumed."""

_FILTER_HALF_LENGTH = 10
"""Half length of the linear-phase anti-alias filter, in output samples."""

_AT_ONCE = 512
"""Output values filtered together, so that their inputs stay in the processor's cache."""


@short_repr
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
    return decimate(AnalogueFilter(sensor.antialias, rate)(signal), factor)


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
def analogue_filter(
    corner: float | None, rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return the low-pass filter of a corner [Hz] at a rate [Hz], and its steady state.

    Returns
    -------
    tuple of (ndarray, shape (4, 6), ndarray, shape (4, 2)) or None
        Second-order sections [-], and their state at a constant value of one; None if the corner is
        too high to have an effect.

    Examples
    --------
    >>> analogue_filter(12e3, 90e3)[0].shape, analogue_filter(50e3, 90e3)
    ((4, 6), None)
    """
    if corner is None or corner >= 0.5 * rate:
        return None
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
    taps = anti_alias_filter(factor)
    before, n, n_out = taps.size // 2, signal.size, -(-signal.size // factor)
    slope = (signal[-1] - signal[0]) / max(n - 1, 1)
    extended = np.empty(factor * (n_out + -(-taps.size // factor)))
    after = extended.size - before - n
    extended[:before] = signal[0] + np.arange(-before, 0) * slope
    extended[before : before + n] = signal
    extended[before + n :] = signal[-1] + np.arange(1, after + 1) * slope
    decimated = np.empty(n_out)
    _filter_phases(np.ascontiguousarray(extended.reshape(-1, factor).T), taps, decimated)
    return decimated


@njit(cache=True, **COMPILED)
def _filter_phases(
    phases: NDArray[np.float64], taps: NDArray[np.float64], values: NDArray[np.float64]
) -> None:
    """Filter a signal whose samples are split by phase, one row per phase.

    The sum runs tap by tap over many values at once, in the order of `scipy.signal.resample_poly`
    and equal to it to the last bit.
    """
    for first in range(0, values.size, _AT_ONCE):
        chunk = values[first : first + _AT_ONCE]
        chunk[:] = 0.0
        for i in range(taps.size):
            start = first + i // phases.shape[0]
            source = phases[i % phases.shape[0], start : start + chunk.size]
            tap = taps[taps.size - 1 - i]
            for k in range(chunk.size):
                chunk[k] += tap * source[k]


@lru_cache(maxsize=8)
def anti_alias_filter(factor: int) -> NDArray[np.float64]:
    """Return the linear-phase low-pass filter of a decimation.

    Parameters
    ----------
    factor : int
        Above 1.

    Returns
    -------
    ndarray, shape (20 * factor + 1,)
        The default design of `scipy.signal.resample_poly`.

    Examples
    --------
    >>> anti_alias_filter(3).size, round(float(anti_alias_filter(3).sum()), 9)
    (61, 1.0)
    """
    size = 2 * _FILTER_HALF_LENGTH * factor + 1
    taps = np.asarray(firwin(size, 1.0 / factor, window=("kaiser", 5.0)), np.float64)
    taps.flags.writeable = False  # shared by all callers
    return taps


class AnalogueFilter:
    """Block-wise analogue anti-alias filter of a sensor.

    Parameters
    ----------
    corner : float, optional
        [Hz]; without a corner, signals pass unchanged.
    rate : float
        Rate of the signal [Hz].
    skip : int
        Samples at the start that pass unchanged; the filter starts settled at the one after.

    Examples
    --------
    >>> low = AnalogueFilter(1e3, 90e3, skip=2)
    >>> [low(np.array(block)).round(9).tolist() for block in ([3.0], [4.0, 5.0], [5.0])]
    [[3.0], [4.0, 5.0], [5.0]]
    """

    def __init__(self, corner: float | None, rate: float, skip: int = 0) -> None:
        self._filter, self._skip = analogue_filter(corner, rate), skip
        self._state: NDArray[np.float64] | None = None

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the next samples, as many as `block` has."""
        if self._filter is None:
            return block
        before, rest = block[: self._skip], block[self._skip :]
        self._skip -= before.size
        if not rest.size:
            return before
        sections, settled = self._filter
        state = settled * rest[0] if self._state is None else self._state
        passed, self._state = sosfilt(sections, rest, zi=state)
        return np.concatenate([before, passed])


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
        self._filter = anti_alias_filter(factor) if factor > 1 else np.ones(1)
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
