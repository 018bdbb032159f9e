"""Intervals of gaps by resampling whole blocks of a record.

The errors of a simulation are correlated over the oscillator's decay; blocks of many decay times
are not. The same blocks are drawn for all models, so that differences between models are paired.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from tests.studies.oscillator_terms.oscillator import Span

__all__ = ["BlockErrors", "block_errors", "cut", "drawn_blocks"]


@dataclass(frozen=True, eq=False)
class BlockErrors:
    """Mean square error in each block of the spans of a record.

    Parameters
    ----------
    squares : ndarray, shape (n_blocks,)
        In the square of the response's unit.
    """

    squares: NDArray[np.float64]

    @property
    def rms(self) -> float:
        """Root of the mean square over all blocks."""
        return float(np.sqrt(np.mean(self.squares)))

    def resampled(self, drawn: NDArray[np.intp]) -> NDArray[np.float64]:
        """Rms of each draw of blocks, shape (n_draws,)."""
        rms: NDArray[np.float64] = np.sqrt(np.mean(self.squares[drawn], axis=1))
        return rms


def block_errors(errors: Sequence[NDArray[np.float64]], length: int) -> BlockErrors:
    """Cut the errors of each span into blocks; a remainder shorter than a block is left out.

    Examples
    --------
    >>> import numpy as np
    >>> block_errors([np.array([1.0, 1.0, 2.0, 2.0, 9.0])], 2).squares
    array([1., 4.])
    """
    squares = [
        np.mean(error[: len(error) // length * length].reshape(-1, length) ** 2, axis=1)
        for error in errors
    ]
    return BlockErrors(np.concatenate(squares))


def drawn_blocks(count: int, draws: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Draw indices of blocks with replacement, shape (draws, count)."""
    return rng.integers(count, size=(draws, count))


def cut(spans: Sequence[Span], parts: int) -> list[list[Span]]:
    """Deal each span's equal parts out in turn.

    Examples
    --------
    >>> cut([(0, 10)], 2)
    [[(0, 5)], [(5, 10)]]
    """
    dealt: list[list[Span]] = [[] for _ in range(parts)]
    for start, stop in spans:
        edges = np.linspace(start, stop, parts + 1).astype(int)
        for part in range(parts):
            dealt[part].append((int(edges[part]), int(edges[part + 1])))
    return dealt
