"""Bands in which the diagnosis compares channels, and how loud a signal is in each."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from features.kernels.spectra import segment_spectra

BAND_EDGES = np.array([
    30.0, 60.0, 120.0, 180.0, 260.0, 350.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 2800.0, 4000.0,
    5600.0, 8000.0, 10000.0,
])  # fmt: skip
"""[Hz]; band 1 lies between the first two."""

USABLE = 0.42
"""Share of the sampling rate up to which a band counts [-], below what filters fade; assumed."""


def band_levels(x: NDArray[np.float64], rate: float) -> dict[str, float]:
    """Summarise how loud a signal is in each band.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of amplitudes in the channel's unit.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(30_000) / 30e3)
    >>> levels = band_levels(tone, 30e3)
    >>> max(levels, key=levels.get)  # from 350 to 500 Hz
    'band_6'
    """
    spectra, bands = segment_spectra(x, segment_frequency(rate)[0]), band_bins(rate)
    sums = band_sums(powers(spectra).mean(axis=0), bands.first, bands.last)
    power = sums / (bands.last - bands.first)
    return {
        f"band_{i}": level
        for i, level in zip(bands.numbers, (0.5 * np.log(power + 1e-14)).tolist(), strict=True)
    }


@lru_cache(maxsize=8)
def segment_frequency(rate: float) -> tuple[int, NDArray[np.float64]]:
    """Length of the segments in which bands are resolved, and the frequency of their bins.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    length : int
        Samples of a segment.
    frequency : ndarray, shape (length // 2 + 1,)
        [Hz]

    Examples
    --------
    >>> segment_frequency(30e3)[0], segment_frequency(48e3)[0]
    (2048, 4096)
    """
    length = 2048 if rate < 40e3 else 4096
    return length, np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)


def powers(spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Power of each line of spectra.

    Parameters
    ----------
    spectra : ndarray of complex, shape (...)
        [any unit]

    Returns
    -------
    ndarray, shape (...)
        [unit^2]

    Examples
    --------
    >>> powers(np.array([3.0 + 4.0j]))
    array([25.])
    """
    return np.asarray(spectra.real**2 + spectra.imag**2)


def band_sums(
    values: NDArray[np.float64], first: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Sum the last axis over bands.

    Parameters
    ----------
    values : ndarray, shape (..., n_bins)
        [any unit]
    first, last : ndarray of int, shape (n_bands,)
        First bin of each band, and first after it.

    Returns
    -------
    ndarray, shape (..., n_bands)
        [unit of the values]

    Examples
    --------
    >>> band_sums(np.arange(5.0), np.array([0, 2]), np.array([2, 5]))
    array([1., 9.])
    """
    return np.stack(
        [values[..., a:b].sum(axis=-1) for a, b in zip(first, last, strict=True)], axis=-1
    )


class Bands(NamedTuple):
    """Bands that a rate reaches.

    Parameters
    ----------
    numbers : tuple of int
        From 1.
    first, last : ndarray of int, shape (n_bands,)
        First bin of `segment_frequency` that lies in each, and first after it.
    """

    numbers: tuple[int, ...]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


@lru_cache(maxsize=8)
def band_bins(rate: float) -> Bands:
    """Find which bins lie in each of the bands that a rate reaches.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    Bands

    Examples
    --------
    >>> band_bins(10e3).numbers[-1]
    12
    """
    edges = np.searchsorted(segment_frequency(rate)[1], BAND_EDGES)
    reached = (BAND_EDGES[1:] < USABLE * rate) & (np.diff(edges) > 0)
    numbers = tuple((np.flatnonzero(reached) + 1).tolist())
    return Bands(numbers, edges[:-1][reached], edges[1:][reached])


def bins_between(frequency: NDArray[np.float64], band: tuple[float, float]) -> slice:
    """Find the bins between two frequencies.

    Parameters
    ----------
    frequency : ndarray, shape (n_bins,)
        Rising [Hz].
    band : tuple of float
        The two, which are not in it [Hz].

    Returns
    -------
    slice

    Examples
    --------
    >>> bins_between(np.array([0.0, 10.0, 20.0, 30.0]), (5.0, 30.0))
    slice(1, 3, None)
    """
    first = int(np.searchsorted(frequency, band[0], "right"))
    return slice(first, max(first, int(np.searchsorted(frequency, band[1]))))
