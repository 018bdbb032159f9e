"""Sound levels of segments, and their levels over the background.

A-weighted levels are those that `features.kernels.weighting` measures of the same samples.

The background is all that is not labelled as a noise. Its level is the one exceeded for 90 % of the
time, L_A90 (ISO 1996-1), which a slamming door does not raise. Digital silence, as of a gate or an
editor, is excluded.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.weighting import weighted_levels
from models.recording import REFERENCE_PRESSURE, RecordingBlocks
from noise.base.labels import NAMED

if TYPE_CHECKING:
    from noise.labels.segments import Segment


_EXCEEDED = 90.0
"""Share of the time for which the background exceeds its level [%]."""

_LEAST_BACKGROUND = 4
"""Minimum number of eighths of a second of a background."""

_RANGE = 110.0
"""Range below the loudest eighth of a second beyond which sound is digital silence [dB]: 16 bits
have 98, and the ringing of the weighting filter beside zeros lies at 130."""

CELL_RATE = 100
"""Cells per second; segments consist of whole cells."""

_PIECE = 1 << 16
"""Samples per block."""


def cell_edges(rate: float, n_samples: int) -> NDArray[np.int64]:
    """Return the first samples of cells of 10 ms, and the end of the last cell.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray of int, shape (n_cells + 1,)

    Examples
    --------
    >>> cell_edges(1000.0, 25).tolist()
    [0, 10, 25]
    """
    count = max(1, round(n_samples * CELL_RATE / rate))
    # Sampling rates below 100 Hz give fewer samples than cells.
    edges = np.round(np.arange(count + 1) * (rate / CELL_RATE)).astype(np.int64)
    edges[-1] = n_samples
    return np.unique(np.minimum(edges, n_samples))


def rms_level(blocks: RecordingBlocks, row: int, first: int, last: int) -> float | None:
    """Return the rms level of a part of a channel about its mean.

    Parameters
    ----------
    blocks : RecordingBlocks
    row : int
        Row of the channel.
    first, last : int
        Range of samples.

    Returns
    -------
    float or None
        Level [dB re the unit of the channel]; ``None`` if all samples are equal.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tone = Recording(np.array([[1.0, -1.0] * 50]), 1e3, (Channel("pressure"),))
    >>> rms_level(RecordingBlocks.of(tone), 0, 0, 100)
    0.0
    """
    sizes, means, parts = [], [], []
    for piece in blocks.pieces(first, last, _PIECE):
        x = piece.samples[row]
        sizes.append(x.size)
        means.append(float(x.mean()))
        parts.append(_rms(x - means[-1]))
    n = sum(sizes)
    offsets = np.array(means) - np.dot(means, sizes) / n
    rms = _rms(np.concatenate([parts, offsets]), np.array([*sizes, *sizes]) / n)
    return 20.0 * math.log10(rms) if rms > 0.0 else None


def _rms(x: NDArray[np.float64], weight: NDArray[np.float64] | None = None) -> float:
    """Return the root mean square, scaled by the peak to avoid overflow."""
    peak = float(max(x.max(), -x.min()))
    if not peak > 0.0:
        return 0.0
    x = x / peak
    square = np.dot(x, x) / x.size if weight is None else np.dot(weight, x * x)
    return peak * math.sqrt(square)


def sound_levels(
    rms_db: float | None, *, calibrated: bool, full_scale: float
) -> tuple[float | None, float | None]:
    """Return the sound pressure level and the level re full scale.

    Parameters
    ----------
    rms_db : float or None
        Root mean square of the samples [dB re their unit]; ``None`` for digital zero.
    calibrated : bool
        Whether the unit of the samples is the pascal.
    full_scale : float
        Sound pressure of a full-scale sample, for calibrated samples [Pa].

    Returns
    -------
    level : float or None
        [dB re 20 uPa]; ``None`` if not calibrated.
    level_dbfs : float or None
        [dB re full scale]

    Examples
    --------
    >>> level, level_dbfs = sound_levels(0.0, calibrated=True, full_scale=1.0)
    >>> round(level, 2), level_dbfs
    (93.98, 0.0)
    """
    if rms_db is None:
        return None, None
    level_dbfs = rms_db - 20.0 * math.log10(full_scale if calibrated else 1.0)
    return (rms_db - 20.0 * math.log10(REFERENCE_PRESSURE) if calibrated else None), level_dbfs


def with_levels(blocks: RecordingBlocks, segments: list[Segment]) -> list[Segment]:
    """Return the segments of a track with their levels and levels over the background.

    Parameters
    ----------
    blocks : RecordingBlocks
        The track; without a pressure channel, segments are returned unchanged.
    segments : list of Segment
        All segments of the track, in order of time.

    Returns
    -------
    list of Segment
    """
    row = blocks.first("pressure")
    if row is None or not segments:
        return segments
    reference = REFERENCE_PRESSURE if blocks.calibrated else 1.0
    full_scale = blocks.channels[row].full_scale
    measured, unweighted = [], []
    for segment in segments:
        first = round(segment.start * blocks.rate)
        last = min(round(segment.end * blocks.rate), blocks.n_samples)

        def read(start: int, end: int, first: int = first) -> NDArray[np.float64]:
            return np.asarray(blocks.read(first + start, first + end)[row])

        measured.append(weighted_levels(read, last - first, blocks.rate, reference=reference))
        rms = rms_level(blocks, row, first, last)
        unweighted.append(sound_levels(rms, calibrated=blocks.calibrated, full_scale=full_scale))
    # The first and last eighth of a second may contain the end of a neighbouring noise.
    outside = [
        levels.short[1:-1]
        for segment, levels in zip(segments, measured, strict=True)
        if segment.label not in NAMED
    ]
    loudest = max(levels.short.max(initial=-math.inf) for levels in measured)
    silent = loudest - _RANGE if math.isfinite(loudest) else -math.inf
    background = background_level(np.concatenate(outside), silent) if outside else None
    return [
        replace(
            segment,
            level=level,
            level_dbfs=level_dbfs,
            level_a=_finite(levels.level_a) if blocks.calibrated else None,
            level_af_max=_finite(levels.level_af_max) if blocks.calibrated else None,
            snr=levels.level_a - background
            if background is not None and levels.level_a > silent
            else None,
        )
        for segment, levels, (level, level_dbfs) in zip(segments, measured, unweighted, strict=True)
    ]


def background_level(levels: NDArray[np.float64], silent: float = -math.inf) -> float | None:
    """Return the level of a background, L_A90.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Levels of its eighths of a second [dB].
    silent : float
        Level up to which an eighth of a second is digital silence and is excluded [dB].

    Returns
    -------
    float or None
        [dB re the reference of the levels]; ``None`` if there are too few levels.

    Examples
    --------
    >>> background_level(np.array([40.0] * 9 + [70.0])), background_level(np.array([40.0]))
    (40.0, None)
    >>> background_level(np.array([-np.inf] * 9 + [40.0] * 9))
    40.0
    """
    levels = levels[levels > silent]
    if levels.size < _LEAST_BACKGROUND:
        return None
    ordered = np.sort(levels)
    return float(ordered[int((1.0 - 0.01 * _EXCEEDED) * levels.size)])


def _finite(level: float) -> float | None:
    return level if math.isfinite(level) else None
