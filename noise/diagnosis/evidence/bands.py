"""Bands in which the diagnosis compares channels, and the bins of a channel's spectra in each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["BAND_EDGES", "USABLE", "band_bins", "segment_frequency"]

BAND_EDGES = np.array([
    30.0, 60.0, 120.0, 180.0, 260.0, 350.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 2800.0, 4000.0,
    5600.0, 8000.0, 10000.0,
])  # fmt: skip
"""[Hz]; band 1 lies between the first two."""

USABLE = 0.42
"""Share of the sampling rate up to which a band counts [-]."""


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


def band_bins(rate: float) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Yield the number of each band that a rate reaches, from 1, and which bins lie in it.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Yields
    ------
    number : int
    inside : ndarray of bool, shape (n_bins,)
        Of the bins of `segment_frequency`.

    Examples
    --------
    >>> [number for number, _ in band_bins(10e3)][-1]
    12
    """
    place = np.digitize(segment_frequency(rate)[1], BAND_EDGES)
    for number in range(1, BAND_EDGES.size):
        inside = place == number
        if BAND_EDGES[number] < USABLE * rate and inside.any():
            yield number, inside
