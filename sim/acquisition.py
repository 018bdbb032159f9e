"""The rig's data acquisition: anti-alias filter, sampling, noise, and a converter of 12 bits.

Gains and range are those of Section 3.1.2 and Appendices B to E: 12 bits over +-1.25 V, 82 Nm/V,
781.4 m/s2/V, 23.088 Pa/V, 9.9 rad/V. One bit is then 0.05 Nm, 0.48 m/s2, 14 mPa (53.9 dB re
20 uPa rms were it a sine) and 6 mrad, so the converter is an option: it would hide a quiet sound.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import firwin, resample_poly

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["CONVERTER_GAIN", "Acquisition", "anti_alias_filter", "decimate", "sample"]

CONVERTER_GAIN = {
    "torque": 82.0,
    "acceleration": 781.4,
    "pressure": 23.088,
    "angle": 9.9,
}
"""Units per volt of each transducer (Appendices B to E)."""

_CONVERTER_RANGE = 1.25
"""Largest voltage of the converter, either sign [V]."""

_CONVERTER_STEPS = 2**12

_FILTER_HALF_LENGTH = 10
"""Of the anti-alias filter, in samples kept."""


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
    converter : bool
        Whether the samples pass the 12-bit converter (and clip at its range).

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
    converter: bool = False


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
    sampled = {}
    for kind, signal in signals.items():
        values = decimate(signal, decimation)
        level = acquisition.noise.get(kind, 0.0)
        values = values + level * rng.standard_normal(values.size)
        if acquisition.converter:
            values = _convert(values, CONVERTER_GAIN[kind])
        sampled[kind] = values
    return sampled


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
    if factor == 1:
        return signal
    taps = anti_alias_filter(factor)
    return np.asarray(resample_poly(signal, 1, factor, padtype="line", window=taps))


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


def _convert(values: NDArray[np.float64], gain: float) -> NDArray[np.float64]:
    bit = 2.0 * _CONVERTER_RANGE / _CONVERTER_STEPS * gain
    counts = np.clip(np.round(values / bit), -_CONVERTER_STEPS // 2, _CONVERTER_STEPS // 2 - 1)
    return np.asarray(counts * bit)
