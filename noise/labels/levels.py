"""Levels of any part of a recording, and of each of its segments over the background.

A-weighted levels are those that `features.kernels.level_meter` measures of the same samples, the
loudness N5 that of the library that the field keeps for it.

The background is what is left where no noise is named. Its level is the one exceeded for 90 % of
that time, L_A90, as the field has it (ISO 1996-1): a door that slams in between does not raise it.
Digital silence is no background: a gate, a fade or an editor put it there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.level_meter import weighted_levels
from features.sound_quality import SHORTEST, SOUND_QUALITY_RATE, loudness_n5
from models.blocks import RecordingBlocks
from models.recording import REFERENCE_PRESSURE
from noise.audio.sound import resampled
from noise.base.labels import NAMED

if TYPE_CHECKING:
    from noise.labels.segments import Segment


_EXCEEDED = 90.0
"""Share of the time for which the background is louder than its level [%]."""

_LEAST_BACKGROUND = 4
"""Eighths of a second without which a background has no level."""

_RANGE = 110.0
"""What lies farther below the loudest eighth of a second is digital silence [dB]: 16 bits reach 98,
and what is left beside zeros by the weighting lies at 130."""

CELL_RATE = 100
"""Cells in a second; segments begin and end with one."""

_PIECE = 1 << 16
"""Samples that are squared at a time."""


def cell_edges(rate: float, n_samples: int) -> NDArray[np.int64]:
    """Return the samples at which cells of 10 ms begin, and the end of the last.

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
    # Fewer samples than cells: rates of less than 100 Hz.
    edges = np.round(np.arange(count + 1) * (rate / CELL_RATE)).astype(np.int64)
    edges[-1] = n_samples
    return np.unique(np.minimum(edges, n_samples))


def rms_level(blocks: RecordingBlocks, row: int, first: int, last: int) -> float | None:
    """Return the level of a part of a channel, without its mean.

    Parameters
    ----------
    blocks : RecordingBlocks
    row : int
        Of the channel.
    first, last : int
        Samples from which and up to which.

    Returns
    -------
    float or None
        Of the root mean square [dB re the channel's unit]; ``None`` where all samples are equal.

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
    """Root of the mean square, in which shares of the peak are squared: values may overflow."""
    peak = float(max(x.max(), -x.min()))
    if not peak > 0.0:
        return 0.0
    x = x / peak
    square = np.dot(x, x) / x.size if weight is None else np.dot(weight, x * x)
    return peak * math.sqrt(square)


def sound_levels(
    rms_db: float | None, *, calibrated: bool, full_scale: float
) -> tuple[float | None, float | None]:
    """Return the level re 20 uPa and the level re full scale.

    Parameters
    ----------
    rms_db : float or None
        Root mean square of the samples [dB re their unit]; ``None`` for digital zero.
    calibrated : bool
        Whether their unit is the pascal.
    full_scale : float
        Sample that is full scale [Pa]; it counts where they are calibrated.

    Returns
    -------
    level : float or None
        [dB re 20 uPa]; ``None`` where not calibrated.
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
    """Add the levels of a track's segments, and their level over the background.

    Parameters
    ----------
    blocks : RecordingBlocks
        The track; where it has no pressure, nothing is added.
    segments : list of Segment
        All of it, in order of time; there may be none.

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
    # The first and the last eighth of a second may hold the end of a noise beside it.
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
    """Level of a background, L_A90.

    Parameters
    ----------
    levels : ndarray, shape (n,)
        Of each eighth of a second of it [dB].
    silent : float
        What is not above it is digital silence and does not count [dB].

    Returns
    -------
    float or None
        [dB re what the levels are]; ``None`` where there is too little of it.

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


_LONGEST = 600.0
"""Longest segment that is analysed [s]: a second of sound takes a second."""


def with_loudness(blocks: RecordingBlocks, segments: Sequence[Segment]) -> list[Segment]:
    """Add the loudness N5 of segments, as `noise.audio.assessment.assess` tells it of such a sound.

    Parameters
    ----------
    blocks : RecordingBlocks
        The whole recording; where it is not calibrated or has no sound, nothing is added.
    segments : sequence of Segment

    Returns
    -------
    list of Segment

    Raises
    ------
    ParameterError
        The extra ``sound-quality`` is not installed.
    """
    return [_with_loudness(blocks, segment) for segment in segments]


def _with_loudness(blocks: RecordingBlocks, segment: Segment) -> Segment:
    track = blocks if segment.channel == "all" else blocks.track(int(segment.channel) - 1)
    row = track.first("pressure")
    first = round(segment.start * track.rate)
    last = min(round(segment.end * track.rate), track.n_samples)
    seconds = (last - first) / track.rate
    if row is None or not track.calibrated or not SHORTEST <= seconds <= _LONGEST:
        return segment
    sound = track.read(first, last)[row]
    at_rate = resampled(sound - sound.mean(), track.rate, SOUND_QUALITY_RATE)
    return replace(segment, loudness_n5=loudness_n5(at_rate, SOUND_QUALITY_RATE))
