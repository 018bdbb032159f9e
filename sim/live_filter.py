"""Convolution in short blocks whose impulse responses can be exchanged while it runs.

The responses are cut into as many parts as they have blocks (uniformly partitioned overlap-save),
so that a block costs what its length costs and not what the responses' lengths do. What has gone in
is kept as spectra: other responses take over as if they had always been there, over one block.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, rfft

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["LiveConvolution", "crossing"]


def crossing(n: int) -> NDArray[np.float64]:
    """Weights of what comes over `n` samples in place of something else [-], shape (n,).

    Examples
    --------
    >>> crossing(2).round(3)
    array([0.146, 0.854])
    """
    return np.asarray(np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2)


class LiveConvolution:
    """Causal convolution of several signals, each with its impulse response; the sum comes out.

    Parameters
    ----------
    responses : sequence of ndarray, shape (m,)
        One a signal [unit of the output over that of the signal].
    block : int
        Samples of each block.
    longest : int
        Samples that are remembered: responses that are longer are cut there.

    Examples
    --------
    >>> echo = LiveConvolution([np.array([3.0, 1.0])], block=2, longest=4)
    >>> echo([np.array([1.0, 0.0])]).round(9), echo([np.array([2.0, 0.0])]).round(9)
    (array([3., 1.]), array([6., 2.]))
    """

    def __init__(self, responses: Sequence[NDArray[np.float64]], block: int, longest: int) -> None:
        self._block, self._parts = block, -(-longest // block)
        self._before = np.zeros((len(responses), block))
        self._seen = np.zeros((self._parts, len(responses), block + 1), dtype=np.complex128)
        self._newest = 0
        self._now = self._spectra(responses)
        self._next: NDArray[np.complex128] | None = None

    def exchange(self, responses: Sequence[NDArray[np.float64]]) -> None:
        """Let other responses, shape (m,) each and as many as before, take over within a block."""
        self._next = self._spectra(responses)

    def __call__(self, signals: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the next samples, shape (block,), for a block of each signal."""
        blocks = np.stack(list(signals))
        self._newest = (self._newest - 1) % self._parts
        self._seen[self._newest] = rfft(np.hstack([self._before, blocks]))
        self._before = blocks
        made = self._through(self._now)
        if self._next is not None:
            made += crossing(self._block) * (self._through(self._next) - made)
            self._now, self._next = self._next, None
        return made

    def _through(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        n, first = len(spectra), self._newest
        straight = min(n, self._parts - first)
        total = _sum_of_products(self._seen[first : first + straight], spectra[:straight])
        if straight < n:
            total += _sum_of_products(self._seen[: n - straight], spectra[straight:])
        return np.asarray(irfft(total)[self._block :])

    def _spectra(self, responses: Sequence[NDArray[np.float64]]) -> NDArray[np.complex128]:
        size = min(max(response.size for response in responses), self._parts * self._block)
        parts = -(-size // self._block)
        cut = np.zeros((len(responses), parts * self._block))
        for row, response in zip(cut, responses, strict=True):
            kept = response[:size]
            row[: kept.size] = kept
        by_part = cut.reshape(len(responses), parts, self._block).transpose(1, 0, 2)
        return np.asarray(rfft(by_part, 2 * self._block))


def _sum_of_products(
    a: NDArray[np.complex128], b: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    return np.asarray(np.einsum("ijk,ijk->k", a, b))
