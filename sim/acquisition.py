# mypy: allow-untyped-decorators
"""The rig's data acquisition: anti-alias filter, sampling, noise, and the converter.

A signal goes through it in the order of a laboratory's: a Butterworth low-pass filter of order 8,
as dedicated anti-alias filters have (assumed; 3 dB down at the corner that `models.sensors.Sensor`
states, causal, made discrete by the bilinear transform at the rate of the computation with the
corner kept; it starts settled at its first sample), the sampling with a steep linear-phase filter
of its own, the noise, and the converter, which rounds to its steps and clips at its range. A corner
at half the rate of the computation or above changes nothing that is sampled and is left out; what
an analogue filter lets through above half the sampling rate is not folded back.

Gains and range of the thesis's are those of Section 3.1.2 and Appendices B to E: 12 bits over
+-1.25 V, 82 Nm/V, 781.4 m/s2/V, 23.088 Pa/V, 9.9 rad/V. One bit is then 0.05 Nm, 0.48 m/s2, 14 mPa
(53.9 dB re 20 uPa rms were it a sine) and 6 mrad, so that converter is an option: it would hide a
quiet sound.
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
"""Units per volt of each transducer (Appendices B to E)."""

_CONVERTER_RANGE = 1.25
"""Largest voltage of the converter, either sign [V]."""

THESIS_CONVERTER = Sensors(
    {
        kind: Sensor(full_scale=_CONVERTER_RANGE * gain, bits=12)
        for kind, gain in CONVERTER_GAIN.items()
    }
)
"""The board that the thesis recorded with (3.1.2)."""

_FILTER_ORDER = 8
"""Of the analogue anti-alias filter; assumed."""

_FILTER_HALF_LENGTH = 10
"""Of the anti-alias filter, in samples kept."""

_AT_ONCE = 512
"""Values that are filtered together: what they are made of stays in the processor's cache."""


@short_repr
@dataclass(frozen=True)
class Acquisition:
    """How signals become samples.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    noise : mapping of str to float
        Standard deviation of the white noise on each kind of channel, in its unit. The defaults
        are a quiet room (32 dB re 20 uPa up to 15 kHz) and good amplifiers; assumed.
    sensors : Sensors
        What they are recorded through; a noise that these state is the one that counts.

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
        """Return it with what it does not say of its sensors taken from those of a rig."""
        return replace(self, sensors=self.sensors.over(sensors))


def sample(
    signals: Mapping[str, NDArray[np.float64]],
    decimation: int,
    acquisition: Acquisition,
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    """Sample signals as the rig's data acquisition does.

    Parameters
    ----------
    signals : mapping of str to ndarray, shape (n,)
        By kind of channel, at `decimation` times the sampling rate.
    decimation : int
        Every so many samples one is kept, after a linear-phase anti-alias filter.
    acquisition : Acquisition
    rng : numpy.random.Generator
        Of the noise.

    Returns
    -------
    dict of str to ndarray, shape (ceil(n / decimation),)

    Examples
    --------
    >>> quiet = Acquisition(noise={})
    >>> held = sample({"torque": np.full(80, 3.0)}, 4, quiet, np.random.default_rng(0))
    >>> held["torque"].shape, held["torque"].round(6).max()
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
    """Filter a signal as a sensor's anti-alias filter does, and decimate it.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    factor : int
        Of the rates.
    rate : float
        Of `signal` [Hz].
    sensor : Sensor

    Returns
    -------
    ndarray, shape (ceil(n / factor),)
        In the signal's own [unit].

    Examples
    --------
    >>> decimate_sensed(np.full(9, 2.0), 3, 9e3, Sensor(antialias=1e3)).round(9)
    array([2., 2., 2.])
    """
    return decimate(AnalogueFilter(sensor.antialias, rate)(signal), factor)


def digitise(
    values: NDArray[np.float64], kind: str, acquisition: Acquisition, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add the noise of a channel, and convert.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of a kind of channel, at the sampling rate [unit of the channel].
    kind : str
    acquisition : Acquisition
    rng : numpy.random.Generator
        Of the noise.

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
    """Low-pass filter of a corner [Hz] for signals at a rate [Hz], and its state in a steady one.

    Returns
    -------
    tuple of (ndarray, shape (4, 6), ndarray, shape (4, 2)) or None
        Second-order sections [-], and their state at a steady value of one; None where the corner
        is too high to change anything.

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
    """Keep every so many samples, after the anti-alias filter; beyond its ends a signal goes on.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    factor : int
        Of the rates; 1 leaves the signal as it is.

    Returns
    -------
    ndarray, shape (ceil(n / factor),)
        In the signal's own [unit].

    Examples
    --------
    >>> decimate(np.linspace(0.0, 9.0, 10), 3).round(9)
    array([0., 3., 6., 9.])
    """
    if factor == 1 or signal.size == 1:
        return signal
    taps = anti_alias_filter(factor)
    before, n, kept = taps.size // 2, signal.size, -(-signal.size // factor)
    slope = (signal[-1] - signal[0]) / max(n - 1, 1)
    going_on = np.empty(factor * (kept + -(-taps.size // factor)))
    after = going_on.size - before - n
    going_on[:before] = signal[0] + np.arange(-before, 0) * slope
    going_on[before : before + n] = signal
    going_on[before + n :] = signal[-1] + np.arange(1, after + 1) * slope
    decimated = np.empty(kept)
    _filter_phases(np.ascontiguousarray(going_on.reshape(-1, factor).T), taps, decimated)
    return decimated


@njit(cache=True, **COMPILED)
def _filter_phases(
    phases: NDArray[np.float64], taps: NDArray[np.float64], values: NDArray[np.float64]
) -> None:
    """Filter a signal that is given as every so many of its samples, one row a phase.

    Tap by tap over many values at once, in the order of `scipy.signal.resample_poly` and to its
    last bit.
    """
    for first in range(0, values.size, _AT_ONCE):
        kept = values[first : first + _AT_ONCE]
        kept[:] = 0.0
        for i in range(taps.size):
            start = first + i // phases.shape[0]
            source = phases[i % phases.shape[0], start : start + kept.size]
            tap = taps[taps.size - 1 - i]
            for k in range(kept.size):
                kept[k] += tap * source[k]


@lru_cache(maxsize=8)
def anti_alias_filter(factor: int) -> NDArray[np.float64]:
    """Linear-phase low-pass filter ahead of a decimation.

    Parameters
    ----------
    factor : int
        Above 1.

    Returns
    -------
    ndarray, shape (20 * factor + 1,)
        What `scipy.signal.resample_poly` designs by default.

    Examples
    --------
    >>> anti_alias_filter(3).size, round(float(anti_alias_filter(3).sum()), 9)
    (61, 1.0)
    """
    size = 2 * _FILTER_HALF_LENGTH * factor + 1
    taps = np.asarray(firwin(size, 1.0 / factor, window=("kaiser", 5.0)), np.float64)
    taps.flags.writeable = False  # shared by all that ask for it
    return taps


class AnalogueFilter:
    """The anti-alias filter of a sensor, as `sim.acquisition.decimate_sensed` has it.

    Parameters
    ----------
    corner : float, optional
        [Hz]; without one, signals pass as they are.
    rate : float
        Of the signal [Hz].
    skip : int
        Samples at the start that pass as they are: the filter starts settled at the one after.

    Examples
    --------
    >>> low = AnalogueFilter(1e3, 90e3, skip=2)
    >>> [low(np.array(block)).round(9).tolist() for block in ([3.0], [4.0, 5.0], [5.0])]
    [[3.0], [4.0, 5.0], [5.0]]
    """

    def __init__(self, corner: float | None, rate: float, skip: int = 0) -> None:
        self._found, self._skip = analogue_filter(corner, rate), skip
        self._state: NDArray[np.float64] | None = None

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the next samples, as many as `block` has."""
        if self._found is None:
            return block
        before, rest = block[: self._skip], block[self._skip :]
        self._skip -= before.size
        if not rest.size:
            return before
        sections, settled = self._found
        state = settled * rest[0] if self._state is None else self._state
        passed, self._state = sosfilt(sections, rest, zi=state)
        return np.concatenate([before, passed])


class Decimation:
    """Anti-alias filter and decimation as `sim.acquisition.sample` does them.

    What it returns lags behind what it is given by half the filter's length. Before its first
    sample the signal is taken to go on straight, by its first two.

    Parameters
    ----------
    factor : int
        Every so many samples one is kept.
    skip : int
        Samples at the start that only the filter is to see.

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
        self._held: NDArray[np.float64] | None = None

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return those of the next samples that are known by now."""
        if self._held is None:
            before = np.arange(-self._half, 0)
            self._held = block[0] + before * (block[1:2] - block[:1])
        held = np.concatenate([self._held, block])
        dropped = min(self._skip, held.size)
        held, self._skip = held[dropped:], self._skip - dropped
        count = (held.size - 2 * self._half - 1) // self._factor + 1
        if count <= 0 or self._skip > 0:
            self._held = held
            return np.empty(0)
        used = held[: (count - 1) * self._factor + 2 * self._half + 1]
        kept = upfirdn(self._filter, used, 1, self._factor)
        first = 2 * self._half // self._factor
        self._held = held[count * self._factor :]
        return np.asarray(kept[first : first + count])
