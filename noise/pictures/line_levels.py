"""Levels of the lines of a sound over time, by logarithmic frequency, for a spectrogram.

A cell shows the strongest line in it, so that a thin tone and a short click are not averaged away.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HIGHEST", "LOWEST", "RATE", "line_levels"]

RATE = 48000
"""Of the sounds [Hz]."""

LOWEST, HIGHEST = 50.0, 20e3
"""Of the frequency axis [Hz]."""

_WIDTH, _HEIGHT = 600, 150
_LENGTH = 2048
_SILENCE = -300.0


def line_levels(samples: NDArray[np.float32], reference: float) -> NDArray[np.float64]:
    """Levels of lines over time and logarithmic frequency.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        In any unit, such as [Pa].
    reference : float
        Of the levels, in the unit of the samples, such as [Pa].

    Returns
    -------
    ndarray, shape (150, n_columns)
        The largest line in each row and column [dB re `reference`], the highest frequency first;
        a steady tone has its own level.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 984.375 * np.arange(48000) / 48e3).astype(np.float32)
    >>> levels = line_levels(tone, 1.0)
    >>> round(float(levels.max())), levels.shape[0]
    (-3, 150)
    """
    n_columns = int(min(_WIDTH, max(16, samples.size // 96)))
    window = np.hanning(_LENGTH)
    padded = np.pad(samples, _LENGTH // 2).astype(np.float64)
    # Several frames a column, so that no click falls between two.
    each = max(1, math.ceil(samples.size / n_columns / (_LENGTH // 4)))
    starts = (np.arange(n_columns * each) + 0.5) * samples.size / (n_columns * each)
    bins = np.fft.rfftfreq(_LENGTH, 1.0 / RATE)
    edges = np.geomspace(LOWEST, HIGHEST, _HEIGHT + 1)
    ends = np.searchsorted(bins, edges)
    nearest = np.abs(bins[:, None] - np.sqrt(edges[:-1] * edges[1:])).argmin(axis=0)
    power = np.zeros((_HEIGHT, n_columns))
    for column in range(n_columns):
        at = starts[column * each : (column + 1) * each].astype(int)
        frames = padded[at[:, None] + np.arange(_LENGTH)] * window
        lines = (np.abs(np.fft.rfft(frames, axis=1)) / window.sum()) ** 2 * 2.0
        strongest = lines.max(axis=0)[: ends[-1]]
        largest = np.maximum.reduceat(strongest, ends[:-1])
        # At low frequencies some rows lie between two lines.
        power[:, column] = np.where(np.diff(ends) > 0, largest, strongest[nearest])
    with np.errstate(divide="ignore"):
        levels = 10.0 * np.log10(power / reference**2)
    return np.maximum(levels, _SILENCE)[::-1]
