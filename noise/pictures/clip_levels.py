"""Levels of the lines of a whole sound over time, by logarithmic frequency, for a spectrogram.

One grid for pages and pictures, so that the same sound looks the same in both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.audio.line_levels import Grid, line_levels
from noise.audio.long_sound import LongSound

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["HIGHEST", "LOWEST", "RATE", "clip_levels"]

RATE = 48000
"""Of the sounds [Hz]."""

LOWEST, HIGHEST = 50.0, 20e3
"""Of the frequency axis [Hz]."""

_WIDTH, _HEIGHT = 600, 150
_LENGTH = 2048


def clip_levels(samples: NDArray[np.float32] | LongSound, reference: float) -> NDArray[np.float64]:
    """Levels of lines over time and logarithmic frequency.

    Parameters
    ----------
    samples : ndarray, shape (n,), or LongSound
        At `RATE`, in any unit, such as [Pa].
    reference : float
        Of the levels, in the unit of the samples, such as [Pa].

    Returns
    -------
    ndarray, shape (150, n_columns)
        The largest line in each row and column [dB re `reference`], the highest frequency first;
        a steady tone has its own level.

    Examples
    --------
    >>> import numpy as np
    >>> tone = np.sin(2 * np.pi * 984.375 * np.arange(48000) / 48e3).astype(np.float32)
    >>> levels = clip_levels(tone, 1.0)
    >>> round(float(levels.max())), levels.shape[0]
    (-3, 150)
    """
    sound = LongSound.of(samples, RATE)
    n = sound.n_samples
    width = int(min(_WIDTH, max(16, n // 96)))
    grid = Grid(0, n, width, _HEIGHT, LOWEST, HIGHEST, _LENGTH)
    return line_levels(sound.read, n, RATE, reference, grid)
