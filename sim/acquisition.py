"""The rig's data acquisition: anti-alias filter, sampling, noise, and a converter of 12 bits.

Gains and range are those of Section 3.1.2 and Appendices B to E: 12 bits over +-1.25 V, 82 Nm/V,
781.4 m/s2/V, 23.088 Pa/V, 9.9 rad/V. One bit is then 0.05 Nm, 0.48 m/s2, 14 mPa (53.9 dB re
20 uPa rms were it a sine) and 6 mrad, so the converter is an option: it would hide a quiet sound.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import resample_poly

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["CONVERTER_GAIN", "Acquisition", "sample"]

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
        values = resample_poly(signal, 1, decimation, padtype="line") if decimation > 1 else signal
        level = acquisition.noise.get(kind, 0.0)
        values = values + level * rng.standard_normal(values.size)
        if acquisition.converter:
            values = _convert(values, CONVERTER_GAIN[kind])
        sampled[kind] = values
    return sampled


def _convert(values: NDArray[np.float64], gain: float) -> NDArray[np.float64]:
    bit = 2.0 * _CONVERTER_RANGE / _CONVERTER_STEPS * gain
    counts = np.clip(np.round(values / bit), -_CONVERTER_STEPS // 2, _CONVERTER_STEPS // 2 - 1)
    return np.asarray(counts * bit)
