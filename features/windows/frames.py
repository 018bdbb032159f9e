# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Short frames of a sound: strength, tonality, pitch, and likeness to the frame before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import OCTAVES
from features.windows.blocks import FRAME_RATE, RATE
from models.compilation import COMPILED, PART

FRAME = 512
"""Samples of a frame."""

HOP = RATE // FRAME_RATE
"""Samples from one frame to the next."""

_SPACING = RATE / FRAME
_FIRST_BIN = 5
_EDGES = (5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 225)
"""Of half-octave bands, in bins: 156 Hz to 7 kHz."""

BANDS = len(_EDGES) - 1

_LOBE = 2
"""Bins on either side that belong to a maximum."""

_APART = 5
"""Bins that a second maximum lies away from the first."""

_LAGS = (16, 200)
"""Between them the period of a voice is sought: 80 Hz to 1 kHz."""

_LEAST = np.float32(1e-20)

_AT_ONCE = 255
"""Frames whose spectra stay in the cache."""

FRAME_COLUMNS = (
    "energy", "flatness", "centroid", "peak", "peak_share", "second", "flux", "pitch", "voiced",
)  # fmt: skip
"""What is known of a frame beside its bands.

Energy [dB re the block's scale]; geometric over arithmetic mean of the power [dB]; centroid and
frequency of the strongest maximum [octave re 1 kHz]; the share of the power in that maximum; the
next maximum re the first [dB]; one less the cosine between magnitudes of this frame and the one
before; pitch [octave re 100 Hz] and how periodic the frame is at it (0 to 1).
"""


@dataclass(frozen=True, eq=False)
class Frames:
    """Frames of some seconds of sound.

    Parameters
    ----------
    values : ndarray of float32, shape (n_frames, n_columns)
        By `FRAME_COLUMNS`, in their units [dB, octave or -].
    bands : ndarray of float32, shape (n_frames, BANDS)
        Power in half octaves [dB re the block's scale].
    """

    values: NDArray[np.float32]
    bands: NDArray[np.float32]


def frame_count(n: int) -> int:
    """Return how many whole frames `n` samples hold, at least one.

    Examples
    --------
    >>> frame_count(16_000), frame_count(100)
    (97, 1)
    """
    return max(1, (n - FRAME) // HOP + 1)


def describe_frames(sound: NDArray[np.float32], limit: float) -> Frames:
    """Describe the frames of a sound.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,)
        At `RATE`, in any [unit].
    limit : float
        Frequency up to which it is described [Hz].

    Returns
    -------
    Frames

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1000.0 * np.arange(16_000) / 16e3).astype(np.float32)
    >>> frames = describe_frames(tone, 7000.0)
    >>> frames.values[5, FRAME_COLUMNS.index("peak_share")] > 0.99
    np.True_
    """
    if sound.size < FRAME:
        sound = np.concatenate([sound, np.zeros(FRAME - sound.size, dtype=np.float32)])
    frames = np.lib.stride_tricks.sliding_window_view(sound, FRAME)[::HOP]
    last = max(_FIRST_BIN + 1, min(_EDGES[-1], int(limit / _SPACING) + 1))
    values = np.empty((len(frames), len(FRAME_COLUMNS)), dtype=np.float32)
    bands = np.empty((len(frames), BANDS), dtype=np.float32)
    for first in range(0, len(frames), _AT_ONCE):
        # With the frame before them, which they are compared with.
        lead = min(first, 1)
        part = slice(first, first + _AT_ONCE)
        found, of_bands = _described(frames[first - lead : first + _AT_ONCE], last)
        values[part], bands[part] = found[lead:], of_bands[lead:]
    np.log10(bands, out=bands)
    bands *= 10.0
    return Frames(values, bands)


def _described(
    frames: NDArray[np.float32], last: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return `FRAME_COLUMNS` of some frames, and the power in their bands."""
    spectrum = fft.rfft(frames * _WINDOW, axis=1)
    power = spectrum.real**2
    power += spectrum.imag**2
    power += _LEAST
    correlation = fft.irfft(power, axis=1)[:, : _LAGS[1] + 2] * _TAPER
    values = np.empty((len(power), len(FRAME_COLUMNS)), dtype=np.float32)
    values[:, 1] = np.log2(power[:, _FIRST_BIN:last]).mean(axis=1)
    _describe(power, np.sqrt(power[:, _FIRST_BIN:last]), correlation, last, values)
    return values, np.add.reduceat(power[:, : _EDGES[-1]], _EDGES[:-1], axis=1)


_WINDOW = np.hanning(FRAME + 2)[1:-1].astype(np.float32)
_SELF = np.correlate(_WINDOW, _WINDOW, "full")[FRAME - 1 :]
_TAPER = (_SELF[0] / _SELF[: _LAGS[1] + 2]).astype(np.float32)


_OCTAVE = np.log2(np.maximum(np.arange(FRAME // 2 + 1), 1) * (_SPACING / 1000.0)).astype(np.float32)


@njit(fastmath={"reassoc", "contract", "nsz"}, cache=True, **COMPILED)
def _describe(power, magnitude, correlation, last, values) -> None:
    """Fill in the columns; that of the flatness holds the mean logarithm of the power before."""
    for i in range(power.shape[0]):
        p = power[i]
        total, moment, highest = _sums(p, last)
        top = _FIRST_BIN
        while top < last - 1 and p[top] != highest:
            top += 1
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
        # The shortest lag that is nearly as good as the best: not a multiple of the period.
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
    if power.shape[0] > 1:
        values[0, 6] = values[1, 6]


@njit(fastmath={"reassoc", "contract", "nsz", "nnan"}, cache=True, **PART)
def _sums(p, last):
    """Return power, power times octave, and the highest power of any bin."""
    total, moment, highest = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    for k in range(_FIRST_BIN, last):
        total += p[k]
        moment += p[k] * _OCTAVE[k]
        highest = max(highest, p[k])
    return total, moment, highest
