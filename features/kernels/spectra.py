# mypy: allow-untyped-decorators
"""Autospectra as power spectral densities, and their shape.

The estimator is Welch's average of Hann-windowed segments. The segments are spread evenly so that
the last one ends with the last sample; they overlap by half or slightly more, because a block of
0.25 s has no samples to lose. The result is a power spectral density, the only normalisation whose
level for noise does not depend on the resolution. The diagnosis uses complex spectra of segments
that overlap by exactly half, since it compares two channels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from features.kernels.conditioning import Transform, checked_signal
from models.errors import ParameterError
from models.show import short_repr

_OVERLAP_SLACK = 0.02
"""Fraction of a segment that may be left uncovered at an overlap of exactly half."""


def segment_powers(
    x: NDArray[np.float64], length: int, *, transform_length: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the squared spectra of segments that are spread over a signal.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        In any [unit].
    length : int
        Samples of a segment, at most `n_samples`.
    transform_length : int, optional
        Length to which each segment is zero-padded.

    Returns
    -------
    power : ndarray, shape (n_segments, n_bins)
        [unit^2]
    window : ndarray, shape (length,)
        [-]

    Examples
    --------
    >>> power, window = segment_powers(np.zeros(1000), 256)
    >>> power.shape
    (7, 129)
    """
    n_segments = 1 + math.ceil((x.size - length) / (length / 2) - _OVERLAP_SLACK)
    starts = np.rint(np.linspace(0, x.size - length, n_segments)).astype(np.intp)
    segments = np.lib.stride_tricks.sliding_window_view(x, length)[starts]
    window = hann(length)
    windowed = segments - segments.mean(axis=1, keepdims=True)
    windowed *= window
    bins = fft.rfft(windowed, transform_length or length, axis=1)
    power = bins.real**2
    power += bins.imag**2
    return power, window


def segment_spectra(x: NDArray[np.float64], length: int) -> NDArray[np.complex128]:
    """Return the complex spectra of segments that overlap by half.

    Samples after the last whole segment are left out.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        In any [unit].
    length : int
        Samples of a segment, an even number and at most `n_samples`.

    Returns
    -------
    ndarray of complex, shape (n_segments, length // 2 + 1)
        Spectra about each segment's mean [unit]; their mean square, summed over both sides, is that
        of the signal.

    Notes
    -----
    The starts of the segments and the last bits of the window differ from `segment_powers`, because
    the shipped model of the diagnosis was trained with these.

    Examples
    --------
    >>> segment_spectra(np.ones(1024), 256).shape
    (7, 129)
    """
    segments = np.lib.stride_tricks.sliding_window_view(x, length)[:: length // 2]
    windowed = segments - segments.mean(axis=1, keepdims=True)
    windowed *= _unit_hann(length)
    return np.asarray(fft.rfft(windowed, axis=1, overwrite_x=True))


@lru_cache(maxsize=8)
def _unit_hann(length: int) -> NDArray[np.float64]:
    """Return the Hann window of unit energy."""
    window = 0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, length + 1)[:-1])
    window /= math.sqrt(float((window**2).sum()))
    window.setflags(write=False)
    return np.asarray(window)


@lru_cache(maxsize=16)
def hann(length: int) -> NDArray[np.float64]:
    """Return the Hann window, cached by length.

    Parameters
    ----------
    length : int

    Returns
    -------
    ndarray, shape (length,)
        [-]

    Examples
    --------
    >>> hann(4).round(2).tolist()
    [0.0, 0.5, 1.0, 0.5]
    """
    window = np.sin(np.pi * np.arange(length) / length) ** 2
    window.setflags(write=False)
    return window


DEFAULT_RESOLUTION = 4.0
"""Default spacing of the bins [Hz]: segments of a quarter of a second."""

_ROLL_OFF = 0.85
_FLATNESS_FLOOR = 1e-12

_FADE_ENERGY = 0.375
"""Energy of the fades in a transform per sample: the mean of sin^4."""


@short_repr
@dataclass(frozen=True, eq=False)
class Spectrum:
    """One-sided autospectrum.

    Parameters
    ----------
    frequency : ndarray, shape (n_bins,)
        [Hz], evenly spaced from 0 to half the sampling rate.
    density : ndarray, shape (n_bins,)
        Power spectral density [unit^2/Hz]. Its sum times the spacing is the mean square of the
        signal about its mean.
    rate : float
        Sampling rate of the signal [Hz].
    n_segments : int
        Number of averaged segments.
    """

    frequency: NDArray[np.float64]
    density: NDArray[np.float64]
    rate: float
    n_segments: int

    @property
    def spacing(self) -> float:
        """Distance between bins [Hz]."""
        return float(self.frequency[1])

    @cached_property
    def cumulative(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Edges of the bins [Hz] and the mean square below each [unit^2], shape (n_bins + 1,)."""
        edges = np.append(self.frequency - 0.5 * self.spacing, 0.5 * self.rate)
        edges[0] = 0.0
        return edges, np.append(0.0, np.cumsum(self.density) * self.spacing)

    @property
    def degrees_of_freedom(self) -> float:
        """Degrees of freedom of a bin of Gaussian noise, segments overlapping by half [-].

        They are those of the bin's chi-square law; the powers of neighbouring Hann segments
        correlate by 1/36 (Welch 1967).
        """
        k = self.n_segments
        return 2.0 * k / (1.0 + (k - 1) / (18.0 * k))


@dataclass(frozen=True)
class SpectralShape:
    """Shape of a spectrum between two frequencies.

    Parameters
    ----------
    centroid : float
        Mean frequency, weighted by power [Hz].
    spread : float
        Standard deviation about it [Hz].
    flatness : float
        Geometric over arithmetic mean of the density [-]: near 1 for noise, 0 for a line.
    roll_off : float
        Frequency below which 85 % of the band's power lies [Hz].
    """

    centroid: float
    spread: float
    flatness: float
    roll_off: float


def autospectrum(
    signal: ArrayLike, rate: float, *, resolution: float = DEFAULT_RESOLUTION
) -> Spectrum:
    """Return the one-sided power spectral density by Welch's method.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Samples in any unit.
    rate : float
        Sampling rate [Hz].
    resolution : float
        Desired spacing of the bins [Hz]. A signal shorter than ``1 / resolution`` is one segment,
        with a larger spacing. Two sinusoids are resolved if they are 4 bins apart.

    Returns
    -------
    Spectrum
        Hann window, overlap of half a segment or slightly more, mean of each segment removed.

    Raises
    ------
    ParameterError
        The signal cannot be analysed, or the resolution is not positive.

    Notes
    -----
    P. D. Welch, The use of fast Fourier transform for the estimation of power spectra,
    IEEE Trans. Audio Electroacoust. AU-15 (1967) 70-73.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(48000) / 48e3
    >>> tone = autospectrum(2.0 * np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> round(float(tone.density.sum() * tone.spacing), 3)
    2.0
    """
    if not (math.isfinite(resolution) and resolution > 0):
        raise ParameterError(f"resolution is {resolution}; it is a positive number of hertz")
    return welch(checked_signal(signal, rate), rate, resolution)


def welch(x: NDArray[np.float64], rate: float, resolution: float) -> Spectrum:
    """Return the `autospectrum` of samples that are already checked.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        [unit]
    rate : float
        Sampling rate [Hz].
    resolution : float
        Desired spacing of the bins [Hz].

    Returns
    -------
    Spectrum

    Examples
    --------
    >>> import numpy as np
    >>> welch(np.ones(100), 100.0, 4.0).n_segments
    7
    """
    length = min(x.size, max(16, round(rate / resolution)))
    power, window = segment_powers(x, length)
    density = np.asarray(power.mean(axis=0)) / (rate * float(np.sum(window**2)))
    density[1 : -1 if length % 2 == 0 else None] *= 2.0
    frequency = np.arange(density.size, dtype=np.float64) * (rate / length)
    return Spectrum(frequency, density, rate, power.shape[0])


def whole_spectrum(transform: Transform) -> Spectrum:
    """Return the spectrum of a whole signal without averaging; fades count by their energy.

    Parameters
    ----------
    transform : Transform

    Returns
    -------
    Spectrum

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.conditioning import forward
    >>> tone = whole_spectrum(forward(np.sin(2 * np.pi * 1000 * np.arange(9600) / 48e3), 48e3))
    >>> tone.spacing, round(float(tone.density.sum() * tone.spacing), 3)
    (5.0, 0.5)
    """
    bins = transform.bins
    energy = transform.n_samples + 2.0 * _FADE_ENERGY * transform.lead
    power: NDArray[np.float64] = bins.real**2 + bins.imag**2
    density = power * (2.0 / (transform.rate * energy))
    density[0] *= 0.5
    if transform.length % 2 == 0:
        density[-1] *= 0.5
    spacing = transform.rate / transform.length
    frequency = np.arange(density.size, dtype=np.float64) * spacing
    return Spectrum(frequency, density, transform.rate, 1)


def spectral_shape(spectrum: Spectrum, *, low: float, high: float) -> SpectralShape:
    """Return centroid, spread, flatness and roll-off of a spectrum between two frequencies.

    Parameters
    ----------
    spectrum : Spectrum
    low, high : float
        Limits of the band [Hz].

    Returns
    -------
    SpectralShape
        All NaN for a band without power.

    Raises
    ------
    ParameterError
        No bin of the spectrum lies between the limits.

    Notes
    -----
    G. Peeters, A large set of audio features for sound description, CUIDADO report, IRCAM (2004).
    Flatness is that of the estimated density, which scatters for few segments: white noise in a
    single one gives 0.56.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(48000) / 48e3
    >>> tone = autospectrum(np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> round(spectral_shape(tone, low=150.0, high=7000.0).centroid)
    1000
    """
    inside = (spectrum.frequency >= low) & (spectrum.frequency <= high)
    f, p = spectrum.frequency[inside], spectrum.density[inside]
    if f.size == 0:
        raise ParameterError(
            f"no bin lies between {low:g} and {high:g} Hz; the spectrum has bins every "
            f"{spectrum.spacing:g} Hz up to {spectrum.frequency[-1]:g} Hz"
        )
    total = float(p.sum())
    if not total > 0.0:
        return SpectralShape(math.nan, math.nan, math.nan, math.nan)
    p = p / total
    centroid = float(p @ f)
    spread = math.sqrt(max(0.0, float(p @ (f - centroid) ** 2)))
    mean = 1.0 / p.size
    flatness = math.exp(float(np.log(p + _FLATNESS_FLOOR * mean).mean())) / mean
    cumulative = np.cumsum(p)
    roll_off = float(np.interp(_ROLL_OFF, cumulative, f))
    return SpectralShape(centroid, spread, flatness, roll_off)


def weighted_median(values: NDArray[np.float64], weight: NDArray[np.float64]) -> float:
    """Return the weighted median.

    Parameters
    ----------
    values, weight : ndarray, shape (n,)
        Values in any [unit], and weights, not negative [-].

    Returns
    -------
    float
        In the [unit] of the values.

    Examples
    --------
    >>> weighted_median(np.array([3.0, 1.0, 2.0]), np.array([5.0, 1.0, 1.0]))
    3.0
    """
    order = np.argsort(values)
    reached = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(reached, 0.5 * reached[-1])]])


def parabola_tops(
    values: NDArray[np.float64], peaks: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions and heights of local maxima between samples, by parabolas.

    Parameters
    ----------
    values : ndarray, shape (n,)
        [unit]
    peaks : ndarray of int, shape (n_peaks,)
        Samples of the maxima.

    Returns
    -------
    place, height : ndarray, shape (n_peaks,)
        [sample] and [unit]

    Examples
    --------
    >>> import numpy as np
    >>> parabola_tops(np.array([0.0, 2.0, 2.0, 0.0]), np.array([1]))
    (array([1.5]), array([2.25]))
    """
    left, middle, right = values[peaks - 1], values[peaks], values[peaks + 1]
    curvature = left - 2.0 * middle + right
    bent = curvature < 0.0
    safe = np.where(bent, curvature, -1.0)
    place = np.asarray(peaks + np.where(bent, 0.5 * (left - right) / safe, 0.0), np.float64)
    return place, middle - np.where(bent, (left - right) ** 2 / (8.0 * safe), 0.0)
