"""Transforms of a long signal, block by block: what `conditioning.forward` gives of a short one.

Blocks overlap: each is faded in and out beside its useful part, so that a band that is cut from it
is the band that would be cut from the whole. At the signal's own ends it is faded as the whole is.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from scipy import fft

from features.kernels.conditioning import WORKING_RATE, Transform, edge_fade

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["Interior", "Overlapped", "block_sizes"]

Kind = TypeVar("Kind", bound=np.generic)

_MULTIPLE = 8
"""Samples at the working rate in what blocks are made of: other rates are 1/2 to 7/8 of it."""


def block_sizes(rate: float, useful: float, margin: float) -> tuple[int, int]:
    """Return samples of a block and of its margins: whole numbers also at the working rate.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    useful, margin : float
        About how long they shall be [s].

    Returns
    -------
    useful, margin : int

    Examples
    --------
    >>> block_sizes(48e3, 8.0, 1.0), block_sizes(44.1e3, 8.0, 1.0)
    ((384000, 48000), (352800, 45864))
    """
    ratio = Fraction(min(WORKING_RATE, rate)) / Fraction(rate).limit_denominator(1000)
    grain = _MULTIPLE * ratio.limit_denominator(1 << 22).denominator
    return (
        grain * max(1, math.ceil(useful * rate / grain)),
        grain * max(1, math.ceil(margin * rate / grain)),
    )


class Overlapped:
    """A signal that comes piece by piece, as transforms of overlapping blocks.

    Parameters
    ----------
    n_samples : int
        Of the signal.
    rate : float
        Sampling rate [Hz].
    useful, margin : int
        Samples of a block, and of what it has more on either side.

    Examples
    --------
    >>> blocks = Overlapped(1000, 1e3, 400, 50)
    >>> len(list(blocks.add(np.ones(1000)))), len(list(blocks.finish()))
    (2, 1)
    """

    def __init__(self, n_samples: int, rate: float, useful: int, margin: int) -> None:
        self._n, self._rate, self._useful, self._margin = n_samples, rate, useful, margin
        self._ends = edge_fade(n_samples, rate)
        outer = np.sin(0.5 * np.pi * (np.arange(margin // 2) + 0.5) / max(margin // 2, 1)) ** 2
        self._fade = outer
        self._buffer = np.zeros(useful + 2 * margin)
        self._filled = margin
        self._come = 0
        self._given = 0

    @property
    def lead(self) -> int:
        """Samples of the fade at the signal's start."""
        return self._ends.size

    def interior(self, ratio: float) -> Interior:
        """Return what cuts the fades off a band that is sampled at `ratio` times the rate."""
        start = round(self.lead * ratio)
        n = max(1, round((self._n - 2 * self.lead) * ratio))
        return Interior(start, start + n)

    def add(self, piece: NDArray[np.float64]) -> Iterator[Transform]:
        """Take the next samples; yield the transforms of the blocks that they complete.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].

        Yields
        ------
        Transform
            Its interior is the block's useful part.
        """
        yield from self._take(self._faded(piece))

    def finish(self) -> Iterator[Transform]:
        """Yield what is left when all samples have come."""
        nothing = np.zeros(self._buffer.size)
        while self._given * self._useful < self._n:
            yield from self._take(nothing[: self._buffer.size - self._filled])

    def _take(self, piece: NDArray[np.float64]) -> Iterator[Transform]:
        at, size = 0, self._buffer.size
        while at < piece.size:
            part = piece[at : at + size - self._filled]
            self._buffer[self._filled : self._filled + part.size] = part
            self._filled += part.size
            at += part.size
            if self._filled == size:
                yield self._transform()
                kept = 2 * self._margin
                self._buffer[:kept] = self._buffer[-kept:].copy()
                self._filled = kept

    def _transform(self) -> Transform:
        self._given += 1
        block = self._buffer.copy()
        n = self._fade.size
        block[:n] *= self._fade
        block[block.size - n :] *= self._fade[::-1]
        return Transform(fft.rfft(block), block.size, self._margin, self._useful, self._rate)

    def _faded(self, piece: NDArray[np.float64]) -> NDArray[np.float64]:
        """Fade what lies at the ends of the signal."""
        first, lead = self._come, self.lead
        self._come = last = first + piece.size
        if first >= lead and last <= self._n - lead:
            return piece
        piece = piece.copy()
        if first < lead:
            part = self._ends[first:last]
            piece[: part.size] *= part
        begin = max(first, self._n - lead)
        if begin < last:
            piece[begin - first :] *= self._ends[::-1][
                begin - (self._n - lead) : last - self._n + lead
            ]
        return piece


class Interior:
    """Cuts the faded ends off a band that comes block by block.

    Parameters
    ----------
    first, last : int
        Samples of the band to keep; `last` is not one of them.

    Examples
    --------
    >>> inside = Interior(2, 5)
    >>> inside.of(np.arange(4)).tolist(), inside.of(np.arange(4)).tolist()
    ([2, 3], [0])
    """

    def __init__(self, first: int, last: int) -> None:
        self._first, self._last = first, last
        self._position = 0

    @property
    def n_samples(self) -> int:
        """How many are kept."""
        return self._last - self._first

    def of(self, piece: NDArray[Kind]) -> NDArray[Kind]:
        """Return what of the next samples is kept.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].

        Returns
        -------
        ndarray, shape (m,)
            In the same [unit].
        """
        start = self._position
        self._position += piece.size
        return piece[max(0, self._first - start) : max(0, self._last - start)]
