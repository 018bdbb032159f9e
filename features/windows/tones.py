"""Lines of a window's spectrum: how many, how strong, and whether they are harmonics of one.

A bin is 3.9 Hz wide and three overlapping spectra of a quarter of a second are averaged, so that a
squawk of 100 Hz shows each of its harmonics. What stands 10 dB above its surroundings and falls to
either side before the next rises is a line, as in `features.kernels.lines`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import fft

from features.kernels.bands import a_weighting
from features.windows.lines import (
    BLOCK,
    FIRST,
    LOBE,
    MOST,
    RANGE_DB,
    SPACING,
    find_harmonics,
    find_lines,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SEGMENT_HOP", "TONE_NAMES", "long_spectra", "tones_of"]

_SEGMENT = 4000
_LENGTH = 4096
SEGMENT_HOP = 2000
"""Samples from one long spectrum to the next."""

_LEAST = np.float32(1e-20)

TONE_NAMES = (
    "line_count", "strong_line_count", "line_frequency", "line_share", "lines_share",
    "second_line", "third_line", "line_prominence", "line_width", "fundamental",
    "harmonic_share", "harmonic_count", "inharmonicity", "harmonic_gain", "below_line",
    "above_line", "spectral_flatness", "spectral_slope", "lowest_line", "line_spacing_spread",
    "weighted_above_1", "weighted_above_2", "weighted_above_4", "weighted_lines",
)  # fmt: skip
"""Of a window, in the order of `tones_of`.

Lines within 30 dB and within 18 dB of the strongest; the frequency of the strongest [octave re
1 kHz], the share of the power in it and in all lines; second and third re the first [dB]; how far
the first stands above its surroundings [dB] and its width at half power [Hz]; the fundamental
[octave re 100 Hz] that explains most of the power in lines, the share of the whole that lies at its
harmonics, their number, their mean distance from multiples, and the share's excess over
what evenly spread power would put there; power below and above the strongest line re the line
[dB]; flatness [dB] and slope [dB an octave] of the spectrum; lowest line re the strongest
[octave]; spread of the distances between lines [share of their mean]. A-weighted power above 1, 2
and 4 kHz and in all lines re all [dB].
"""


def long_spectra(sound: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """Power spectra of `count` overlapping quarters of a second.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,)
        At `RATE`; zeros follow its end.
    count : int

    Returns
    -------
    ndarray of float32, shape (count, 2049)

    Examples
    --------
    >>> long_spectra(np.zeros(8000, dtype=np.float32), 3).shape
    (3, 2049)
    """
    needed = (count - 1) * SEGMENT_HOP + _SEGMENT
    if sound.size < needed:
        sound = np.concatenate([sound, np.zeros(needed - sound.size, dtype=np.float32)])
    segments = np.lib.stride_tricks.sliding_window_view(sound, _SEGMENT)[::SEGMENT_HOP][:count]
    spectrum = fft.rfft(segments * _WINDOW, n=_LENGTH, axis=1)
    power = spectrum.real**2
    power += spectrum.imag**2
    return np.asarray(power)


_WINDOW = np.hanning(_SEGMENT + 2)[1:-1].astype(np.float32)


def tones_of(
    spectra: NDArray[np.float32],
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    limit: float,
) -> NDArray[np.float32]:
    """Describe the lines of windows.

    Parameters
    ----------
    spectra : ndarray of float32, shape (n_spectra, n_bins)
        As `long_spectra` gives them.
    first, last : ndarray of int, shape (n_windows,)
        Each window averages the spectra from `first` up to `last`.
    limit : float
        Frequency up to which lines are sought [Hz].

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `TONE_NAMES`.

    Examples
    --------
    >>> time = np.arange(8000) / 16e3
    >>> sound = np.sin(2 * np.pi * 700 * time) + 0.5 * np.sin(2 * np.pi * 1400 * time)
    >>> spectra = long_spectra(sound.astype(np.float32), 3)
    >>> found = tones_of(spectra, np.array([0]), np.array([3]), 7000.0)[0]
    >>> dict(zip(TONE_NAMES, found.round(1).tolist()))["line_count"]
    2.0
    """
    # Blows are heard above 1 kHz; what is below counts as the ear hears it.
    out = np.full((len(first), len(TONE_NAMES)), np.nan, dtype=np.float32)
    end = min(int(limit / SPACING) + 1, spectra.shape[1] - 2)
    _windows(spectra, first, last, end, out)
    return out


_KILOHERTZ = (256, 512, 1024, 1 << 20)
"""Bins of 1, 2 and 4 kHz."""

_FREQUENCY = np.arange(_LENGTH // 2 + 1) * SPACING
_WEIGHT = (10.0 ** (0.1 * a_weighting(np.maximum(_FREQUENCY, 10.0)))).astype(np.float32)

_OCTAVES = 1.0 / np.log(2.0)
"""What makes a natural logarithm one of base two."""


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _windows(spectra, first, last, end, out):
    n = end - FIRST
    p = np.empty(end + 2, dtype=np.float32)
    level = np.empty(end + 2, dtype=np.float32)
    n_blocks = (n + BLOCK - 1) // BLOCK
    floor = np.empty(n_blocks, dtype=np.float32)
    at = np.empty(MOST, dtype=np.int64)
    height = np.empty(MOST, dtype=np.float32)
    for w in range(len(first)):
        for k in range(end + 2):
            p[k] = _LEAST
        for s in range(first[w], last[w]):
            for k in range(FIRST - 2, end + 2):
                p[k] += spectra[s, k]
        total = np.float32(0.0)
        top = FIRST
        for k in range(FIRST, end):
            total += p[k]
            if p[k] > p[top]:
                top = k
        heard = np.zeros(5, dtype=np.float32)
        for k in range(FIRST, _KILOHERTZ[0]):
            heard[0] += p[k] * _WEIGHT[k]
        for part in range(3):
            for k in range(_KILOHERTZ[part], max(_KILOHERTZ[part], min(end, _KILOHERTZ[part + 1]))):
                heard[part + 1] += p[k] * _WEIGHT[k]
        audible = heard.sum()
        out[w, 20] = 10.0 * np.log10(max((audible - heard[0]) / audible, 1e-6))
        out[w, 21] = 10.0 * np.log10(max((heard[2] + heard[3]) / audible, 1e-6))
        out[w, 22] = 10.0 * np.log10(max(heard[3] / audible, 1e-6))
        out[w, 23] = -60.0
        logs = np.float32(0.0)
        sx, sy, sxx, sxy = 0.0, 0.0, 0.0, 0.0
        for k in range(FIRST - 2, end + 2):
            level[k] = 10.0 * np.log10(p[k])
        for b in range(n_blocks):
            lo, hi = FIRST + b * BLOCK, min(FIRST + (b + 1) * BLOCK, end)
            if hi - lo < BLOCK // 2:
                floor[b] = floor[b - 1]
                continue
            floor[b] = np.median(level[lo:hi])
            mean = np.float32(0.0)
            for k in range(lo, hi):
                mean += level[k]
            logs += mean
            mean /= hi - lo
            x = _OCTAVES * np.log((lo + hi) * 0.5)
            sx += x
            sy += mean
            sxx += x * x
            sxy += x * mean
        count, strong = find_lines(level, floor, end, top, at, height)
        out[w, 0] = count
        out[w, 1] = strong
        out[w, 16] = logs / n - 10.0 * np.log10(total / n)
        out[w, 17] = (n_blocks * sxy - sx * sy) / (n_blocks * sxx - sx * sx)
        # The strongest maximum, whether it is a line or not.
        left, right = level[top - 1], level[top + 1]
        bend = left - 2.0 * level[top] + right
        shift = 0.5 * (left - right) / bend if bend < -1e-6 else 0.0
        place = top + min(0.5, max(-0.5, shift))
        out[w, 2] = _OCTAVES * np.log(place * (SPACING / 1000.0))
        reach = LOBE + int(0.005 * top)
        line = np.float32(0.0)
        for k in range(max(FIRST, top - reach), min(end, top + reach + 1)):
            line += p[k]
        out[w, 3] = line / total
        below = np.float32(0.0)
        for k in range(FIRST, max(FIRST, top - reach)):
            below += p[k]
        above = np.maximum(total - line - below, 0.0)
        out[w, 14] = 10.0 * np.log10(np.maximum(below / line, 1e-5))
        out[w, 15] = 10.0 * np.log10(np.maximum(above / line, 1e-5))
        out[w, 7] = level[top] - floor[min((top - FIRST) // BLOCK, n_blocks - 1)]
        low, high = top, top
        while low > FIRST and p[low] > 0.5 * p[top]:
            low -= 1
        while high < end - 1 and p[high] > 0.5 * p[top]:
            high += 1
        out[w, 8] = (high - low) * SPACING
        out[w, 5] = -RANGE_DB
        out[w, 6] = -RANGE_DB
        out[w, 4] = 0.0
        if count > 0:
            lines = np.float32(0.0)
            highest, second, third = height[0], -200.0, -200.0
            for i in range(count):
                highest = max(highest, height[i])
            seen = False
            for i in range(count):
                h = height[i]
                if h == highest and not seen:
                    seen = True
                elif h > second:
                    second, third = h, second
                elif h > third:
                    third = h
                for k in range(max(FIRST, at[i] - LOBE), min(end, at[i] + LOBE + 1)):
                    lines += p[k]
                    heard[4] += p[k] * _WEIGHT[k]
            out[w, 23] = 10.0 * np.log10(min(max(heard[4] / audible, 1e-6), 1.0))
            out[w, 4] = min(1.0, lines / total)
            out[w, 5] = max(second - highest, -RANGE_DB)
            out[w, 6] = max(third - highest, -RANGE_DB)
            out[w, 18] = _OCTAVES * np.log(at[0] / top)
            if count > 2:
                mean = (at[count - 1] - at[0]) / (count - 1)
                spread = 0.0
                for i in range(count - 1):
                    spread += abs(at[i + 1] - at[i] - mean)
                out[w, 19] = spread / (count - 1) / mean
            find_harmonics(p, level, at, height, count, top, place, end, total, out[w])
