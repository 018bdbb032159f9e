"""Spectrogram of a sound over time and logarithmic frequency.

Pages, app and pictures share it, so that the same sound looks the same in all of them. Each row and
column holds the largest line in it, so that neither a click nor a tone is lost where a row or
column holds many. Frames are transformed in single precision, many at once: what lies 140 dB below
the strongest line of its frame is not measured, and no picture shows it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LOWEST, HIGHEST = 50.0, 20e3
"""Of the frequency axis, where nothing else is asked for [Hz]."""

_WIDTH, _HEIGHT = 600, 150
_FRAME = 2048 / 48000
"""[s]"""

_SILENCE = -300.0
"""Level of digital zero [dB]."""

_FRAMES_AT_ONCE = 128

_MOST_FRAMES = 16
"""Of one column: where a column is longer than they are, moments of it are looked at."""


@dataclass(frozen=True)
class Grid:
    """Interval and resolution of a spectrogram.

    Parameters
    ----------
    first, last : int
        Samples that the columns share evenly.
    width, height : int
        Columns, and rows of the same ratio of frequencies.
    lowest, highest : float
        Ends of the rows [Hz].
    length : int
        Of a frame, under a Hann window [samples].
    padding : int
        How many times as long a frame is made by zeros: a tone between two lines is then not as far
        from either. 1.4 dB are lost at most by 1, 0.4 dB by 2 [ratio].
    """

    first: int
    last: int
    width: int
    height: int
    lowest: float
    highest: float
    length: int
    padding: int = 1

    @property
    def edges(self) -> NDArray[np.float64]:
        """Edges of the rows, shape (height + 1,) [Hz]."""
        return np.geomspace(self.lowest, self.highest, self.height + 1)


def whole_grid(n: int, rate: float) -> Grid:
    """Return the default grid of a sound of `n` samples at a rate [Hz].

    Examples
    --------
    >>> whole_grid(48000, 48e3).width, whole_grid(48000, 48e3).length
    (500, 2048)
    """
    width = int(min(_WIDTH, max(16, n // round(0.002 * rate))))
    return Grid(0, n, width, _HEIGHT, LOWEST, HIGHEST, 1 << round(math.log2(_FRAME * rate)))


def spectrogram(
    read: Callable[[int, int], NDArray[np.floating]],
    n: int,
    rate: float,
    reference: float,
    grid: Grid | None = None,
) -> NDArray[np.float64]:
    """Return the levels in the rows and columns of a grid.

    Parameters
    ----------
    read : callable
        From first and last sample to the samples between them, shape (last - first,).
    n : int
        Samples of the whole sound; before and after them it is silent.
    rate : float
        Sampling rate [Hz].
    reference : float
        Of the levels [unit of the samples].
    grid : Grid, optional
        `whole_grid` by default.

    Returns
    -------
    ndarray, shape (height, width)
        The largest line in each row and column [dB re `reference`], the highest frequency first;
        a steady tone has its own level. Above half the sampling rate it is silent.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 984.375 * np.arange(48000) / 48e3)
    >>> levels = spectrogram(lambda first, last: tone[first:last], 48000, 48e3, 1.0)
    >>> round(float(levels.max()), 1), levels.shape
    (-3.0, (150, 500))
    """
    from scipy import fft

    grid = grid or whole_grid(n, rate)
    padded = grid.padding * grid.length
    window = _window(grid.length)
    bins = fft.rfftfreq(padded, 1.0 / rate)
    ends = np.searchsorted(bins, grid.edges)
    middles = np.sqrt(grid.edges[:-1] * grid.edges[1:])
    # At low frequencies some rows lie between two lines.
    nearest, between = np.abs(bins[:, None] - middles).argmin(axis=0), np.diff(ends) == 0
    # Several frames a column, so that no click falls between two.
    span = (grid.last - grid.first) / grid.width
    each = min(_MOST_FRAMES, max(1, math.ceil(span / (grid.length // 4))))
    centres = grid.first + (np.arange(grid.width * each) + 0.5) * span / each
    starts = centres.astype(int) - grid.length // 2
    columns = max(1, _FRAMES_AT_ONCE // each)
    power = np.empty((grid.width, grid.height))
    for column in range(0, grid.width, columns):
        at = starts[column * each : (column + columns) * each]
        part = _part(read, n, int(at[0]), int(at[-1]) + grid.length)
        frames = np.lib.stride_tricks.sliding_window_view(part, grid.length)[at - at[0]]
        lines = fft.rfft(_without_offset(frames, window), padded, axis=1)
        strength = (lines.real**2 + lines.imag**2).reshape(-1, each, bins.size).max(axis=1)
        # One more, for a row that ends with the last line.
        strength = np.pad(strength, ((0, 0), (0, 1)))
        largest = np.maximum.reduceat(strength, ends, axis=1)[:, :-1]
        power[column : column + columns] = np.where(between, strength[:, nearest], largest)
    power[:, grid.edges[:-1] > 0.5 * rate] = 0.0
    return _levels(power, reference).T[::-1]


def _window(length: int) -> NDArray[np.float32]:
    """Return the window, scaled so that squared magnitudes are mean squares of tones."""
    window = np.hanning(length)
    return np.asarray(window * (math.sqrt(2.0) / window.sum()), dtype=np.float32)


def _without_offset(
    frames: NDArray[np.float32], window: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return windowed frames without their offset, which would leak into low frequencies.

    Of a tone the mean under the window is nothing, which the plain mean is not.
    """
    # No product of matrices: that begins threads, which cost more than they save here.
    offset = np.einsum("...i,i->...", frames, window) / window.sum()
    centred = frames - offset[..., None]
    centred *= window
    return np.asarray(centred)


def _part(
    read: Callable[[int, int], NDArray[np.floating]], n: int, first: int, last: int
) -> NDArray[np.float32]:
    inside = np.clip((first, last), 0, n).tolist()
    part = np.asarray(read(*inside), dtype=np.float32)
    return np.pad(part, (inside[0] - first, last - inside[1])) if part.size < last - first else part


def _levels(power: NDArray[np.float64], reference: float) -> NDArray[np.float64]:
    with np.errstate(divide="ignore"):
        return np.maximum(10.0 * np.log10(power / reference**2), _SILENCE)
