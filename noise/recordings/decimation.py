"""Recordings sampled far above all that is heard, brought to a rate that can be worked with.

Windows, filters and transforms grow with the sampling rate, and at 10 MHz half a second is as much
as minutes of sound. Above 400 kHz every so many samples are therefore made one, through a filter
without delay. Any part of the result is the same, bit for bit, however it is read.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Read = Callable[[int, int], NDArray[np.float64]]


HIGHEST_WORKED = 400e3
"""Rates above it are brought below it [Hz]; measuring cards for sound reach 384 kHz."""

_REACH = 10
"""Samples of the result that the filter reaches to either side."""

_PASS_BAND = 0.8
"""Where the filter has fallen to half, over half of the new rate."""


def decimated(read: Read, n_samples: int, rate: float) -> tuple[Read, int, float]:
    """Bring a recording to a rate that can be worked with.

    Parameters
    ----------
    read : callable
        From first and last sample to the samples between them, shape (n_channels, n) [unit of
        each channel].
    n_samples : int
        Of each channel.
    rate : float
        [Hz]

    Returns
    -------
    read : callable
    n_samples : int
    rate : float
        [Hz]; all three as they were, up to `HIGHEST_WORKED`.

    Examples
    --------
    >>> ones = np.ones((1, 10_000))
    >>> read, n, rate = decimated(lambda first, last: ones[:, first:last], 10_000, 1e6)
    >>> n, round(rate), np.allclose(read(100, 110), 1.0)
    (3334, 333333, True)
    """
    every = math.ceil(rate / HIGHEST_WORKED)
    if every <= 1:
        return read, n_samples, rate
    n = -(-n_samples // every)

    def read_decimated(first: int, last: int) -> NDArray[np.float64]:
        from scipy.signal import upfirdn

        last = min(last, n)
        taps, reach = _taps(every), _REACH * every
        start, end = first * every - reach, (last - 1) * every + reach + 1
        there = read(max(start, 0), min(end, n_samples))
        missing = (max(0, -start), max(0, end - n_samples))
        padded = np.pad(there, ((0, 0), missing), mode="edge")
        filtered = upfirdn(taps, padded, 1, every, axis=1)
        return np.ascontiguousarray(filtered[:, 2 * _REACH : 2 * _REACH + last - first])

    return read_decimated, n, rate / every


@lru_cache(maxsize=8)
def _taps(every: int) -> NDArray[np.float64]:
    from scipy.signal import firwin

    return np.asarray(firwin(2 * _REACH * every + 1, _PASS_BAND / every, window=("kaiser", 8.0)))
