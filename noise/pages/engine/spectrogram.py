"""The spectrogram of a clip as a small picture, without axes: the page draws those.

Time runs across the whole width and nothing else does, so that a cursor over the picture needs no
more than the fraction of the clip that has been played. Frequency is logarithmic, as the ear hears
it. Colours are levels, the same for all pictures of a page, dark on light: that is read on a
projector and costs no toner.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["RANGE", "TICKS", "picture", "scale_picture", "top"]

RANGE = 70.0
"""From the darkest colour to white [dB]."""

TICKS = {100: "100", 200: "200", 500: "500", 1000: "1k", 2000: "2k", 5000: "5k", 10000: "10k"}

_COLOURS = 16


def top(levels: Sequence[NDArray[np.float64]]) -> float:
    """Return the level of the darkest colour: the highest of all, rounded up to 5 dB.

    Parameters
    ----------
    levels : sequence of ndarray, shape (n_rows, n_columns)
        Of `clip_levels` [dB].

    Returns
    -------
    float
        [dB]
    """
    highest = max((float(one.max()) for one in levels), default=0.0)
    return 5.0 * math.ceil(highest / 5.0)


def picture(levels: NDArray[np.float64], highest: float) -> bytes:
    """Return levels as a PNG file, `highest` the darkest and `RANGE` below it white.

    Parameters
    ----------
    levels : ndarray, shape (n_rows, n_columns)
        Of `clip_levels` [dB].
    highest : float
        [dB]
    """
    share = np.clip((levels - highest + RANGE) / RANGE, 0.0, 1.0)
    return _png(np.round(share * (_COLOURS - 1)).astype(np.uint8))


def scale_picture() -> bytes:
    """Return the colours from the lowest level to the highest, one pixel each, as a PNG file."""
    return _png(np.arange(_COLOURS, dtype=np.uint8)[np.newaxis])


def _png(steps: NDArray[np.uint8]) -> bytes:
    """Write a PNG file of four bits a pixel."""
    from matplotlib import colormaps
    from PIL import Image

    colours = (255 * colormaps["magma_r"](np.linspace(0.0, 1.0, _COLOURS))[:, :3]).astype(np.uint8)
    colours[0] = 255
    image = Image.fromarray(steps).convert("P")
    image.putpalette(colours.tobytes())
    png = io.BytesIO()
    image.save(png, "PNG", bits=4, optimize=True)
    return png.getvalue()
