# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Power spectra of windows, fine enough that a squawk of 100 Hz shows each of its harmonics.

A bin is 3.9 Hz wide and three overlapping spectra of a quarter of a second are added up. Sums over
many bins are left to the compiler's order, which is several times as fast.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import OCTAVES
from models.compilation import COMPILED, PART

_SEGMENT = 4000
_LENGTH = 4096
SEGMENT_HOP = 2000
"""Samples from one long spectrum to the next."""

SPACING = 16_000 / _LENGTH
"""Of the bins [Hz]."""

FIRST = 38
"""Bin from which spectra are described: 148 Hz."""

LOBE = 3
"""Bins on either side of a line that are its own."""

BLOCK = 32
"""Bins whose median is the floor of all of them."""

_LEAST = np.float32(1e-20)

_KILOHERTZ = (256, 512, 1024, 1 << 20)
"""Bins of 1, 2 and 4 kHz."""


@dataclass(frozen=True, eq=False)
class WindowSpectra:
    """Spectra of windows from 148 Hz on, and what is added up over their bins.

    Parameters
    ----------
    power : ndarray of float32, shape (n_windows, n_bins)
        [share of the block's scale squared]
    level : ndarray of float32, shape (n_windows, n_bins)
        The same [dB], from two bins before `FIRST` to two beyond the last.
    end : int
        The first bin that does not count.
    total, line, below : ndarray of float32, shape (n_windows,)
        Power of all, about the strongest bin, and below that [share of the block's scale squared].
    flatness : ndarray of float32, shape (n_windows,)
        Geometric over arithmetic mean of the power [dB].
    slope : ndarray of float32, shape (n_windows,)
        [dB an octave]
    octaves : ndarray of float32, shape (4, n_windows)
        Power up to 1 kHz, to 2 kHz, to 4 kHz, and above [likewise].
    top, low, high : ndarray of int, shape (n_windows,)
        The strongest bin, and the next on either side that have half its power or less.
    """

    power: NDArray[np.float32]
    level: NDArray[np.float32]
    end: int
    total: NDArray[np.float32]
    line: NDArray[np.float32]
    below: NDArray[np.float32]
    flatness: NDArray[np.float32]
    slope: NDArray[np.float32]
    octaves: NDArray[np.float32]
    top: NDArray[np.int64]
    low: NDArray[np.int64]
    high: NDArray[np.int64]


def segments_of(sound: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cut sounds into quarters of a second that overlap by half.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,) or (n_sounds, n)
        At `features.windows.blocks.RATE` [any unit]; zeros follow its end.

    Returns
    -------
    ndarray of float32, shape (n_segments, 4000)
        Of one sound after the other [unit of the sound].

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


def window_spectra(
    segments: NDArray[np.float32], first: NDArray[np.int64], last: NDArray[np.int64], limit: float
) -> WindowSpectra:
    """Add up the power spectra of each window's segments.

    Parameters
    ----------
    segments : ndarray of float32, shape (n_segments, 4000)
        As `segments_of` gives them.
    first, last : ndarray of int, shape (n_windows,)
        Each window adds up the spectra of the segments from `first` up to `last`, three at most.
    limit : float
        Frequency up to which they are described [Hz]; at least to 273 Hz.

    Returns
    -------
    WindowSpectra

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 700.0 * np.arange(8000) / 16e3).astype(np.float32)
    >>> found = window_spectra(segments_of(tone), np.array([0]), np.array([3]), 7000.0)
    >>> round(float(found.top[0] * SPACING))
    699
    """
    needed = np.zeros(len(segments), dtype=np.bool_)
    needed[np.minimum(first + np.arange(3)[:, None], last - 1)] = True
    spectrum = fft.rfft(segments[needed] * _WINDOW, n=_LENGTH, axis=1)
    spectra = spectrum.real**2
    spectra += spectrum.imag**2
    row = np.cumsum(needed) - 1
    end = max(FIRST + BLOCK, min(int(limit / SPACING) + 1, spectra.shape[1] - 2))
    power = np.full((len(first), max(end, _KILOHERTZ[0]) + 2), _LEAST, dtype=np.float32)
    for i in range(int((last - first).max(initial=0))):
        held = first + i < last
        power[held, FIRST - 2 : end + 2] += spectra[row[first[held]] + i, FIRST - 2 : end + 2]
    n, level = len(power), np.empty_like(power)
    described = slice(FIRST - 2, end + 2)
    np.log10(power[:, described], out=level[:, described])
    level[:, described] *= 10.0
    sums, bins = np.zeros((9, n), dtype=np.float32), np.empty((3, n), dtype=np.int64)
    _measure(power, end, level, sums, bins)
    total, line, below, flatness, slope = sums[:5]
    top, low, high = bins
    return WindowSpectra(
        power, level, end, total, line, below, flatness, slope, sums[5:], top, low, high
    )


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
        # Flatness, and a line through the blocks' mean levels over the octave.
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
        # The strongest bin's own power reaches as far as a friction tone wanders.
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


def line_power(
    spectra: WindowSpectra, row: NDArray[np.int64], at: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Add up the power in lines.

    Parameters
    ----------
    spectra : WindowSpectra
    row, at : ndarray of int, shape (n_lines,)
        Window and bin of each line.

    Returns
    -------
    ndarray of float32, shape (n_windows,)
        [unit of the spectra]

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 700.0 * np.arange(8000) / 16e3).astype(np.float32)
    >>> found = window_spectra(segments_of(tone), np.array([0]), np.array([3]), 7000.0)
    >>> power = line_power(found, np.array([0]), found.top)
    >>> round(float(power[0] / found.total[0]), 3)
    1.0
    """
    sums = np.zeros(len(spectra.power), dtype=np.float32)
    _add_lines(spectra.power, row, at, spectra.end, sums)
    return sums


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _add_lines(power, row, at, end, sums) -> None:
    for i in range(row.size):
        p = power[row[i]]
        lines = sums[row[i]]
        for k in range(max(FIRST, at[i] - LOBE), min(end, at[i] + LOBE + 1)):
            lines += p[k]
        sums[row[i]] = lines
