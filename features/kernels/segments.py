# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Spectra of overlapping Hann-windowed segments, which averages and changes in time are made of.

Averages take segments that are spread evenly, so that the last one ends with the last sample: a
block of 0.25 s has no samples to throw away. The diagnosis takes segments that overlap by exactly
half and keeps their phases, for it compares two channels.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import fft

from models.compilation import COMPILED

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["hann", "segment_count", "segment_powers", "segment_spectra", "windowed_transforms"]

_OVERLAP_SLACK = 0.02
"""Segments that a signal may lack for an overlap of half: no further one for a few samples."""


def segment_powers(
    x: NDArray[np.float64], length: int, *, transform_length: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Squared magnitudes of the transforms of segments that are spread over a signal.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        In any [unit].
    length : int
        Samples of a segment, at most `n_samples`.
    transform_length : int, optional
        Zeros fill each segment up to it.

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
    n_segments = segment_count(x.size, length)
    starts = np.rint(np.linspace(0, x.size - length, n_segments)).astype(np.intp)
    segments = np.lib.stride_tricks.sliding_window_view(x, length)[starts]
    window = hann(length)
    bins = windowed_transforms(segments, window, transform_length or length)
    power = bins.real**2
    power += bins.imag**2
    return power, window


def segment_count(n_samples: int, length: int) -> int:
    """Segments that are spread over a signal, overlapping by half or slightly more.

    Parameters
    ----------
    n_samples : int
        Of the signal.
    length : int
        Samples of a segment.

    Returns
    -------
    int

    Examples
    --------
    >>> segment_count(1000, 256)
    7
    """
    return 1 + math.ceil((n_samples - length) / (length / 2) - _OVERLAP_SLACK)


def segment_spectra(x: NDArray[np.float64], length: int) -> NDArray[np.complex128]:
    """Complex spectra of segments that overlap by half; samples that fill no segment are left out.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        In any [unit].
    length : int
        Samples of a segment, an even number and at most `n_samples`.

    Returns
    -------
    ndarray of complex, shape (n_segments, length // 2 + 1)
        Each about its own mean [unit]; their mean square is the signal's, summed over both sides.

    Notes
    -----
    Where the segments begin, and the last bits of the window, are not those of `segment_powers`:
    the shipped model of the diagnosis has learned from these.

    Examples
    --------
    >>> segment_spectra(np.ones(1024), 256).shape
    (7, 129)
    """
    step = length // 2
    windowed = np.empty(((x.size - length) // step + 1, length))
    _cut(x, step, _unit_hann(length), windowed)
    return np.asarray(fft.rfft(windowed, axis=1, overwrite_x=True))


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _cut(x, step, window, segments) -> None:
    """Cut a signal into segments, each about its mean and windowed; one array instead of four."""
    length = window.size
    for i in range(segments.shape[0]):
        first, total = i * step, 0.0
        for k in range(length):
            total += x[first + k]
        mean = total / length
        for k in range(length):
            segments[i, k] = (x[first + k] - mean) * window[k]


def windowed_transforms(
    segments: NDArray[np.float64], window: NDArray[np.float64], length: int
) -> NDArray[np.complex128]:
    """Transform the rows, each about its mean, windowed and filled up to `length`.

    Parameters
    ----------
    segments : ndarray, shape (n_segments, n)
        In any [unit].
    window : ndarray, shape (n,)
        [-]
    length : int
        Samples transformed.

    Returns
    -------
    ndarray of complex, shape (n_segments, length // 2 + 1)
        [unit]
    """
    windowed = segments - segments.mean(axis=1, keepdims=True)
    windowed *= window
    return np.asarray(fft.rfft(windowed, length, axis=1))


@lru_cache(maxsize=8)
def _unit_hann(length: int) -> NDArray[np.float64]:
    """Hann window of unit energy."""
    window = 0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, length + 1)[:-1])
    window /= math.sqrt(float((window**2).sum()))
    window.setflags(write=False)
    return np.asarray(window)


@lru_cache(maxsize=16)
def hann(length: int) -> NDArray[np.float64]:
    """Hann window; the same few lengths come again and again.

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
