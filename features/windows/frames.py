# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Short frames of a sound, and features of windows from the course of their frames.

A frame has strength, tonality, pitch and similarity to the frame before; a window describes their
variation. A friction tone has a steady frequency; calls and sirens glide, and a voice has syllables
and formants. Frames are weighted by power, so that pauses do not affect the pitch.

Windows with equal numbers of frames are described together. Sums run over the frames in order, so
that the features of a window do not depend on the other windows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import OCTAVES, ordered_sum, power_of
from features.windows.blocks import FRAME_RATE, RATE
from models.compilation import COMPILED

FRAME = 512
"""Samples per frame."""

HOP = RATE // FRAME_RATE
"""Samples from one frame to the next."""

_SPACING = RATE / FRAME
_FIRST_BIN = 5
_EDGES = (5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 225)
"""Edges of half-octave bands in bins: 156 Hz to 7 kHz."""

BANDS = len(_EDGES) - 1

_LOBE = 2
"""Bins of a maximum on either side."""

_APART = 5
"""Minimum distance of a second maximum from the first, in bins."""

_LAGS = (16, 200)
"""Range of the period of a pitch in samples: 80 Hz to 1 kHz."""

_LEAST = np.float32(1e-20)

_AT_ONCE = 255
"""Number of frames whose spectra fit in the cache."""

FRAME_COLUMNS = (
    "energy", "flatness", "centroid", "peak", "peak_share", "second", "flux", "pitch", "voiced",
)  # fmt: skip
"""Columns of a frame beside its bands.

Energy [dB re the scale of the block]; ratio of geometric to arithmetic mean of the power [dB];
centroid and frequency of the strongest maximum [octave re 1 kHz]; share of the power in that
maximum; level of the second maximum re the first [dB]; one minus the cosine between the magnitudes
of this frame and the frame before; pitch [octave re 100 Hz] and periodicity at the pitch (0 to 1).
"""


@dataclass(frozen=True, eq=False)
class Frames:
    """Features of the frames of a sound.

    Parameters
    ----------
    values : ndarray of float32, shape (n_frames, n_columns)
        By `FRAME_COLUMNS`, in their units [dB, octave or -].
    bands : ndarray of float32, shape (n_frames, BANDS)
        Power in half octaves [dB re the block's scale].
    """

    values: NDArray[np.float32]
    bands: NDArray[np.float32]


def describe_frames(sound: NDArray[np.float32], limit: float) -> Frames:
    """Return the features of the frames of a sound.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,) or (n_sounds, n)
        Samples at `RATE` [any unit].
    limit : float
        Upper frequency limit [Hz].

    Returns
    -------
    Frames
        Frames of one sound after the other.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1000.0 * np.arange(16_000) / 16e3).astype(np.float32)
    >>> frames = describe_frames(tone, 7000.0)
    >>> frames.values[5, FRAME_COLUMNS.index("peak_share")] > 0.99
    np.True_
    """
    if sound.size < FRAME:
        sound = np.concatenate([sound, np.zeros(FRAME - sound.size, dtype=np.float32)])
    frames = np.lib.stride_tricks.sliding_window_view(sound, FRAME, axis=-1)[..., ::HOP, :]
    each = frames.shape[-2]
    frames = frames.reshape(-1, FRAME)
    last = max(_FIRST_BIN + 1, min(_EDGES[-1], int(limit / _SPACING) + 1))
    values = np.empty((len(frames), len(FRAME_COLUMNS)), dtype=np.float32)
    bands = np.empty((len(frames), BANDS), dtype=np.float32)
    for first in range(0, len(frames), _AT_ONCE):
        # Including the frame before, for the comparison.
        lead = min(first, 1)
        part = slice(first, first + _AT_ONCE)
        columns, of_bands = _described(frames[first - lead : first + _AT_ONCE], last)
        values[part], bands[part] = columns[lead:], of_bands[lead:]
    if each > 1:
        # The first frame has none before.
        flux = values[:, FRAME_COLUMNS.index("flux")]
        flux[::each] = flux[1::each]
    np.log10(bands, out=bands)
    bands *= 10.0
    return Frames(values, bands)


def _described(
    frames: NDArray[np.float32], last: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return `FRAME_COLUMNS` of frames, and the power in their bands."""
    power = power_of(fft.rfft(frames * _WINDOW, axis=1), _LEAST)
    correlation = fft.irfft(power, axis=1)[:, : _LAGS[1] + 2] * _TAPER
    values = np.empty((len(power), len(FRAME_COLUMNS)), dtype=np.float32)
    values[:, 1] = np.log2(power[:, _FIRST_BIN:last]).mean(axis=1)
    tops = _FIRST_BIN + power[:, _FIRST_BIN:last].argmax(axis=1)
    _describe(power, tops, np.sqrt(power[:, _FIRST_BIN:last]), correlation, last, values)
    return values, np.add.reduceat(power[:, : _EDGES[-1]], _EDGES[:-1], axis=1)


_WINDOW = np.hanning(FRAME + 2)[1:-1].astype(np.float32)
_SELF = np.correlate(_WINDOW, _WINDOW, "full")[FRAME - 1 :]
_TAPER = (_SELF[0] / _SELF[: _LAGS[1] + 2]).astype(np.float32)


_OCTAVE = np.log2(np.maximum(np.arange(FRAME // 2 + 1), 1) * (_SPACING / 1000.0)).astype(np.float32)


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _describe(power, tops, magnitude, correlation, last, values) -> None:
    """Fill in the columns; on entry, that of the flatness has the mean logarithm of the power."""
    for i in range(power.shape[0]):
        p = power[i]
        top = tops[i]
        total, moment = np.float32(0.0), np.float32(0.0)
        for k in range(_FIRST_BIN, last):
            total += p[k]
            moment += p[k] * _OCTAVE[k]
        around = np.float32(0.0)
        for k in range(max(_FIRST_BIN, top - _LOBE), min(last, top + _LOBE + 1)):
            around += p[k]
        second = _LEAST
        for k in range(_FIRST_BIN + 1, last - 1):
            if p[k] > second and abs(k - top) >= _APART and p[k] >= p[k - 1] and p[k] >= p[k + 1]:
                second = p[k]
        left, right = np.log(p[top - 1]), np.log(p[top + 1])
        bend = left - 2.0 * np.log(p[top]) + right
        shift = 0.5 * (left - right) / bend if bend < -1e-6 else 0.0
        shift = min(0.5, max(-0.5, shift))
        dot = np.float32(0.0)
        before = np.float32(0.0)
        if i > 0:
            for k in range(magnitude.shape[1]):
                dot += magnitude[i, k] * magnitude[i - 1, k]
                before += magnitude[i - 1, k] * magnitude[i - 1, k]
        r = correlation[i]
        best, period = np.float32(0.0), 0
        # The shortest lag that is nearly as good as the best is no multiple of the period.
        for lag in range(_LAGS[0], _LAGS[1] + 1):
            if r[lag] > 1.08 * best and r[lag] > r[lag - 1] and r[lag] >= r[lag + 1]:
                best, period = r[lag], lag
        values[i, 0] = 10.0 * np.log10(total)
        values[i, 1] = 10.0 * (values[i, 1] * 0.30103 - np.log10(total / (last - _FIRST_BIN)))
        values[i, 2] = moment / total
        values[i, 3] = OCTAVES * np.log((top + shift) * (_SPACING / 1000.0))
        values[i, 4] = around / total
        values[i, 5] = 10.0 * np.log10(second / p[top])
        values[i, 6] = 1.0 - dot / np.sqrt(total * before) if before > 0.0 else 0.0
        values[i, 7] = OCTAVES * np.log(RATE / (100.0 * period)) if period > 0 else np.nan
        values[i, 8] = best / r[0]


_MOST_DB = 60.0
"""Largest change of level between frames [dB]."""

_QUIETEST_BAND_DB = -70.0


class Course:
    """Features from the course of the frames of windows of equal length, for `features.table`.

    Parameters
    ----------
    values : ndarray of float32, shape (n_columns, n_frames, n_windows)
        By `FRAME_COLUMNS`, in their units [dB, octave or -]; three frames at least.
    bands : ndarray of float32, shape (BANDS, n_frames, n_windows)
        [dB re the block's scale]

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1000.0 * np.arange(8000) / 16e3).astype(np.float32)
    >>> frames = describe_frames(tone, 7000.0)
    >>> course = Course(frames.values.T[:, :, None], frames.bands.T[:, :, None])
    >>> bool(abs(course.peak_frequency[0]) < 0.01)
    True
    """

    def __init__(self, values: NDArray[np.float32], bands: NDArray[np.float32]) -> None:
        level, flatness, centroid, peak, share, second, flux, pitch, periodicity = values
        n = len(level)
        relative = (level - level.max(axis=0)).astype(np.float64)
        weight = 10.0 ** (0.1 * relative)
        change = np.diff(level, axis=0)
        self.steepest_rise = np.clip(change.max(axis=0), 0.0, _MOST_DB)
        self.steepest_fall = np.clip(0.0 - change.min(axis=0), 0.0, _MOST_DB)
        voiced = periodicity.astype(np.float64)
        averaged = flatness, share, share > 0.5, second, flux, voiced, voiced > 0.6
        self.means = ordered_sum(weight * np.stack(averaged), axis=1) / ordered_sum(weight)
        self.tone_second = np.maximum(self.means[3], -40.0)
        self.flatness_lowest = np.where(weight > 0.01, flatness, 0.0).min(axis=0, initial=0.0)
        periodic = np.where(np.isnan(pitch), 0.0, weight * np.maximum(voiced, 0.0) ** 2)
        (
            (self.centroid, self.peak_frequency, self.pitch),
            (self.centroid_wander, self.peak_wander, self.pitch_wander),
        ) = (
            np.split(columns, 3)
            for columns in _wander(
                np.concatenate([centroid, peak, pitch], axis=1),
                np.concatenate([weight, weight * share, periodic], axis=1),
            )
        )
        jump = np.abs(np.diff(peak, axis=0)).astype(np.float64)
        self.peak_jump = np.median(jump, axis=0)
        # Longest run of frames with the maximum at the same frequency.
        step = np.arange(n - 1)[:, None]
        steady = (jump < 0.02) & (weight[1:] > 0.003)
        broken = np.maximum.accumulate(np.where(steady, -1, step), axis=0)
        self.tone_steady = ((step - broken).max(axis=0) + 1) / n
        self._describe_bands(bands, level)

    def _describe_bands(self, bands: NDArray[np.float32], level: NDArray[np.float32]) -> None:
        """Compute the mean power of the bands, and their common variation."""
        m, n, windows = bands.shape
        relative = (bands - level.max(axis=0)).astype(np.float64)
        power = ordered_sum(10.0 ** (0.1 * relative), axis=1)
        self.band_levels = 10.0 * np.log10(np.maximum(power / ordered_sum(power), 1e-6))
        height = np.maximum(relative, _QUIETEST_BAND_DB)
        high = int(0.95 * (n - 1))
        ordered = np.partition(height, (n // 2, high), axis=1)
        self.band_rise = (ordered[:, high] - ordered[:, n // 2]).max(axis=0)
        onsets = ordered_sum(np.maximum(np.diff(height, axis=1), 0.0)) / m
        self.onset, self.onset_mean = onsets.max(axis=0), ordered_sum(onsets) / (n - 1)
        # Share of the variance that is common to all bands.
        height -= ordered_sum(height / n, axis=1)[:, None]
        mean = ordered_sum(height / m)
        common = ordered_sum(mean * mean)
        own = ordered_sum((height**2 / m).swapaxes(0, 1).reshape(n * m, windows))
        self.together = np.divide(common, own, out=np.zeros(windows), where=own > 0.0)


def _wander(
    course: NDArray[np.float32], weight: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return weighted median and robust deviation of a trajectory with gaps.

    A gap has no weight; without any weight, both are NaN.
    """
    weight = np.where(weight > 0.0, weight, 0.0)
    whole = ordered_sum(weight)
    order, columns = np.argsort(course, axis=0), np.arange(course.shape[1])
    reached = np.cumsum(weight[order, columns], axis=0) >= 0.5 * whole
    median = course[order[reached.argmax(axis=0), columns], columns]
    off = np.where(weight > 0.0, np.abs(course - median), np.float32(0.0)).astype(np.float64)
    whole = np.where(whole > 0.0, whole, np.nan)
    deviation = ordered_sum(weight * np.minimum(off, 1.0)) / whole
    return np.where(whole > 0.0, median, np.nan), deviation
