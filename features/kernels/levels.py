"""Levels in bands: one-third octaves and arbitrary bands of a spectrum.

Bands are integrals of the autospectrum over exact edges, a bin counting by the part of it that lies
inside: exact for stationary sound, and for a transient its mean over the block. A band that a
sampling rate does not reach, or that has fewer than four bins, is NaN: "not measured" is not
"silent".
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.spectra import Spectrum
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE

REFERENCES = {"pressure": REFERENCE_PRESSURE, "acceleration": 1e-6, "force": 1e-6}
"""Reference values of levels by kind of channel [Pa, m/s2, N] (ISO 1683)."""

NOMINAL_THIRD_OCTAVES = (
    *("25", "31.5", "40", "50", "63", "80", "100", "125", "160", "200", "250", "315", "400"),
    *("500", "630", "800", "1000", "1250", "1600", "2000", "2500", "3150", "4000", "5000"),
    *("6300", "8000", "10000", "12500", "16000", "20000"),
)
"""Nominal mid-band frequencies [Hz] of the bands from 25 Hz to 20 kHz (IEC 61260-1)."""

_FROM_1_KHZ = np.arange(len(NOMINAL_THIRD_OCTAVES)) - NOMINAL_THIRD_OCTAVES.index("1000")
"""Number of each band from that at 1 kHz; exact bands lie a factor of 10^0.1 apart (Clause 5)."""

THESIS_BANDS = ((0.0, 2e3), (2e3, 5e3), (5e3, 15e3))
"""Bands [Hz] of torque, structure and creak in the thesis (5.2.3)."""

LEAST_SHARE_DB = -80.0
"""Lowest relative level that differs from zero [dB]."""

_ANTI_ALIAS = 0.9
"""Share of the Nyquist frequency below a recorder's anti-aliasing filter."""

_LEAST_BINS = 4
"""Fewest bins of a band with a level of its own."""

THIRD_OCTAVE_RESOLUTION = 1.4
"""Spacing of the bins [Hz] for one-third octaves: the band at 25 Hz is 5.8 Hz wide."""


def band_power(spectrum: Spectrum, low: ArrayLike, high: ArrayLike) -> NDArray[np.float64]:
    """Return the mean square in bands of a spectrum.

    Parameters
    ----------
    spectrum : Spectrum
    low, high : array_like, shape (n_bands,)
        Edges [Hz].

    Returns
    -------
    ndarray, shape (n_bands,)
        [unit^2]; NaN where `high` is above half the sampling rate.

    Raises
    ------
    ParameterError
        An upper edge is below its lower one.

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> tone = autospectrum(np.sin(2 * np.pi * 100 * np.arange(1000) / 1e3), 1e3)
    >>> band_power(tone, [50, 200, 400], [200, 400, 800]).round(3).tolist()
    [0.5, 0.0, nan]
    """
    lower, upper = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    if np.any(upper < lower):
        raise ParameterError("bands: an upper edge lies below its lower one; give low, then high")
    edges, below = spectrum.cumulative
    power: NDArray[np.float64] = np.interp(upper, edges, below) - np.interp(lower, edges, below)
    return np.where(upper <= 0.5 * spectrum.rate * (1.0 + 1e-9), power, np.nan)


def band_levels(power: ArrayLike, reference: float) -> NDArray[np.float64]:
    """Return the levels of mean squares.

    Parameters
    ----------
    power : array_like
        [unit^2]
    reference : float
        [unit]

    Returns
    -------
    ndarray
        Of the same shape [dB]; minus infinity for zero.

    Examples
    --------
    >>> band_levels([1.0, 0.0], 2e-5).round(2).tolist()
    [93.98, -inf]
    """
    with np.errstate(divide="ignore"):
        return np.asarray(10.0 * np.log10(np.asarray(power) / reference**2))


def third_octave_levels(spectrum: Spectrum, *, reference: float) -> dict[str, float]:
    """Return the levels in one-third-octave bands from 25 Hz to 20 kHz.

    Parameters
    ----------
    spectrum : Spectrum
        `THIRD_OCTAVE_RESOLUTION` is fine enough for the lowest band.
    reference : float
        [unit], for instance `REFERENCES` of the channel's kind.

    Returns
    -------
    dict of str to float
        [dB] by nominal mid-band frequency. NaN if the band's upper edge is above 0.9 times half the
        sampling rate, where a recorder's anti-aliasing filter acts, or if it has fewer than four
        bins: half a second is too short below 40 Hz.

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> t = np.arange(48000) / 48e3
    >>> pascal = autospectrum(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> levels = third_octave_levels(pascal, reference=2e-5)
    >>> round(levels["1000"], 2), levels["20000"]
    (93.98, nan)
    """
    middle = 1000.0 * 10.0 ** (_FROM_1_KHZ / 10.0)
    low, high = middle / 10.0**0.05, middle * 10.0**0.05
    power = band_power(spectrum, low, high)
    power[high > _ANTI_ALIAS * 0.5 * spectrum.rate] = np.nan
    power[high - low < _LEAST_BINS * spectrum.spacing] = np.nan
    levels = band_levels(power, reference)
    return dict(zip(NOMINAL_THIRD_OCTAVES, levels.tolist(), strict=True))


def relative_db(part: float, whole: float) -> float:
    """Return the level of a part relative to a whole, at least -80 dB.

    Parameters
    ----------
    part, whole : float
        Mean squares [unit^2]; the latter is positive.

    Returns
    -------
    float
        [dB]

    Examples
    --------
    >>> relative_db(0.5, 5.0), relative_db(0.0, 1.0)
    (-10.0, -80.0)
    """
    return 10.0 * math.log10(max(part / whole, 10.0 ** (0.1 * LEAST_SHARE_DB)))
