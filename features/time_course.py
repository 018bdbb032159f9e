"""How a noise changes from one moment to the next: its bands, its level, its strongest tone.

A squeal is one tone that stays, a bark or a crow is tones that move, a creak is neither: that is
seen in short segments, not in an average over the block. The segments last 64 ms, of which the
fastest slip sequence still shows several and in which a gliding tone is still narrow. Each counts
by its energy, so that pauses between strokes say nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.periodicity import track_periods
from features.spectra import segment_powers

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TimeCourse", "time_course"]

_SEGMENT = 0.064
"""Length of a segment [s]."""

_LINE_BINS = 2
"""Bins on either side of a maximum that belong to it: the Hann window's main lobe."""

_SAME_TONE = 1.0 / 12.0
"""A tone that moves less than this between segments is the same tone [octave]."""

_VOICED = 0.5
"""Autocorrelation from which a segment counts as having a fundamental."""

_LOWEST_FUNDAMENTAL = 60.0
"""Lowest fundamental that 64 ms tell apart from noise [Hz]."""

_QUIETEST_DB = -60.0
"""Segments count as at least this loud, relative to the loudest [dB]."""

_BANDS_PER_OCTAVE = 3
_NORMAL_CONSISTENT = 1.4826


@dataclass(frozen=True)
class TimeCourse:
    """Changes over the length of a signal; NaN where it holds a single segment.

    Parameters
    ----------
    tonality : float
        Share of the power in the strongest line of each segment, mean by energy, 0 to 1.
    continuity : float
        The same, counting only tones that are still there (within a semitone) in the next segment.
    fundamental_wander : float
        Robust standard deviation of the fundamental [octave]; NaN unless two segments have one.
    flux : float
        Share of the power that changes its one-third-octave band between neighbouring segments.
    level_variation : float
        Standard deviation of the segments' levels [dB].
    """

    tonality: float
    continuity: float
    fundamental_wander: float
    flux: float
    level_variation: float


def time_course(x: NDArray[np.float64], rate: float, *, low: float, high: float) -> TimeCourse:
    """Describe how a signal changes between two frequencies.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Mean removed, not silent.
    rate : float
        Sampling rate [Hz].
    low, high : float
        Limits of the band [Hz].

    Returns
    -------
    TimeCourse

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(16000) / 16e3
    >>> steady = time_course(np.sin(2 * np.pi * 1000 * t), 16e3, low=150.0, high=7e3)
    >>> round(steady.tonality, 2), round(steady.continuity, 2), round(steady.level_variation, 2)
    (1.0, 1.0, 0.0)
    """
    length = max(16, 2 * round(0.5 * _SEGMENT * rate))
    power, _ = segment_powers(x, min(length, x.size), transform_length=length)
    spacing = rate / length
    first, last = math.ceil(low / spacing), min(math.floor(high / spacing), power.shape[1] - 1)
    power[:, :first] = 0.0
    power[:, last + 1 :] = 0.0
    energy = power.sum(axis=1)
    whole = float(energy.sum())
    if not whole > 0.0:
        return TimeCourse(0.0, math.nan, math.nan, math.nan, math.nan)
    weight = energy / whole
    tone, share = _strongest_tones(power, energy)
    tonality = float(weight @ share)
    wander = _wander(power, spacing, low, weight)
    if energy.size < 2:
        return TimeCourse(tonality, math.nan, wander, math.nan, math.nan)
    pairs = np.sqrt(weight[1:] * weight[:-1])
    pairs = pairs / max(float(pairs.sum()), np.finfo(float).tiny)
    stays = np.abs(np.diff(np.log2(tone))) < _SAME_TONE
    continuity = float(pairs @ (np.sqrt(share[1:] * share[:-1]) * stays))
    edges = _band_edges(first, last)
    floor = max(float(energy.max()) * 1e-12, np.finfo(float).tiny)
    bands = np.add.reduceat(power[:, : last + 1], edges, axis=1)
    bands = bands / np.maximum(energy, floor)[:, np.newaxis]
    flux = float(pairs @ (0.5 * np.abs(np.diff(bands, axis=0)).sum(axis=1)))
    quietest = float(energy.max()) * 10.0 ** (0.1 * _QUIETEST_DB)
    level_variation = float(np.std(10.0 * np.log10(np.maximum(energy, quietest))))
    return TimeCourse(tonality, continuity, wander, flux, level_variation)


def _strongest_tones(
    power: NDArray[np.float64], energy: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position of each segment's strongest line in bins, and its share of the segment's power."""
    top = np.clip(power.argmax(axis=1), _LINE_BINS, power.shape[1] - 1 - _LINE_BINS)
    bins = top[:, np.newaxis] + np.arange(-_LINE_BINS, _LINE_BINS + 1)
    lobe = np.take_along_axis(power, bins, axis=1)
    sums = lobe.sum(axis=1)
    safe = np.maximum(sums, np.finfo(float).tiny)
    tone = np.where(sums > 0.0, (lobe * bins).sum(axis=1) / safe, top)
    return tone, sums / np.maximum(energy, safe)


def _wander(
    power: NDArray[np.float64], spacing: float, low: float, weight: NDArray[np.float64]
) -> float:
    """Robust deviation of the segments' fundamentals about their median [octave]."""
    frequency, strength = track_periods(
        power, spacing, lowest=max(_LOWEST_FUNDAMENTAL, 3.0 * spacing, 0.25 * low)
    )
    voiced = (strength >= _VOICED) & (weight > 0.1 * weight.max())
    if np.count_nonzero(voiced) < 2:
        return math.nan
    pitch, weight = np.log2(frequency[voiced]), weight[voiced]
    return _NORMAL_CONSISTENT * _weighted_median(
        np.abs(pitch - _weighted_median(pitch, weight)), weight
    )


def _weighted_median(values: NDArray[np.float64], weight: NDArray[np.float64]) -> float:
    order = np.argsort(values)
    reached = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(reached, 0.5 * reached[-1])]])


def _band_edges(first: int, last: int) -> NDArray[np.intp]:
    """First bin of each one-third octave from `first` to `last`, at least one bin each."""
    first = max(first, 1)
    number = math.ceil(_BANDS_PER_OCTAVE * math.log2(max(last, first + 1) / first))
    edges = first * 2.0 ** (np.arange(max(number, 1)) / _BANDS_PER_OCTAVE)
    return np.unique(edges.astype(np.intp))
