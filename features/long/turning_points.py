# mypy: allow-untyped-decorators
"""Maxima that stand out of a signal that comes piece by piece, and the minima between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from models.compilation import COMPILED

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["Smoother", "TurningPoints"]


class Smoother:
    """A running filter over a signal that comes piece by piece.

    Parameters
    ----------
    smooth : callable
        Filters a signal of any length, which it continues by its last value at either end.
    reach : int
        Samples that it looks at to either side.

    Examples
    --------
    >>> smoother = Smoother(lambda x: uniform_filter1d(x, 3, mode="nearest"), 1)
    >>> smoother.add(np.arange(5.0)).round(1).tolist(), smoother.finish().round(1).tolist()
    ([0.3, 1.0, 2.0, 3.0], [3.7])
    """

    def __init__(
        self, smooth: Callable[[NDArray[np.float64]], NDArray[np.float64]], reach: int
    ) -> None:
        self._smooth, self._reach = smooth, reach
        self._held = np.empty(0)
        self._past = 0

    @classmethod
    def gaussian(cls, deviation: float, truncate: float) -> Smoother:
        """Return one by a Gaussian.

        Parameters
        ----------
        deviation : float
            Its standard deviation [sample].
        truncate : float
            Where it ends, as a number of them [-].

        Returns
        -------
        Smoother
        """
        return cls(
            lambda x: gaussian_filter1d(x, deviation, mode="nearest", truncate=truncate),
            int(truncate * deviation + 0.5),
        )

    @classmethod
    def mean(cls, n: int) -> Smoother:
        """Return a running mean over `n` samples."""
        return cls(lambda x: uniform_filter1d(x, n, mode="nearest"), n // 2 + 1)

    def add(self, piece: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the next samples; return those of the smoothed signal that are settled.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].

        Returns
        -------
        ndarray, shape (m,)
            In the same [unit].
        """
        return self._smoothed(piece, self._reach)

    def finish(self) -> NDArray[np.float64]:
        """Return what is left when all samples have come, shape (m,)."""
        return self._smoothed(np.empty(0), 0)

    def _smoothed(self, piece: NDArray[np.float64], open_end: int) -> NDArray[np.float64]:
        self._held = np.concatenate([self._held, piece])
        if self._held.size - self._past <= open_end:
            return np.empty(0)
        smooth = np.asarray(self._smooth(self._held))
        settled = smooth[self._past : smooth.size - open_end]
        kept = min(smooth.size, self._reach + open_end)
        self._held = self._held[smooth.size - kept :].copy()
        self._past = kept - open_end
        return settled


class TurningPoints:
    """Maxima of at least a given prominence, as `scipy.signal.find_peaks` finds them in a whole.

    Parameters
    ----------
    prominence : float
        [unit of the signal]

    Examples
    --------
    >>> points = TurningPoints(2.0)
    >>> points.add(np.array([0.0, 3.0, 2.5, 2.9]))
    >>> points.add(np.array([0.0, 4.0, 1.0]))
    >>> points.peaks.tolist(), points.heights.tolist(), points.troughs.tolist()
    ([1, 5], [3.0, 4.0], [4, 6])
    """

    def __init__(self, prominence: float) -> None:
        self._prominence = prominence
        # Whether a maximum is sought, highest and where, lowest and where, samples so far.
        self._state = np.array([0.0, -math.inf, 0.0, math.inf, 0.0, 0.0])
        self._peaks: list[NDArray[np.float64]] = []
        self._troughs: list[NDArray[np.float64]] = []

    def add(self, piece: NDArray[np.float64]) -> None:
        """Take the next samples.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].
        """
        peaks, troughs = np.empty((piece.size + 1, 2)), np.empty((piece.size + 1, 2))
        n_peaks, n_troughs = _turn(piece, self._prominence, self._state, peaks, troughs)
        self._peaks.append(peaks[:n_peaks].copy())
        self._troughs.append(troughs[:n_troughs].copy())

    def keep_above(self, height: float) -> None:
        """Forget the maxima so far that are lower than `height` [unit], but not the minima."""
        self._peaks = [part[part[:, 1] >= height] for part in self._peaks]
        self._peaks = [np.concatenate(self._peaks)] if self._peaks else []
        self._troughs = []

    @property
    def peaks(self) -> NDArray[np.intp]:
        """Where the maxima are [sample], shape (n,)."""
        return self._all(self._peaks)[:, 0].astype(np.intp)

    @property
    def heights(self) -> NDArray[np.float64]:
        """How high they are [unit], shape (n,)."""
        return self._all(self._peaks)[:, 1]

    @property
    def troughs(self) -> NDArray[np.intp]:
        """Where the signal is lowest between each maximum and the next, or the end; shape (n,)."""
        return self._lowest()[:, 0].astype(np.intp)

    @property
    def depths(self) -> NDArray[np.float64]:
        """How low it is there [unit], shape (n,)."""
        return self._lowest()[:, 1]

    def _lowest(self) -> NDArray[np.float64]:
        # The first minimum stands before any maximum, and counts for none.
        found = self._all(self._troughs)[1:]
        if not self._state[0]:
            found = np.concatenate([found, self._state[[4, 3]][np.newaxis]])
        return found

    def _all(self, parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
        return np.concatenate([np.empty((0, 2)), *parts])


@njit(cache=True, **COMPILED)
def _turn(
    x: NDArray[np.float64],
    prominence: float,
    state: NDArray[np.float64],
    peaks: NDArray[np.float64],
    troughs: NDArray[np.float64],
) -> tuple[int, int]:
    """Go on from a state; a maximum counts when the signal has fallen by the prominence."""
    upwards, high, high_at, low, low_at, done = state
    n_peaks = n_troughs = 0
    for i in range(x.size):
        value = x[i]
        if upwards > 0.0:
            if value > high:
                high, high_at = value, done + i
            elif value <= high - prominence:
                peaks[n_peaks, 0], peaks[n_peaks, 1] = high_at, high
                n_peaks += 1
                upwards, low, low_at = 0.0, value, done + i
        elif value < low:
            low, low_at = value, done + i
        elif value >= low + prominence:
            troughs[n_troughs, 0], troughs[n_troughs, 1] = low_at, low
            n_troughs += 1
            upwards, high, high_at = 1.0, value, done + i
    state[0], state[1], state[2] = upwards, high, high_at
    state[3], state[4], state[5] = low, low_at, done + x.size
    return n_peaks, n_troughs
