"""How a window's frames follow each other: strength, tone and pitch, and how they wander.

A friction tone holds its frequency; a dog, a cock or a siren glides, a voice has syllables and
formants. Frames count by their power, so that pauses say nothing about the pitch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from features.windows.frames import BANDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from features.windows.frames import Frames

__all__ = ["COURSE_NAMES", "courses_of"]

_SHAPE = (
    "range", "peak_above_median", "loud_share", "fluctuation", "steepest_rise", "steepest_fall",
    "trend", "flatness", "flatness_lowest", "centroid", "centroid_wander", "peak_frequency",
    "peak_wander", "peak_drift", "peak_jump", "tone_share", "tonal_frames", "tone_second", "flux",
    "voiced", "voiced_frames", "pitch", "pitch_wander", "pitch_drift", "together",
    "tone_steady",
)  # fmt: skip

COURSE_NAMES = (*_SHAPE, *(f"band_{i + 1}" for i in range(BANDS)))
"""Of a window, in the order of `courses_of`.

Of the frames' level [dB]: 95th less 10th percentile, 95th less median, the share of frames within
10 dB of the loudest, deviation, largest rise and fall from frame to frame, trend [dB/s]. Flatness
[dB], its lowest; centroid [octave re 1 kHz] and its deviation; frequency of the strongest maximum,
its deviation, drift [octave/s] and median jump [octave]; share of power in that maximum; frames
where that is more than half; the next maximum [dB]; change between frames; how periodic, how many
frames are, pitch [octave re 100 Hz], its deviation and drift; how far the bands rise and fall
together (0 to 1); the longest run of frames whose maximum stays within a fiftieth of an octave
[share]. Then power in half octaves from 156 Hz [dB re all].
"""

_LEAST_FRAMES = 3


def courses_of(
    frames: Frames, first: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Describe the course of windows.

    Parameters
    ----------
    frames : Frames
    first, last : ndarray of int, shape (n_windows,)
        Each window holds the frames from `first` up to `last`.

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `COURSE_NAMES`.

    Examples
    --------
    >>> from features.windows.frames import describe_frames
    >>> tone = np.sin(2 * np.pi * 1000.0 * np.arange(8000) / 16e3).astype(np.float32)
    >>> frames = describe_frames(tone, 7000.0)
    >>> found = courses_of(frames, np.array([0]), np.array([47]))[0]
    >>> bool(abs(found[COURSE_NAMES.index("peak_frequency")]) < 0.01)
    True
    """
    out = np.full((len(first), len(COURSE_NAMES)), np.nan, dtype=np.float32)
    _courses(frames.values, frames.bands, first, last, out)
    return out


@njit(cache=True, error_model="numpy")
def _courses(values, bands, first, last, out):
    for w in range(len(first)):
        lo, hi = first[w], last[w]
        n = hi - lo
        if n < _LEAST_FRAMES:
            continue
        level = values[lo:hi, 0]
        ordered = np.sort(level)
        top = ordered[n - 1]
        weight = np.empty(n, dtype=np.float64)
        whole = 0.0
        loud, rise, fall, mean, square, sx, sxx = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            weight[i] = 10.0 ** (0.1 * (level[i] - top))
            whole += weight[i]
            above = max(level[i] - top, -60.0)
            mean += above
            square += above * above
            x = i - 0.5 * (n - 1)
            sx += x * above
            sxx += x * x
            if above > -10.0:
                loud += 1
            if i > 0:
                rise = max(rise, level[i] - level[i - 1])
                fall = max(fall, level[i - 1] - level[i])
        high = ordered[int(0.95 * (n - 1))]
        out[w, 0] = min(high - ordered[int(0.1 * (n - 1))], 60.0)
        out[w, 1] = min(high - ordered[n // 2], 60.0)
        out[w, 2] = loud / n
        out[w, 3] = np.sqrt(max(square / n - (mean / n) ** 2, 0.0))
        out[w, 4] = min(rise, 60.0)
        out[w, 5] = min(fall, 60.0)
        out[w, 6] = 100.0 * sx / sxx
        flat, lowest, share, tonal = 0.0, 0.0, 0.0, 0.0
        second, flux, voiced, voices = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            v = values[lo + i]
            flat += weight[i] * v[1]
            if weight[i] > 0.01:
                lowest = min(lowest, v[1])
            share += weight[i] * v[4]
            tonal += weight[i] * (v[4] > 0.5)
            second += weight[i] * v[5]
            flux += weight[i] * v[6]
            voiced += weight[i] * v[8]
            voices += weight[i] * (v[8] > 0.6)
        out[w, 7] = flat / whole
        out[w, 8] = lowest
        out[w, 15] = share / whole
        out[w, 16] = tonal / whole
        out[w, 17] = max(second / whole, -40.0)
        out[w, 18] = flux / whole
        out[w, 19] = voiced / whole
        out[w, 20] = voices / whole
        _wander(values[lo:hi, 2], weight, out[w], 9, 10, -1)
        _wander(values[lo:hi, 3], weight * values[lo:hi, 4], out[w], 11, 12, 13)
        periodic = np.empty(n, dtype=np.float64)
        for i in range(n):
            v = values[lo + i, 8]
            periodic[i] = weight[i] * max(v, 0.0) ** 2 if not np.isnan(values[lo + i, 7]) else 0.0
        _wander(values[lo:hi, 7], periodic, out[w], 21, 22, 23)
        jumps = np.empty(n - 1, dtype=np.float64)
        run, longest = 1, 1
        for i in range(n - 1):
            jumps[i] = abs(values[lo + i + 1, 3] - values[lo + i, 3])
            if jumps[i] < 0.02 and weight[i + 1] > 0.003:
                run += 1
            else:
                run = 1
            longest = max(longest, run)
        out[w, 14] = np.median(jumps)
        out[w, 25] = longest / n
        _bands(bands[lo:hi], level, out[w])


@njit(cache=True, error_model="numpy")
def _wander(course, weight, out, middle, deviation, drift):
    """Weighted mean, robust deviation and slope of a course with gaps."""
    n = len(course)
    order = np.argsort(course)
    whole = 0.0
    for i in range(n):
        if weight[i] > 0.0:
            whole += weight[i]
    if not whole > 0.0:
        return
    sums, median = 0.0, course[order[0]]
    for k in order:
        if weight[k] > 0.0:
            sums += weight[k]
            median = course[k]
            if sums >= 0.5 * whole:
                break
    out[middle] = median
    off = 0.0
    mean_x = 0.0
    for i in range(n):
        if weight[i] > 0.0:
            off += weight[i] * min(abs(course[i] - median), 1.0)
            mean_x += weight[i] * i
    out[deviation] = off / whole
    if drift >= 0:
        mean_x /= whole
        sxx, sxy = 1e-9, 0.0
        for i in range(n):
            if weight[i] > 0.0:
                x = i - mean_x
                sxx += weight[i] * x * x
                sxy += weight[i] * x * min(max(course[i] - median, -0.5), 0.5)
        out[drift] = 100.0 * sxy / sxx


@njit(cache=True, error_model="numpy")
def _bands(bands, level, out):
    """Mean power of the bands, and how far they change together."""
    n, m = bands.shape
    powers = np.zeros(m)
    total = 0.0
    top = level.max()
    for i in range(n):
        for b in range(m):
            powers[b] += 10.0 ** (0.1 * (bands[i, b] - top))
    for b in range(m):
        total += powers[b]
    for b in range(m):
        out[len(_SHAPE) + b] = 10.0 * np.log10(max(powers[b] / total, 1e-6))
    # One less the mean variance of what is left once the common rise and fall is taken out.
    means = np.zeros(m)
    for b in range(m):
        for i in range(n):
            means[b] += max(bands[i, b] - top, -70.0) / n
    own, common = 0.0, 0.0
    for i in range(n):
        mean = 0.0
        for b in range(m):
            mean += (max(bands[i, b] - top, -70.0) - means[b]) / m
        common += mean * mean
        for b in range(m):
            own += (max(bands[i, b] - top, -70.0) - means[b]) ** 2 / m
    out[24] = common / own if own > 0.0 else 0.0
