"""The speed of the shaft over a segment: as it was logged, where the channels agree with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from noise.recordings.logged_speed import agrees, as_logged

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from noise.recordings.blocks import RecordingBlocks

__all__ = ["OF_CHANNEL", "segment_speed", "speed_remark"]

_SPEED_BLOCK = 0.02
"""Length over which the angle is averaged before its slope is taken [s]."""

_BLOCKS_AT_ONCE = 500
"""How many of them are read together."""

OF_CHANNEL = "is that of the channel"
"""What a remark says of a speed that stands in place of the one that was logged."""


def segment_speed(blocks: RecordingBlocks, start: float, end: float) -> float | None:
    """Mean speed of the shaft over a segment: from its channels, else as it was logged.

    Its magnitude where the shaft swings to and fro, whose mean speed is nothing.

    Parameters
    ----------
    blocks : RecordingBlocks
    start, end : float
        Of the segment [s].

    Returns
    -------
    float or None
        [rad/s]

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings.blocks import RecordingBlocks
    >>> angle = 4.999989 * np.arange(2000)[None] / 1e3
    >>> run = Recording(angle, 1e3, (Channel("angle"),), Condition(speed=5.0))
    >>> segment_speed(RecordingBlocks.of(run), 0.0, 2.0)
    5.0
    """
    logged, measured = blocks.condition.speed, _measured_speed(blocks, start, end)
    return logged if measured is None else as_logged(measured, logged)


def speed_remark(blocks: RecordingBlocks, speed: float | None) -> str:
    """Say that the speed of a segment is not the one that was logged; empty where it is.

    Parameters
    ----------
    blocks : RecordingBlocks
    speed : float or None
        As `segment_speed` gives it [rad/s].

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings.blocks import RecordingBlocks
    >>> run = Recording(np.zeros((1, 9)), 1e3, (Channel("angle"),), Condition(speed=5.0))
    >>> speed_remark(RecordingBlocks.of(run), 10.0)
    'speed 10 rad/s is that of the channel angle; 5 was logged'
    """
    logged = blocks.condition.speed
    if logged is None or speed is None or agrees(speed, logged):
        return ""
    channel = "angle" if blocks.first("speed") is None else "speed"
    return f"speed {speed:g} rad/s {OF_CHANNEL} {channel}; {logged:g} was logged"


def _measured_speed(blocks: RecordingBlocks, start: float, end: float) -> float | None:
    """Mean speed from the channels [rad/s], None where none tells it."""
    first = round(start * blocks.rate)
    last = min(round(end * blocks.rate), blocks.n_samples)
    block = max(1, round(_SPEED_BLOCK * blocks.rate))
    pieces = blocks.pieces(first, last, _BLOCKS_AT_ONCE * block)
    speed, angle = blocks.first("speed"), blocks.first("angle")
    if not blocks.calibrated:
        return None
    if speed is not None:
        return _mean_speed(piece.samples[speed] for piece in pieces)
    if angle is None or last - first <= block:
        return None
    if last - first < 3 * block:
        time = np.arange(last - first) / blocks.rate
        return float(np.polyfit(time, blocks.read(first, last)[angle], 1)[0])
    # Means of blocks first: the difference of single samples would be that of their noise.
    means = [_block_means(piece.samples[angle], block) for piece in pieces]
    return _mean_speed([np.diff(np.concatenate(means)) * blocks.rate / block])


def _block_means(signal: NDArray[np.float64], block: int) -> NDArray[np.float64]:
    whole = signal[: signal.size // block * block].reshape(-1, block)
    return np.asarray(whole.mean(axis=1))


def _mean_speed(pieces: Iterable[NDArray[np.float64]]) -> float:
    n, total, travelled = 0, 0.0, 0.0
    for speed in pieces:
        n += speed.size
        total += float(np.sum(speed))
        travelled += float(np.sum(np.abs(speed)))
    mean, magnitude = total / n, travelled / n
    return mean if abs(mean) > 0.9 * magnitude else magnitude
