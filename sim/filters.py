"""Linear filters that go on from block to block: convolution, anti-alias filter, decimation.

All carry what the next block needs, so that the blocks joined are what one call over the whole
signal gives, to rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, rfft
from scipy.signal import sosfilt, upfirdn

from sim.acquisition import analogue_filter, anti_alias_filter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


class AnalogueFilter:
    """The anti-alias filter of a sensor, as `sim.acquisition.decimate_sensed` has it.

    Parameters
    ----------
    corner : float, optional
        [Hz]; without one, signals pass as they are.
    rate : float
        Of the signal [Hz].
    skip : int
        Samples at the start that pass as they are: the filter starts settled at the one after.

    Examples
    --------
    >>> low = AnalogueFilter(1e3, 90e3, skip=2)
    >>> [low(np.array(block)).round(9).tolist() for block in ([3.0], [4.0, 5.0], [5.0])]
    [[3.0], [4.0, 5.0], [5.0]]
    """

    def __init__(self, corner: float | None, rate: float, skip: int = 0) -> None:
        self._found, self._skip = analogue_filter(corner, rate), skip
        self._state: NDArray[np.float64] | None = None

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the next samples, as many as `block` has."""
        if self._found is None:
            return block
        before, rest = block[: self._skip], block[self._skip :]
        self._skip -= before.size
        if not rest.size:
            return before
        sections, settled = self._found
        state = settled * rest[0] if self._state is None else self._state
        passed, self._state = sosfilt(sections, rest, zi=state)
        return np.concatenate([before, passed])


class Decimation:
    """Anti-alias filter and decimation as `sim.acquisition.sample` does them.

    What it returns lags behind what it is given by half the filter's length. Before its first
    sample the signal is taken to go on straight, by its first two.

    Parameters
    ----------
    factor : int
        Every so many samples one is kept.
    skip : int
        Samples at the start that only the filter is to see.

    Examples
    --------
    >>> third = Decimation(3)
    >>> [third(np.full(60, 2.0)).size for _ in range(3)]
    [10, 20, 20]
    """

    def __init__(self, factor: int, skip: int = 0) -> None:
        self._factor, self._skip = factor, skip
        self._filter = anti_alias_filter(factor) if factor > 1 else np.ones(1)
        self._half = self._filter.size // 2
        self._held: NDArray[np.float64] | None = None

    @property
    def lookahead(self) -> int:
        """Samples that it must be given after the last that is to be kept."""
        return self._half

    def __call__(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return those of the next samples that are known by now."""
        if self._held is None:
            before = np.arange(-self._half, 0)
            self._held = block[0] + before * (block[1:2] - block[:1])
        held = np.concatenate([self._held, block])
        dropped = min(self._skip, held.size)
        held, self._skip = held[dropped:], self._skip - dropped
        count = (held.size - 2 * self._half - 1) // self._factor + 1
        if count <= 0 or self._skip > 0:
            self._held = held
            return np.empty(0)
        used = held[: (count - 1) * self._factor + 2 * self._half + 1]
        kept = upfirdn(self._filter, used, 1, self._factor)
        first = 2 * self._half // self._factor
        self._held = held[count * self._factor :]
        return np.asarray(kept[first : first + count])


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
