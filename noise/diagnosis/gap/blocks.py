"""What a recording that was made only once tells of its repeats: how its blocks differ.

Blocks say how unsteady a run is, not how runs differ; so this is the least that repeats differ by.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.gap.signature import signature

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.recording import Recording

__all__ = ["block_repeats", "block_signatures"]

_BLOCK = 0.25
"""Shortest block of a recording that has a signature of its own [s]."""

_MOST_BLOCKS = 16
_FEWEST_BLOCKS = 3


def block_repeats(recording: Recording, n: int, *, seed: int = 0) -> list[NDArray[np.float64]]:
    """Repeats of a recording that was made only once, from its blocks.

    Parameters
    ----------
    recording : Recording
        Of 0.75 s at least.
    n : int
        Number of repeats.
    seed : int

    Returns
    -------
    list of ndarray
        Signatures; they scatter about that of the whole as the means of blocks drawn with
        replacement do about the mean of all (Kunsch 1989, Ann. Statist. 17, 1217).

    Raises
    ------
    ValueError
        The recording is too short for three blocks.
    """
    blocks = block_signatures(recording)
    if blocks is None:
        raise ValueError(
            f"recording of {recording.duration:.3g} s: {_FEWEST_BLOCKS * _BLOCK:g} s at least for "
            "a floor from blocks"
        )
    rng = np.random.default_rng(seed)
    whole, mean = signature(recording), blocks.mean(axis=0)
    few = np.sqrt(len(blocks) / (len(blocks) - 1.0))  # a bootstrap's variance falls short by that
    drawn = rng.integers(len(blocks), size=(n, len(blocks)))
    return [whole + few * (blocks[i].mean(axis=0) - mean) for i in drawn]


def block_signatures(recording: Recording) -> NDArray[np.float64] | None:
    """Describe each block of a recording.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_blocks, n_values), or None
        None where the recording is too short for three.
    """
    count = min(int(recording.duration / _BLOCK + 1e-6), _MOST_BLOCKS)
    if count < _FEWEST_BLOCKS:
        return None
    n = recording.samples.shape[1] // count
    return np.array([
        signature(replace(recording, samples=recording.samples[:, i * n : (i + 1) * n]))
        for i in range(count)
    ])  # fmt: skip
