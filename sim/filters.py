"""Block-wise convolution whose impulse responses can be exchanged while it runs.

It carries its state from block to block, so the joined blocks equal the convolution of the whole
signal to rounding.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft


def fade_in(n: int) -> NDArray[np.float64]:
    """Return the weights of a fade-in over `n` samples, a squared sine [-], shape (n,).

    Examples
    --------
    >>> fade_in(2).round(3)
    array([0.146, 0.854])
    """
    return np.asarray(np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2)


class Convolution:
    """Causal block-wise convolution of several signals, summed into one or more outputs.

    Each response is cut into parts of one block (uniformly partitioned overlap-save), so the
    latency is one block whatever the responses' lengths. Past input is stored as spectra: exchanged
    responses act as if they had always been there, faded in over one block.

    Parameters
    ----------
    responses : sequence of sequence of ndarray, shape (m,)
        For each output one response per signal [unit of the output over that of the signal].
    block : int
        Samples of each block.
    longest : int
        Samples of past input that are stored; longer responses are cut there.

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
        self._input_spectra = np.zeros(
            (self._parts, len(responses[0]), block + 1), dtype=np.complex128
        )
        self._newest = 0
        self._current = [self._spectra(own) for own in responses]
        self._next: list[NDArray[np.complex128]] | None = None

    def exchange(self, responses: Sequence[Sequence[NDArray[np.float64]]]) -> None:
        """Fade to other responses over the next block; shape (m,) each, as many as before."""
        self._next = [self._spectra(own) for own in responses]

    def __call__(self, signals: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the next samples, shape (n_outputs, block), for a block of each signal."""
        blocks = np.stack(list(signals))
        self._newest = (self._newest - 1) % self._parts
        self._input_spectra[self._newest] = rfft(np.hstack([self._before, blocks]))
        self._before = blocks
        outputs = np.stack([self._convolved(own) for own in self._current])
        if self._next is not None:
            following = np.stack([self._convolved(own) for own in self._next])
            outputs += fade_in(self._block) * (following - outputs)
            self._current, self._next = self._next, None
        return outputs

    def _convolved(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        order = (self._newest + np.arange(len(spectra))) % self._parts
        total = np.zeros(self._block + 1, dtype=np.complex128)
        for part, own in zip(order, spectra, strict=True):
            total += np.einsum("jk,jk->k", self._input_spectra[part], own)
        return np.asarray(irfft(total)[self._block :])

    def _spectra(self, responses: Sequence[NDArray[np.float64]]) -> NDArray[np.complex128]:
        size = min(max(response.size for response in responses), self._parts * self._block)
        parts = -(-size // self._block)
        cut = np.zeros((len(responses), parts * self._block))
        for row, response in zip(cut, responses, strict=True):
            row[: min(response.size, size)] = response[:size]
        by_part = cut.reshape(len(responses), parts, self._block).transpose(1, 0, 2)
        return np.asarray(rfft(by_part, 2 * self._block))
