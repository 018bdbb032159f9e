# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Lines of a window's spectrum: how many, how strong, and whether they are harmonics of one.

What stands 10 dB above its surroundings and falls to either side before the next rises is a line,
as in `features.kernels.lines`.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from features.windows.arithmetic import OCTAVES, ordered_sum, padded_rows, prominent_maxima
from features.windows.declared import TONE_FEATURES
from features.windows.spectra import (
    BLOCK,
    FIRST,
    LOBE,
    SPACING,
    WindowSpectra,
    line_power,
    window_spectra,
)
from models.compilation import COMPILED

_MOST_LINES = 40

_RANGE_DB = 30.0
"""Weaker lines than this below the strongest bin are none [dB]."""

_STRONG_DB = 18.0
"""Stronger ones than this below it are counted as strong [dB]."""

_STANDS_DB = 10.0
"""What a line stands above the floor, and above the saddle to the next [dB]."""

TONE_NAMES = tuple(feature.name for feature in TONE_FEATURES)
"""Of a window, in the order of `tone_features`."""


def tone_features(
    segments: NDArray[np.float32],
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    limit: float,
) -> NDArray[np.float32]:
    """Describe the lines of windows.

    Parameters
    ----------
    segments : ndarray of float32, shape (n_segments, 4000)
        As `features.windows.spectra.segments_of` gives them.
    first, last : ndarray of int, shape (n_windows,)
        Each window averages the spectra of the segments from `first` up to `last`.
    limit : float
        Frequency up to which lines are sought [Hz].

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `TONE_NAMES`, each in its declared [unit].

    Examples
    --------
    >>> from features.windows.spectra import segments_of
    >>> time = np.arange(8000) / 16e3
    >>> sound = np.sin(2 * np.pi * 700 * time) + 0.5 * np.sin(2 * np.pi * 1400 * time)
    >>> segments = segments_of(sound.astype(np.float32))
    >>> found = tone_features(segments, np.array([0]), np.array([3]), 7000.0)[0]
    >>> dict(zip(TONE_NAMES, found.round(1).tolist()))["line_count"]
    2.0
    """
    windows = window_spectra(segments, first, last, limit)
    level, top = windows.level, windows.top
    rows = np.arange(len(level))
    left, middle, right = (level[rows, top + i] for i in (-1, 0, 1))
    bend = left - 2.0 * middle.astype(np.float64) + right
    shift = 0.5 * (left - right) / np.where(bend < -1e-6, bend, np.inf)
    place = np.asarray(top + np.clip(shift, -0.5, 0.5), dtype=np.float64)
    found = {
        "line_frequency": OCTAVES * np.log(place * (SPACING / 1000.0)),
        "line_share": windows.line / windows.total,
        "line_width": (windows.high - windows.low) * SPACING,
        **_shape(windows),
        **_lines(windows, place),
    }
    return np.stack([found[name] for name in TONE_NAMES], axis=1).astype(np.float32)


def _decibel(share: NDArray[np.floating], least: float) -> NDArray[np.float64]:
    return np.asarray(10.0 * np.log10(np.maximum(share.astype(np.float64), least)))


def _shape(spectra: WindowSpectra) -> dict[str, NDArray[np.floating]]:
    """Describe how the power is spread over frequency."""
    total, line, below = spectra.total, spectra.line, spectra.below
    _, middle, high, highest = spectra.octaves
    above = (total - (line + below)).astype(np.float64)
    return {
        "below_line": _decibel(below / line, 1e-5),
        "above_line": _decibel(above / line, 1e-5),
        "spectral_flatness": spectra.flatness,
        "spectral_slope": spectra.slope,
        "above_1": _decibel((middle + high + highest) / total, 1e-6),
        "above_2": _decibel((high + highest) / total, 1e-6),
        "above_4": _decibel(highest / total, 1e-6),
    }


def _clearest(
    level: NDArray[np.float32], floor: NDArray[np.float32], end: int
) -> dict[str, NDArray[np.floating]]:
    """Describe the line that stands highest above the floor about it, be it the strongest or not.

    The floor runs straight from the middle of each block to that of the next.
    """
    n = len(level)
    stands, at = np.empty(n, dtype=np.float32), np.empty(n, dtype=np.int64)
    count = np.empty(n, dtype=np.int64)
    _find_clearest(level, floor, end, stands, at, count)
    return {
        "clearest_line": stands,
        "clearest_frequency": OCTAVES * np.log(at * (SPACING / 1000.0)),
        "clear_bins": count,
    }


@njit(cache=True, **COMPILED)
def _find_clearest(level, floor, end, stands, at, count) -> None:
    blocks = floor.shape[1]
    for w in range(level.shape[0]):
        best, where, clear = np.float32(-np.inf), FIRST, 0
        for b in range(-1, blocks):  # from the middle of a block to that of the next
            low, high = floor[w, max(b, 0)], floor[w, min(b + 1, blocks - 1)]
            step = (high - low) / np.float32(BLOCK)
            begin = FIRST + b * BLOCK + BLOCK // 2
            for k in range(max(begin, FIRST), min(begin + BLOCK, end)):
                above = level[w, k] - low - step * np.float32(k - begin)
                if above > _STANDS_DB:
                    clear += 1
                if above > best:
                    best, where = above, k
        stands[w], at[w], count[w] = best, where, clear


def _floor(level: NDArray[np.float32], end: int) -> NDArray[np.float32]:
    """Return the median level of each block; a short last one takes that before it."""
    half, rest = BLOCK // 2, (end - FIRST) % BLOCK  # there is a whole one at least
    blocks = level[:, FIRST : end - rest].reshape(len(level), -1, BLOCK)
    middle = np.sort(blocks, axis=2)  # of so few, faster than a partition
    floor = (middle[:, :, half - 1] + middle[:, :, half]) / np.float32(2.0)
    if rest >= half:
        last = np.median(level[:, end - rest : end], axis=1, keepdims=True)
    else:
        last = floor[:, -1:]
    return np.concatenate([floor, last], axis=1)


def _lines(
    spectra: WindowSpectra, place: NDArray[np.float64]
) -> dict[str, NDArray[np.floating] | NDArray[np.int64]]:
    """Describe lines and what they are harmonics of; the strongest bin lies at `place`."""
    level, top, n = spectra.level, spectra.top, len(spectra.level)
    floor = _floor(level, spectra.end)
    strongest = level[np.arange(n), top]
    row, at = prominent_maxima(level, FIRST, np.full(n, spectra.end), _STANDS_DB, pointed=True)
    height = level[row, at]
    kept = height.astype(np.float64) >= strongest[row].astype(np.float64) - _RANGE_DB
    kept &= height - floor[row, (at - FIRST) // BLOCK] >= _STANDS_DB
    row, at = row[kept], at[kept]
    count = np.bincount(row, minlength=n)
    kept = np.arange(row.size) - (np.cumsum(count) - count)[row] < _MOST_LINES
    row, at = row[kept], at[kept]
    count = np.bincount(row, minlength=n)
    height = level[row, at]
    strong = height.astype(np.float64) >= strongest[row].astype(np.float64) - _STRONG_DB
    power = line_power(spectra, row, at)
    bins, some = padded_rows(at, row, count, 0), count > 0
    heights = padded_rows(height, row, count, -200.0)
    first, second, third = np.sort(
        np.pad(heights, ((0, 0), (2, 0)), constant_values=-200.0).astype(np.float64), axis=1
    )[:, :-4:-1].T
    lowest = np.where(some, bins[:, 0], top)
    return {
        "line_count": count,
        "strong_line_count": np.bincount(row[strong], minlength=n),
        "line_prominence": strongest - floor[np.arange(n), (top - FIRST) // BLOCK],
        "lines_share": np.minimum(1.0, power / spectra.total),
        "second_line": np.where(some, np.maximum(second - first, -_RANGE_DB), -_RANGE_DB),
        "third_line": np.where(some, np.maximum(third - first, -_RANGE_DB), -_RANGE_DB),
        "lowest_line": np.where(some, OCTAVES * np.log(lowest / top), np.nan),
        "line_spacing_spread": _spacing_spread(bins, count),
        **_clearest(level, floor, spectra.end),
        **_harmonics(spectra, bins, heights - strongest[:, None], count, place),
    }


def _spacing_spread(at: NDArray[np.int64], count: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the mean deviation of the distances between at least three lines, over their mean."""
    out, several = np.full(count.size, np.nan), count > 2
    at, n = at[several], count[several, None] - 1
    mean = (np.take_along_axis(at, n, axis=1) - at[:, :1]) / n
    off = np.abs(np.diff(at, axis=1) - mean)
    off = np.where(np.arange(at.shape[1] - 1) < n, off, 0.0)
    out[several] = ordered_sum(off, axis=1) / n[:, 0] / mean[:, 0]
    return out


_DIVISORS = np.arange(1, 9)
"""The strongest bin is one of these harmonics."""

_LOWEST = 40.0
"""Fundamental [Hz]."""

_LOWER = 0.93
"""A lower fundamental has more multiples, so it must explain notably more [ratio]."""


def _harmonics(
    spectra: WindowSpectra,
    at: NDArray[np.int64],
    height: NDArray[np.float32],
    count: NDArray[np.int64],
    place: NDArray[np.float64],
) -> dict[str, NDArray[np.float64]]:
    """Describe the fundamental whose multiples hold most of the power in lines.

    Lines are given by bin and height [dB re the strongest bin], as many as `count` a window;
    `place` is that of the strongest bin's maximum [bins].
    """
    base = place[:, None] / _DIVISORS
    ratio = at[:, None, :] / base[:, :, None]
    order = np.rint(ratio)
    off = np.abs(ratio - order)
    line = np.arange(at.shape[1]) < count[:, None]
    weight = np.where(line, 10.0 ** (0.1 * height.astype(np.float64)), 0.0)[:, None, :]
    fits = (order >= 1.0) & (off * base[:, :, None] <= (1.5 + 0.006 * at)[:, None, :])
    fits &= line[:, None, :]
    value = ordered_sum(np.where(fits, weight, 0.0), axis=2) * _LOWER**_DIVISORS
    value[base * SPACING < _LOWEST] = 0.0
    best = value.argmax(axis=1)
    rows = np.flatnonzero(value.max(axis=1) > 0.0)
    best = best[rows]
    fundamental, number = base[rows, best], fits[rows, best].sum(axis=1)
    off = np.where(fits[rows, best], off[rows, best] / np.maximum(order[rows, best], 1.0), 0.0)
    inside, bins = _in_multiples(spectra.power[rows], fundamental, spectra.end)
    share = np.minimum(1.0, inside / spectra.total[rows])
    expected = bins / (spectra.end - FIRST)
    found = {
        "fundamental": OCTAVES * np.log(fundamental * (SPACING / 100.0)),
        "harmonic_share": share,
        "harmonic_count": number,
        "inharmonicity": ordered_sum(off, axis=1) / np.maximum(number, 1),
        "harmonic_gain": share.astype(np.float32) - expected,
    }
    out = {name: np.full(count.size, np.nan) for name in found}
    for name, values in found.items():
        out[name][rows] = values
    return out


def _in_multiples(
    power: NDArray[np.float32], fundamental: NDArray[np.float64], end: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return power and number of the bins about the multiples of each fundamental [bins]."""
    most = int(end / fundamental.min(initial=end))
    multiple = np.arange(1, most + 1) * fundamental[:, None]
    centre = np.rint(multiple).astype(np.int64)
    counted = (multiple < end - LOBE) & (centre - LOBE >= FIRST)
    aside = np.arange(-LOBE, LOBE + 1)
    reach = np.minimum(LOBE, (0.4 * fundamental).astype(np.int64))
    inside = counted[:, :, None] & (np.abs(aside) <= reach[:, None, None])
    bins = np.where(inside, centre[:, :, None] + aside, 0).reshape(-1, most * aside.size)
    inside = inside.reshape(bins.shape)
    terms = np.where(inside, np.take_along_axis(power, bins, axis=1), 0.0).astype(np.float64)
    return ordered_sum(terms, axis=1), inside.sum(axis=1)
