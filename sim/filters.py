"""Linear filters that go on from block to block: convolution, anti-alias filter, decimation.

All carry what the next block needs, so that the blocks joined are what one call over the whole
signal gives, to rounding.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft


def crossing(n: int) -> NDArray[np.float64]:
    """Weights of what comes over `n` samples in place of something else [-], shape (n,).

    Examples
    --------
    >>> crossing(2).round(3)
    array([0.146, 0.854])
    """
    return np.asarray(np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2)


class Convolution:
    """Causal convolution of several signals, whose sums come out, one or more.

    Responses can be exchanged while it runs. They are cut into as many parts as they have blocks
    (uniformly partitioned overlap-save), so that a block costs what its length costs and not what
    the responses' lengths do. What has gone in is kept as spectra: other responses take over as if
    they had always been there, over one block.

    Parameters
    ----------
    responses : sequence of sequence of ndarray, shape (m,)
        For each output one a signal [unit of the output over that of the signal].
    block : int
        Samples of each block.
    longest : int
        Samples that are remembered: responses that are longer are cut there.

    Examples
    --------
    >>> echo = Convolution([[np.array([3.0, 1.0])]], block=2, longest=4)
    >>> [echo([np.array(block)]).round(9).tolist() for block in ([1.0, 0.0], [2.0, 0.0])]
    [[[3.0, 1.0]], [[6.0, 2.0]]]
    """

    def __init__(
        self, responses: Sequence[Sequence[NDArray[np.float64]]], block: int, longest: int
    ) -> None:
        self._block, self._parts = block, -(-longest // block)
        self._before = np.zeros((len(responses[0]), block))
        self._seen = np.zeros((self._parts, len(responses[0]), block + 1), dtype=np.complex128)
        self._newest = 0
        self._now = [self._spectra(own) for own in responses]
        self._next: list[NDArray[np.complex128]] | None = None

    def exchange(self, responses: Sequence[Sequence[NDArray[np.float64]]]) -> None:
        """Let other responses, shape (m,) each and as many as before, take over within a block."""
        self._next = [self._spectra(own) for own in responses]

    def __call__(self, signals: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the next samples, shape (n_outputs, block), for a block of each signal."""
        blocks = np.stack(list(signals))
        self._newest = (self._newest - 1) % self._parts
        self._seen[self._newest] = rfft(np.hstack([self._before, blocks]))
        self._before = blocks
        made = np.stack([self._through(own) for own in self._now])
        if self._next is not None:
            coming = np.stack([self._through(own) for own in self._next])
            made += crossing(self._block) * (coming - made)
            self._now, self._next = self._next, None
        return made

    def _through(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        order = (self._newest + np.arange(len(spectra))) % self._parts
        total = np.zeros(self._block + 1, dtype=np.complex128)
        for part, own in zip(order, spectra, strict=True):
            total += np.einsum("jk,jk->k", self._seen[part], own)
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
