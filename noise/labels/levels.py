"""Levels of any part of a recording, and of each of its segments over the background.

Unweighted levels are put together from sums over cells of 10 ms, while the recording is read once.
A-weighted ones are those that `features.kernels.levels` measures of the same samples, the loudness
N5 that of the library that the field keeps for it.

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

from features.kernels.levels import weighted_levels
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


class CellLevels:
    """Mean, peak and power of a signal in cells of 10 ms, put together for any run of cells.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    n_samples : int
        Of the whole signal; the last cell is what is left, at least half a cell where there are
        several.

    Examples
    --------
    >>> levels = CellLevels(100.0, 100)
    >>> levels.add(0, 100, np.array([1.0, -1.0] * 50), 0)
    >>> levels.rms_db(0, 100)
    0.0
    """

    def __init__(self, rate: float, n_samples: int) -> None:
        count = max(1, round(n_samples * CELL_RATE / rate))
        # Fewer samples than cells: rates of less than 100 Hz.
        edges = np.round(np.arange(count + 1) * (rate / CELL_RATE)).astype(np.int64)
        edges[-1] = n_samples
        self.edges: NDArray[np.int64] = np.unique(np.minimum(edges, n_samples))
        self._mean = np.zeros(self.count)
        self._peak = np.zeros(self.count)
        self._square = np.zeros(self.count)

    @property
    def count(self) -> int:
        """Number of cells."""
        return self.edges.size - 1

    def add(self, begin: int, end: int, samples: NDArray[np.float64], start: int) -> None:
        """Sum up the cells that begin from sample `begin` up to `end`.

        Parameters
        ----------
        begin, end : int
            Samples of the whole signal.
        samples : ndarray, shape (n,)
            What is at hand [unit of the signal], from sample `start` on: the cells have to end in
            it.
        start : int
        """
        first, last = np.searchsorted(self.edges[:-1], (begin, end)).tolist()
        if first == last:
            return
        edges = self.edges[first : last + 1] - start
        sizes, starts = np.diff(edges), edges[:-1] - edges[0]
        part = samples[edges[0] : edges[-1]]
        # Shares of the peak are squared: those of the values themselves may overflow.
        mean = np.add.reduceat(part, starts) / sizes
        part = part - np.repeat(mean, sizes)
        peak = np.maximum.reduceat(np.abs(part), starts)
        part /= np.repeat(np.where(peak > 0.0, peak, 1.0), sizes)
        self._mean[first:last], self._peak[first:last] = mean, peak
        self._square[first:last] = np.add.reduceat(np.square(part, out=part), starts)

    def rms_db(self, first: int, last: int) -> float | None:
        """Root mean square about the mean of cells `first` up to `last` [dB re the unit].

        ``None`` where nothing varies.
        """
        sizes = np.diff(self.edges[first : last + 1])
        n = int(sizes.sum())
        means = self._mean[first:last]
        middle = float(means @ sizes) / n
        offset = np.abs(means - middle)
        peak = max(float(self._peak[first:last].max()), float(offset.max()))
        if not peak > 0.0:
            return None
        square = self._square[first:last] * (self._peak[first:last] / peak) ** 2
        total = float(np.sum(square + sizes * (offset / peak) ** 2))
        return 20.0 * math.log10(peak) + 10.0 * math.log10(total / n) if total > 0.0 else None


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


def with_weighted_levels(blocks: RecordingBlocks, segments: list[Segment]) -> list[Segment]:
    """Add the A-weighted levels of a track's segments, and their level over the background.

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
    measured = []
    for segment in segments:
        first = round(segment.start * blocks.rate)
        n = min(round(segment.end * blocks.rate), blocks.n_samples) - first

        def read(start: int, end: int, first: int = first) -> NDArray[np.float64]:
            return np.asarray(blocks.read(first + start, first + end)[row])

        measured.append(weighted_levels(read, n, blocks.rate, reference=reference))
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
            level_a=_finite(levels.level_a) if blocks.calibrated else None,
            level_af_max=_finite(levels.level_af_max) if blocks.calibrated else None,
            snr=levels.level_a - background
            if background is not None and levels.level_a > silent
            else None,
        )
        for segment, levels in zip(segments, measured, strict=True)
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
