"""Levels in bands: one-third octaves, the bands of the thesis, overall and A-weighted.

Bands are integrals of the autospectrum over exact edges, a bin counting by the part of it that
lies inside. That needs no filter bank, costs nothing once the spectrum is there, and is exact for
stationary sound; a transient's band level is its mean over the block. A band that a sampling rate
does not reach is NaN, never zero: "not measured" is not "silent".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.spectra import welch
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from features.kernels.spectra import Spectrum

__all__ = [
    "LEAST_SHARE_DB",
    "NOMINAL_THIRD_OCTAVES",
    "REFERENCES",
    "THESIS_BANDS",
    "THIRD_OCTAVE_RESOLUTION",
    "a_weighting",
    "band_levels",
    "band_power",
    "overall_level",
    "relative_db",
    "resolved_third_octaves",
    "third_octave_edges",
    "third_octave_levels",
]

REFERENCES = {"pressure": REFERENCE_PRESSURE, "acceleration": 1e-6, "force": 1e-6}
"""Reference values of levels by kind of channel [Pa, m/s2, N] (ISO 1683)."""

NOMINAL_THIRD_OCTAVES = (
    *("25", "31.5", "40", "50", "63", "80", "100", "125", "160", "200", "250", "315", "400"),
    *("500", "630", "800", "1000", "1250", "1600", "2000", "2500", "3150", "4000", "5000"),
    *("6300", "8000", "10000", "12500", "16000", "20000"),
)
"""Nominal mid-band frequencies [Hz] of the bands from 25 Hz to 20 kHz (IEC 61260-1)."""

THESIS_BANDS = ((0.0, 2e3), (2e3, 5e3), (5e3, 15e3))
"""Bands [Hz] in which the thesis tells torque from structure from creak (5.2.3)."""

LEAST_SHARE_DB = -80.0
"""Lowest relative level that is told from nothing [dB]."""

_ANTI_ALIAS = 0.9
"""Share of the Nyquist frequency that a recorder's anti-aliasing filter leaves alone."""

_LEAST_BINS = 4
"""Bins that a band must hold for its level to be its own."""

THIRD_OCTAVE_RESOLUTION = 1.4
"""Spacing of the bins [Hz] for one-third octaves: the band at 25 Hz is 5.8 Hz wide."""

_A_POLES = (20.598997, 107.65265, 737.86223, 12194.217)


def third_octave_edges() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Exact edges of the one-third-octave bands.

    Returns
    -------
    low, middle, high : ndarray, shape (30,)
        Lower edges, mid-band frequencies and upper edges [Hz].

    Notes
    -----
    IEC 61260-1:2014, Clause 5, base ten: neighbouring bands lie a factor of 10^0.1 apart
    about 1 kHz, edges half of it on a logarithmic scale from the middle.

    Examples
    --------
    >>> low, middle, high = third_octave_edges()
    >>> [round(float(edge[16]), 1) for edge in (low, middle, high)]
    [891.3, 1000.0, 1122.0]
    """
    x = np.arange(len(NOMINAL_THIRD_OCTAVES)) - NOMINAL_THIRD_OCTAVES.index("1000")
    middle = 1000.0 * 10.0 ** (x / 10.0)
    half = 10.0**0.05
    return middle / half, middle, middle * half


def band_power(spectrum: Spectrum, low: ArrayLike, high: ArrayLike) -> NDArray[np.float64]:
    """Mean square between pairs of frequencies.

    Parameters
    ----------
    spectrum : Spectrum
    low, high : array_like, shape (n_bands,)
        Edges [Hz].

    Returns
    -------
    ndarray, shape (n_bands,)
        [unit^2]; NaN where `high` lies above half the sampling rate.

    Raises
    ------
    ParameterError
        An upper edge below its lower one.

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
    """Levels of mean squares.

    Parameters
    ----------
    power : array_like
        [unit^2]
    reference : float
        [unit]

    Returns
    -------
    ndarray
        Of the same shape [dB]; minus infinity for none.

    Examples
    --------
    >>> band_levels([1.0, 0.0], 2e-5).round(2).tolist()
    [93.98, -inf]
    """
    with np.errstate(divide="ignore"):
        return np.asarray(10.0 * np.log10(np.asarray(power) / reference**2))


def third_octave_levels(spectrum: Spectrum, *, reference: float) -> dict[str, float]:
    """Levels in one-third-octave bands from 25 Hz to 20 kHz.

    Parameters
    ----------
    spectrum : Spectrum
        Its bins should lie closer than a quarter of the lowest band of interest (25 Hz: 5.8 Hz
        wide); otherwise that band shares its power with its neighbours.
    reference : float
        [unit], for instance `REFERENCES` of the channel's kind.

    Returns
    -------
    dict of str to float
        [dB] by nominal mid-band frequency. NaN where the band's upper edge lies above 0.9 times
        half the sampling rate, where a recorder's anti-aliasing filter has set in.

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
    low, _, high = third_octave_edges()
    power = band_power(spectrum, low, high)
    power[high > _ANTI_ALIAS * 0.5 * spectrum.rate] = np.nan
    levels = band_levels(power, reference)
    return dict(zip(NOMINAL_THIRD_OCTAVES, levels.tolist(), strict=True))


def fine_third_octaves(
    x: NDArray[np.float64], rate: float, *, reference: float
) -> dict[str, float]:
    """`third_octave_levels` of a signal, from as fine a spectrum as the lowest band needs.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Checked already.
    rate : float
        Sampling rate [Hz].
    reference : float
        [unit]

    Returns
    -------
    dict of str to float
        [dB] by nominal mid-band frequency; NaN also where the signal is too short for four bins in
        a band: half a second is below 40 Hz.

    Examples
    --------
    >>> hum = np.sin(2 * np.pi * 50 * np.arange(24000) / 48e3)
    >>> levels = fine_third_octaves(hum, 48e3, reference=1.0)
    >>> round(levels["50"], 1), levels["25"]
    (-3.0, nan)
    """
    return resolved_third_octaves(welch(x, rate, THIRD_OCTAVE_RESOLUTION), reference=reference)


def resolved_third_octaves(spectrum: Spectrum, *, reference: float) -> dict[str, float]:
    """`third_octave_levels` of a spectrum, of the bands that hold four of its bins.

    Parameters
    ----------
    spectrum : Spectrum
    reference : float
        [unit]

    Returns
    -------
    dict of str to float
        [dB] by nominal mid-band frequency; NaN for the others.

    Examples
    --------
    >>> hum = np.sin(2 * np.pi * 50 * np.arange(24000) / 48e3)
    >>> resolved_third_octaves(welch(hum, 48e3, 8.0), reference=1.0)["50"]
    nan
    """
    levels = third_octave_levels(spectrum, reference=reference)
    low, _, high = third_octave_edges()
    fine = high - low >= _LEAST_BINS * spectrum.spacing
    return {
        band: levels[band] if resolved else float("nan")
        for band, resolved in zip(NOMINAL_THIRD_OCTAVES, fine, strict=True)
    }


def a_weighting(frequency: ArrayLike) -> NDArray[np.float64]:
    """Gain of the A-weighting.

    Parameters
    ----------
    frequency : array_like
        [Hz]

    Returns
    -------
    ndarray
        Of the same shape [dB]; minus infinity at 0 Hz.

    Notes
    -----
    IEC 61672-1:2013, Annex E: the analytic expression with its four poles, normalised to 0 dB at
    1 kHz.

    Examples
    --------
    >>> a_weighting([100.0, 1000.0, 10000.0]).round(1).tolist()
    [-19.1, 0.0, -2.5]
    """
    with np.errstate(divide="ignore"):
        gain = 20.0 * np.log10(_a_response(np.asarray(frequency, dtype=np.float64)))
    reference = 20.0 * np.log10(_a_response(np.array(1000.0)))
    return np.asarray(gain - reference)


def overall_level(spectrum: Spectrum, *, reference: float, weighting: str = "Z") -> float:
    """Level of the whole spectrum.

    Parameters
    ----------
    spectrum : Spectrum
    reference : float
        [unit]
    weighting : {"Z", "A"}
        None, or A.

    Returns
    -------
    float
        [dB]

    Raises
    ------
    ParameterError
        Another weighting.

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> t = np.arange(48000) / 48e3
    >>> pascal = autospectrum(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> round(overall_level(pascal, reference=2e-5, weighting="A"), 2)
    93.98
    """
    if weighting not in ("Z", "A"):
        raise ParameterError(f"weighting is {weighting!r}; use 'Z' (none) or 'A'")
    density = spectrum.density
    if weighting == "A":
        density = density * 10.0 ** (0.1 * a_weighting(spectrum.frequency))
    return float(band_levels(density.sum() * spectrum.spacing, reference))


def _a_response(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    f2 = frequency**2
    p1, p2, p3, p4 = (pole**2 for pole in _A_POLES)
    return np.asarray((p4 * f2**2) / ((f2 + p1) * np.sqrt((f2 + p2) * (f2 + p3)) * (f2 + p4)))


def relative_db(part: float, whole: float) -> float:
    """Level of a part relative to a whole, at least -80 dB.

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
