"""Power spectra of windows and their lines: number, strength and harmonic relations.

A bin has 3.9 Hz, which separates the harmonics of a squawk of 100 Hz, and three overlapping spectra
of a quarter of a second are added. A line is 10 dB above its surroundings and above the saddles
beside it, as in `features.kernels.lines`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import OCTAVES, ordered_sum, power_of, prominent_maxima
from features.windows.blocks import RATE

_SEGMENT = 4000
_LENGTH = 4096
_SEGMENT_HOP = 2000
"""Hop of the long spectra in samples."""

_SPACING = RATE / _LENGTH
"""Spacing of the bins [Hz]."""

_FIRST = 38
"""First described bin: 148 Hz."""

_LOBE = 3
"""Bins of a line on either side."""

_BLOCK = 32
"""Bins per block, whose median is the floor."""

_LEAST = np.float32(1e-20)

_KILOHERTZ = (256, 512, 1024)
"""Bins of 1, 2 and 4 kHz."""

_RANGE_DB = 30.0
"""Range of lines below the strongest bin [dB]."""

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
    count = max(1, -(-(n - _SEGMENT_HOP) // _SEGMENT_HOP))
    if lacking := max(0, (count - 1) * _SEGMENT_HOP + _SEGMENT - n):
        sound = np.concatenate([sound, np.zeros((*sound.shape[:-1], lacking), np.float32)], axis=-1)
    segments = np.lib.stride_tricks.sliding_window_view(sound, _SEGMENT, axis=-1)
    return segments[..., ::_SEGMENT_HOP, :][..., :count, :].reshape(-1, _SEGMENT)


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
        end = max(_FIRST + _BLOCK, min(int(limit / _SPACING) + 1, spectra.shape[1] - 2))
        power = np.full((len(at), end + 2), _LEAST, dtype=np.float32)
        for rows in row.reshape(at.shape).T:
            power += spectra[rows, : end + 2]
        level = np.asarray(10.0 * np.log10(power), dtype=np.float32)
        self._power = np.zeros((len(at), end + 1))
        np.cumsum(power[:, _FIRST:end], axis=1, out=self._power[:, _FIRST + 1 :])
        total, inside = self._power[:, -1], level[:, _FIRST:end]
        self.flatness = inside.mean(axis=1) - 10.0 * np.log10(total / (end - _FIRST))
        self.slope = _slope(inside)
        # Levels above 1, 2 and 4 kHz.
        self.octaves_above = [
            _decibel(1.0 - self._power[:, min(edge, end)] / total) for edge in _KILOHERTZ
        ]
        top, windows = _FIRST + inside.argmax(axis=1), np.arange(len(at))
        # The strongest line is as wide as a friction tone wanders.
        reach = _LOBE + (0.005 * top).astype(np.int64)
        line = self._between(windows, top - reach, top + reach + 1)
        above = total - self._power[windows, np.minimum(top + reach + 1, end)]
        self.line_share, self.above_line = line / total, _decibel(above / line)
        left, middle, right = (level[windows, top + i] for i in (-1, 0, 1))
        bend = left - 2.0 * middle.astype(np.float64) + right
        shift = 0.5 * (left - right) / np.where(bend < -1e-6, bend, np.inf)
        place = np.asarray(top + np.clip(shift, -0.5, 0.5), dtype=np.float64)
        self.frequency = OCTAVES * np.log(place * (_SPACING / 1000.0))
        floor = _floor(level, end)
        self.prominence = middle - floor[windows, (top - _FIRST) // _BLOCK]
        row, at = prominent_maxima(level, _FIRST, end, _STANDS_DB, pointed=True)
        height = level[row, at] - middle[row]
        lines = (height >= -_RANGE_DB) & (
            level[row, at] - floor[row, (at - _FIRST) // _BLOCK] >= _STANDS_DB
        )
        row, at, height = row[lines], at[lines], height[lines]
        self.count = np.bincount(row, minlength=len(windows))
        share = self._between(row, at - _LOBE, at + _LOBE + 1)
        self.share = np.minimum(1.0, np.bincount(row, share, len(windows)) / total)
        self._find_fundamental(row, at, height, place)

    def _between(
        self, row: NDArray[np.int64], first: NDArray[np.int64], last: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return the power of windows in the bins from `first` to before `last`."""
        end = self._power.shape[1] - 1
        low, high = np.clip(first, _FIRST, end), np.clip(last, _FIRST, end)
        return np.asarray(self._power[row, high] - self._power[row, low])

    def _find_fundamental(
        self,
        row: NDArray[np.int64],
        at: NDArray[np.int64],
        height: NDArray[np.float32],
        place: NDArray[np.float64],
    ) -> None:
        """Find the fundamental whose multiples contain most of the power in lines.

        Lines are given by window, bin and height [dB re the strongest bin]; `place` is the
        interpolated bin of the strongest maximum.
        """
        base = place[:, None] / _DIVISORS
        ratio = at[:, None] / base[row]
        order = np.rint(ratio)
        off = np.abs(ratio - order) * base[row]
        fits = (order >= 1.0) & (off <= 1.5 + 0.006 * at[:, None])
        weight = np.where(fits, 10.0 ** (0.1 * height.astype(np.float64))[:, None], 0.0)
        value = np.stack([np.bincount(row, column, len(place)) for column in weight.T], axis=1)
        value = np.where(base * _SPACING < _LOWEST, 0.0, value * _LOWER**_DIVISORS)
        rows = np.flatnonzero(value.max(axis=1) > 0.0)
        fundamental = base[rows, value[rows].argmax(axis=1)]
        end = self._power.shape[1] - 1
        multiples = np.arange(1, int(end / fundamental.min(initial=end)) + 1)
        centre = np.rint(multiples * fundamental[:, None]).astype(np.int64)
        reach = np.minimum(_LOBE, (0.4 * fundamental).astype(np.int64))[:, None]
        counted = (centre >= _FIRST + _LOBE) & (centre < end - _LOBE)
        power = self._between(rows[:, None], centre - reach, centre + reach + 1)
        share = ordered_sum(np.where(counted, power, 0.0), axis=1) / self._power[rows, -1]
        bins = (counted * (2 * reach + 1)).sum(axis=1) / (end - _FIRST)
        self.fundamental, self.harmonic_share, self.harmonic_gain = np.full((3, len(place)), np.nan)
        self.fundamental[rows] = OCTAVES * np.log(fundamental * (_SPACING / 100.0))
        self.harmonic_share[rows] = np.minimum(1.0, share)
        self.harmonic_gain[rows] = np.minimum(1.0, share) - bins


def _decibel(share: NDArray[np.floating]) -> NDArray[np.float64]:
    return np.asarray(10.0 * np.log10(np.maximum(share, 1e-6)))


def _slope(level: NDArray[np.float32]) -> NDArray[np.floating]:
    """Return the slope of the mean levels of blocks over octaves [dB/octave]."""
    count = level.shape[1] // _BLOCK
    means = level[:, : count * _BLOCK].reshape(len(level), count, _BLOCK).mean(axis=2)
    x = OCTAVES * np.log(_FIRST + (np.arange(count) + 0.5) * _BLOCK)
    x -= x.mean()
    return ordered_sum(means * x, axis=1) / max(float(x @ x), 1e-9)


def _floor(level: NDArray[np.float32], end: int) -> NDArray[np.float32]:
    """Return the median level of each block; a short last block has that of the block before."""
    half, rest = _BLOCK // 2, (end - _FIRST) % _BLOCK  # one whole block at least
    blocks = level[:, _FIRST : end - rest].reshape(len(level), -1, _BLOCK)
    middle = np.sort(blocks, axis=2)  # faster than a partition of so few
    floor = (middle[:, :, half - 1] + middle[:, :, half]) / np.float32(2.0)
    if rest >= half:
        last = np.median(level[:, end - rest : end], axis=1, keepdims=True)
    else:
        last = floor[:, -1:]
    return np.concatenate([floor, last], axis=1)


_DIVISORS = np.arange(1, 9)
"""Possible harmonic numbers of the strongest line."""

_LOWEST = 40.0
"""Minimum fundamental [Hz]."""

_LOWER = 0.93
"""Factor per divisor, because a lower fundamental has more multiples [-]."""
