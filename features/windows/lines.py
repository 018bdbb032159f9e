# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Power spectra of windows and their lines: number, strength and harmonic relations.

A bin has 3.9 Hz, which separates the harmonics of a squawk of 100 Hz, and three overlapping spectra
of a quarter of a second are added. A line is 10 dB above its surroundings and above the saddles
beside it, as in `features.kernels.lines`. Sums over many bins are in the order of the compiler,
which is several times as fast.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import (
    OCTAVES,
    ordered_sum,
    padded_rows,
    power_of,
    prominent_maxima,
)
from models.compilation import COMPILED, PART

_SEGMENT = 4000
_LENGTH = 4096
SEGMENT_HOP = 2000
"""Hop of the long spectra in samples."""

SPACING = 16_000 / _LENGTH
"""Spacing of the bins [Hz]."""

FIRST = 38
"""First described bin: 148 Hz."""

LOBE = 3
"""Bins of a line on either side."""

BLOCK = 32
"""Bins per block, whose median is the floor."""

_LEAST = np.float32(1e-20)

_KILOHERTZ = (256, 512, 1024, 1 << 20)
"""Bins of 1, 2 and 4 kHz."""


_MOST_LINES = 40

_RANGE_DB = 30.0
"""Range of lines below the strongest bin [dB]."""

_STRONG_DB = 18.0
"""Range of strong lines below the strongest bin [dB]."""

_STANDS_DB = 10.0
"""Minimum level of a line above the floor and above the saddle to the next line [dB]."""


def segments_of(sound: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return segments of sounds of a quarter of a second that overlap by half.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,) or (n_sounds, n)
        Samples at `features.windows.blocks.RATE` [any unit]; they are padded with zeros.

    Returns
    -------
    ndarray of float32, shape (n_segments, 4000)
        Segments of one sound after the other [unit of the sound].

    Examples
    --------
    >>> segments_of(np.zeros(8000, dtype=np.float32)).shape
    (3, 4000)
    """
    n = sound.shape[-1]
    count = max(1, -(-(n - SEGMENT_HOP) // SEGMENT_HOP))
    if lacking := max(0, (count - 1) * SEGMENT_HOP + _SEGMENT - n):
        sound = np.concatenate([sound, np.zeros((*sound.shape[:-1], lacking), np.float32)], axis=-1)
    segments = np.lib.stride_tricks.sliding_window_view(sound, _SEGMENT, axis=-1)
    return segments[..., ::SEGMENT_HOP, :][..., :count, :].reshape(-1, _SEGMENT)


_WINDOW = np.hanning(_SEGMENT + 2)[1:-1].astype(np.float32)


class Lines:
    """Features of the spectra and lines of windows, for `features.table`.

    Parameters
    ----------
    segments : ndarray of float32, shape (n_segments, 4000)
        Segments from `segments_of` [any unit].
    at : ndarray of int, shape (n_windows, n)
        Segments of each window, whose power spectra are added.
    limit : float
        Upper frequency limit of lines [Hz]; at least 273 Hz.

    Examples
    --------
    >>> time = np.arange(8000) / 16e3
    >>> sound = np.sin(2 * np.pi * 700 * time) + 0.5 * np.sin(2 * np.pi * 1400 * time)
    >>> lines = Lines(segments_of(sound.astype(np.float32)), np.array([[0, 1, 2]]), 7000.0)
    >>> int(lines.count[0]), round(1000.0 * 2.0 ** float(lines.frequency[0]))
    (2, 700)
    """

    def __init__(self, segments: NDArray[np.float32], at: NDArray[np.int64], limit: float) -> None:
        needed, row = np.unique(at, return_inverse=True)
        spectra = power_of(fft.rfft(segments[needed] * _WINDOW, n=_LENGTH, axis=1))
        end = max(FIRST + BLOCK, min(int(limit / SPACING) + 1, spectra.shape[1] - 2))
        power = np.full((len(at), max(end, _KILOHERTZ[0]) + 2), _LEAST, dtype=np.float32)
        described = slice(FIRST - 2, end + 2)
        for rows in row.reshape(at.shape).T:
            power[:, described] += spectra[rows, described]
        level = np.empty_like(power)
        np.log10(power[:, described], out=level[:, described])
        level[:, described] *= 10.0
        self.power, self.level, self.end = power, level, end
        sums = np.zeros((9, len(at)), dtype=np.float32)
        bins = np.empty((3, len(at)), dtype=np.int64)
        _measure(power, end, level, sums, bins)
        self.total, line, below, self.flatness, self.slope, *octaves = sums
        self.line_share = line / self.total
        self.below_line = _decibel(below / line, 1e-5)
        above = (self.total - (line + below)) / line.astype(np.float64)
        self.above_line = _decibel(above, 1e-5)
        # Levels above 1, 2 and 4 kHz.
        self.octaves_above = [_decibel(sum(octaves[i:]) / self.total, 1e-6) for i in (1, 2, 3)]
        self.top, low, high = bins
        self.width = (high - low) * SPACING
        self._describe_lines()

    def _describe_lines(self) -> None:
        """Compute the features of the lines and their harmonics."""
        level, top, end, n = self.level, self.top, self.end, len(self.level)
        windows = np.arange(n)
        left, middle, right = (level[windows, top + i] for i in (-1, 0, 1))
        bend = left - 2.0 * middle.astype(np.float64) + right
        shift = 0.5 * (left - right) / np.where(bend < -1e-6, bend, np.inf)
        place = np.asarray(top + np.clip(shift, -0.5, 0.5), dtype=np.float64)
        self.frequency = OCTAVES * np.log(place * (SPACING / 1000.0))
        floor = _floor(level, end)
        self.prominence = middle - floor[windows, (top - FIRST) // BLOCK]
        row, at = prominent_maxima(level, FIRST, end, _STANDS_DB, pointed=True)
        height = level[row, at]
        line = height.astype(np.float64) >= middle[row].astype(np.float64) - _RANGE_DB
        line &= height - floor[row, (at - FIRST) // BLOCK] >= _STANDS_DB
        row, at = row[line], at[line]
        count = np.bincount(row, minlength=n)
        line = np.arange(row.size) - (np.cumsum(count) - count)[row] < _MOST_LINES
        row, at = row[line], at[line]
        self.count = count = np.bincount(row, minlength=n)
        height = level[row, at]
        strong = height.astype(np.float64) >= middle[row].astype(np.float64) - _STRONG_DB
        self.strong_count = np.bincount(row[strong], minlength=n)
        sums = np.zeros(n, dtype=np.float32)
        _add_lines(self.power, row, at, end, sums)
        self.share = np.minimum(1.0, sums / self.total)
        bins, heights = padded_rows(at, row, count, 0), padded_rows(height, row, count, -200.0)
        strongest = np.sort(
            np.pad(heights, ((0, 0), (2, 0)), constant_values=-200.0).astype(np.float64), axis=1
        )[:, :-4:-1].T
        # Levels of the second and third line, re the first.
        self.next_levels = np.where(
            count > 0, np.maximum(strongest[1:] - strongest[0], -_RANGE_DB), -_RANGE_DB
        )
        lowest = np.where(count > 0, bins[:, 0], top)
        self.lowest = np.where(count > 0, OCTAVES * np.log(lowest / top), np.nan)
        self.spacing_spread = _spacing_spread(bins, count)
        self.clearest = np.empty(n, dtype=np.float32)
        clearest, self.clear_bins = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
        _find_clearest(level, floor, end, self.clearest, clearest, self.clear_bins)
        self.clearest_frequency = OCTAVES * np.log(clearest * (SPACING / 1000.0))
        self._describe_harmonics(bins, heights - middle[:, None], place)

    def _describe_harmonics(
        self, at: NDArray[np.int64], height: NDArray[np.float32], place: NDArray[np.float64]
    ) -> None:
        """Compute the fundamental whose multiples contain most of the power in lines.

        Lines are given by bin and height [dB re the strongest bin]; `place` is the interpolated
        bin of the strongest maximum.
        """
        n = len(at)
        base = place[:, None] / _DIVISORS
        ratio = at[:, None, :] / base[:, :, None]
        order = np.rint(ratio)
        off = np.abs(ratio - order)
        line = np.arange(at.shape[1]) < self.count[:, None]
        weight = np.where(line, 10.0 ** (0.1 * height.astype(np.float64)), 0.0)[:, None, :]
        fits = (order >= 1.0) & (off * base[:, :, None] <= (1.5 + 0.006 * at)[:, None, :])
        fits &= line[:, None, :]
        value = ordered_sum(np.where(fits, weight, 0.0), axis=2) * _LOWER**_DIVISORS
        value[base * SPACING < _LOWEST] = 0.0
        rows = np.flatnonzero(value.max(axis=1) > 0.0)
        best = value[rows].argmax(axis=1)
        fundamental, number = base[rows, best], fits[rows, best].sum(axis=1)
        off = np.where(fits[rows, best], off[rows, best] / np.maximum(order[rows, best], 1.0), 0.0)
        inside, bins = _in_multiples(self.power[rows], fundamental, self.end)
        share = np.minimum(1.0, inside / self.total[rows])
        harmonics = np.full((5, n), np.nan)
        harmonics[:, rows] = (
            OCTAVES * np.log(fundamental * (SPACING / 100.0)),
            share,
            number,
            ordered_sum(off, axis=1) / np.maximum(number, 1),
            share.astype(np.float32) - bins / (self.end - FIRST),
        )
        (
            self.fundamental, self.harmonic_share, self.harmonic_count, self.inharmonicity,
            self.harmonic_gain,
        ) = harmonics  # fmt: skip


def _decibel(share: NDArray[np.floating], least: float) -> NDArray[np.float64]:
    return 10.0 * np.log10(np.maximum(share.astype(np.float64), least))


@njit(fastmath={"reassoc", "contract", "nsz", "nnan"}, cache=True, **PART)
def _sum_and_highest(p, end):
    total, highest = np.float32(0.0), np.float32(0.0)
    for k in range(FIRST, end):
        total += p[k]
        highest = max(highest, p[k])
    return total, highest


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _measure(power, end, level, sums, bins) -> None:
    n = end - FIRST
    n_blocks = -(-n // BLOCK)
    for w in range(power.shape[0]):
        p = power[w]
        total, highest = _sum_and_highest(p, end)
        top = FIRST
        while top < end - 1 and p[top] != highest:
            top += 1
        for k in range(FIRST, _KILOHERTZ[0]):
            sums[5, w] += p[k]
        for i in range(3):
            for k in range(_KILOHERTZ[i], max(_KILOHERTZ[i], min(end, _KILOHERTZ[i + 1]))):
                sums[6 + i, w] += p[k]
        # Flatness, and a linear fit of the mean levels of blocks over octaves.
        logarithms = np.float32(0.0)
        sx, sy, sxx, sxy = 0.0, 0.0, 0.0, 0.0
        for b in range(n_blocks):
            begin, stop = FIRST + b * BLOCK, min(FIRST + (b + 1) * BLOCK, end)
            if stop - begin < BLOCK // 2:
                continue
            mean = np.float32(0.0)
            for k in range(begin, stop):
                mean += level[w, k]
            logarithms += mean
            mean /= stop - begin
            x = OCTAVES * np.log((begin + stop) * 0.5)
            sx += x
            sy += mean
            sxx += x * x
            sxy += x * mean
        # The strongest line is as wide as a friction tone wanders.
        reach = LOBE + int(0.005 * top)
        line = np.float32(0.0)
        for k in range(max(FIRST, top - reach), min(end, top + reach + 1)):
            line += p[k]
        below = np.float32(0.0)
        for k in range(FIRST, max(FIRST, top - reach)):
            below += p[k]
        low, high = top, top
        while low > FIRST and p[low] > 0.5 * p[top]:
            low -= 1
        while high < end - 1 and p[high] > 0.5 * p[top]:
            high += 1
        sums[0, w], sums[1, w], sums[2, w] = total, line, below
        sums[3, w] = logarithms / n - 10.0 * np.log10(total / n)
        sums[4, w] = (n_blocks * sxy - sx * sy) / (n_blocks * sxx - sx * sx)
        bins[0, w], bins[1, w], bins[2, w] = top, low, high


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _add_lines(power, row, at, end, sums) -> None:
    for i in range(row.size):
        p = power[row[i]]
        lines = sums[row[i]]
        for k in range(max(FIRST, at[i] - LOBE), min(end, at[i] + LOBE + 1)):
            lines += p[k]
        sums[row[i]] = lines


@njit(cache=True, **COMPILED)
def _find_clearest(level, floor, end, stands, at, count) -> None:
    """Fill in the line that is highest above the floor, which may not be the strongest.

    The floor is interpolated between the centres of blocks.
    """
    blocks = floor.shape[1]
    for w in range(level.shape[0]):
        best, where, clear = np.float32(-np.inf), FIRST, 0
        for b in range(-1, blocks):  # between the centres of two blocks
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
    """Return the median level of each block; a short last block has that of the block before."""
    half, rest = BLOCK // 2, (end - FIRST) % BLOCK  # one whole block at least
    blocks = level[:, FIRST : end - rest].reshape(len(level), -1, BLOCK)
    middle = np.sort(blocks, axis=2)  # faster than a partition of so few
    floor = (middle[:, :, half - 1] + middle[:, :, half]) / np.float32(2.0)
    if rest >= half:
        last = np.median(level[:, end - rest : end], axis=1, keepdims=True)
    else:
        last = floor[:, -1:]
    return np.concatenate([floor, last], axis=1)


def _spacing_spread(at: NDArray[np.int64], count: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the relative mean deviation of the spacings of at least three lines."""
    out, several = np.full(count.size, np.nan), count > 2
    at, n = at[several], count[several, None] - 1
    mean = (np.take_along_axis(at, n, axis=1) - at[:, :1]) / n
    off = np.abs(np.diff(at, axis=1) - mean)
    off = np.where(np.arange(at.shape[1] - 1) < n, off, 0.0)
    out[several] = ordered_sum(off, axis=1) / n[:, 0] / mean[:, 0]
    return out


_DIVISORS = np.arange(1, 9)
"""Possible harmonic numbers of the strongest line."""

_LOWEST = 40.0
"""Minimum fundamental [Hz]."""

_LOWER = 0.93
"""Factor per divisor, because a lower fundamental has more multiples [-]."""


def _in_multiples(
    power: NDArray[np.float32], fundamental: NDArray[np.float64], end: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return power and number of the bins near the multiples of each fundamental [bins]."""
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
