"""The level of a part of a recording, however long: summed up piece by piece."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from noise.recordings.blocks import RecordingBlocks

__all__ = ["block_levels"]

_PIECE = 10.0
"""What is held in memory [s]."""


def block_levels(
    blocks: RecordingBlocks, first: int, last: int
) -> tuple[float | None, float | None]:
    """Level of the first pressure channel in a part of a recording.

    Parameters
    ----------
    blocks : RecordingBlocks
    first, last : int
        The part from sample `first` up to `last`.

    Returns
    -------
    level, level_dbfs : float or None
        Of the alternating part: in dB re 20 uPa, ``None`` where not calibrated, and in dB re full
        scale; both ``None`` where there is no pressure, or none that varies.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings.blocks import RecordingBlocks
    >>> pascal = Recording(np.array([[1.0, -1.0] * 50]), 100.0, (Channel("pressure"),))
    >>> level, level_dbfs = block_levels(RecordingBlocks.of(pascal), 0, 100)
    >>> round(level, 2), level_dbfs
    (93.98, 0.0)
    """
    row = blocks.first("pressure")
    if row is None:
        return None, None
    length = round(_PIECE * blocks.rate)
    n = last - first
    mean = sum(float(p.samples[row].sum()) for p in blocks.pieces(first, last, length)) / n
    # Scaled by the peak, whose square may overflow.
    peaks, squares = [], []
    for piece in blocks.pieces(first, last, length):
        signal = piece.samples[row] - mean
        peaks.append(float(np.abs(signal).max()))
        scaled = signal / peaks[-1] if peaks[-1] > 0.0 else signal
        squares.append(float((scaled**2).sum()))
    peak = max(peaks)
    if not peak > 0.0:
        return None, None
    square = sum(s * (p / peak) ** 2 for s, p in zip(squares, peaks, strict=True)) / n
    rms_db = 20.0 * float(np.log10(peak) + np.log10(np.sqrt(square)))
    full_scale = blocks.channels[row].full_scale if blocks.calibrated else 1.0
    level_dbfs = rms_db - 20.0 * float(np.log10(full_scale))
    if not blocks.calibrated:
        return None, level_dbfs
    return rms_db - 20.0 * float(np.log10(REFERENCE_PRESSURE)), level_dbfs
