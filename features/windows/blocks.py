# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Blocks of a long signal at a common sampling rate, from which all window features are computed.

Fourier transforms of single seconds give the part below 7 kHz at 16 kHz, and its part above 2 kHz,
where blows stand out from tones. Each second is extended by a fifth on either side, half of it
faded, which is discarded; such short transforms fit in the cache. Blocks lie on a fixed grid, so
results do not depend on the part of a recording in memory.
Single precision, relative to the peak of the block, is twice as fast.

The part below 7 kHz is A-weighted: in a car or hall, most power lies below 200 Hz, where noises do
not differ. A squawk at 250 Hz loses 9 dB, but not its harmonics. If a recording was stored at a
lower rate before, it is described as at that rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.kernels.conditioning import USABLE_SHARE, WORKING_LIMIT
from features.kernels.weighting import a_weighting
from features.windows.arithmetic import power_of
from models.compilation import COMPILED

RATE = 16_000
"""Common sampling rate [Hz]."""

USEFUL = 7
"""Duration of a block without margins [s]."""

MARGIN = 0.5
"""Margin of a block on either side [s]."""

FRAME_RATE = 100
"""Frames per second."""

_ASIDE = 0.2
"""Discarded part of a transform on either side of a second [s]."""

_LOW = (110.0, 160.0)
"""Flank of the high-pass against hum and rumble [Hz]."""

_HIGH_FROM = (1700.0, 2300.0)
"""Flank of the high-pass of the part with blows [Hz]."""

_STORED_RATES = (8_000, 11_025, 12_000, 16_000, 22_050, 24_000, 32_000, 44_100)
"""Possible sampling rates of earlier storage [Hz]."""

_CLIFF = 1e-3
"""Maximum ratio of the density above half the rate of earlier storage to that below: no sound falls
by 30 dB within half an octave."""

_LANES = 4
"""Rows that are transformed together by vector instructions."""


@dataclass(frozen=True, eq=False)
class Block:
    """Block at the common rate, without margins.

    Parameters
    ----------
    sound : ndarray of float32, shape (n,)
        Signal from 160 Hz to 7 kHz, A-weighted [share of `scale`].
    high : ndarray of float32, shape (n,)
        Part of it above 2 kHz [share of `scale`].
    scale : float
        Peak of the block [unit]; 0 if constant.
    limit : float
        Upper limit of the band [Hz]; 0 if constant.
    """

    sound: NDArray[np.float32]
    high: NDArray[np.float32]
    scale: float
    limit: float


def block_length(duration: float) -> int:
    """Return the useful duration of the blocks of a recording [s], less for short recordings.

    Examples
    --------
    >>> block_length(0.8), block_length(3600.0)
    (1, 7)
    """
    return next((length for length in (1, 3) if duration <= length), USEFUL)


def resampled_block(samples: NDArray[np.float64], rate: float, useful: int) -> Block:
    """Return a block of samples at the common rate.

    Parameters
    ----------
    samples : ndarray, shape (round((useful + 1) * rate),)
        Samples with a margin of half a second on either side [any unit].
    rate : float
        [Hz]
    useful : int
        Duration without margins [s].

    Returns
    -------
    Block

    Examples
    --------
    >>> time = np.arange(96_000) / 48e3
    >>> block = resampled_block(np.sin(2 * np.pi * 1000.0 * time), 48e3, 1)
    >>> block.sound.size, round(float(block.sound.std()), 2), round(float(block.high.std()), 2)
    (16000, 0.71, 0.0)
    """
    n = useful * RATE
    samples = np.ascontiguousarray(samples)
    mean, scale = _mean_and_peak(samples)
    if not scale > 0.0:
        nothing = np.zeros(n, dtype=np.float32)
        return Block(nothing, nothing, 0.0, 0.0)
    # If a tenth of a second is no whole number of samples, the block is transformed at once.
    second, aside = (useful, MARGIN) if rate % 10.0 else (1, _ASIDE)
    seconds = second + 2.0 * aside
    count, length = (1, samples.size) if rate % 10.0 else (useful, round(seconds * rate))
    rows = -(-count // _LANES) * _LANES
    single = np.zeros((rows if count > 1 else 1, length), dtype=np.float32)
    starts = np.round((MARGIN - aside + second * np.arange(count)) * rate).astype(np.int64)
    _cut(samples, starts, mean, 1.0 / scale, _ramp(round(0.5 * aside * rate)), single)
    spectrum = fft.rfft(single, axis=1)
    rate_held = _rate_held(spectrum[:count], seconds, rate)
    low, high = _gains(round(1e6 * rate_held), seconds)
    n_bins, at_rate = min(low.size, spectrum.shape[1]), round(seconds * RATE)
    bins = np.zeros((len(single), at_rate // 2 + 1), dtype=np.complex64)
    # Transforms scale with their length.
    np.multiply(
        spectrum[:, :n_bins], low[:n_bins] * np.float32(at_rate / length), out=bins[:, :n_bins]
    )
    inside = slice(round(aside * RATE), round((second + aside) * RATE))
    sound = fft.irfft(bins, at_rate, axis=1)[:count, inside].reshape(-1)
    bins[:, : high.size] *= high
    pulses = fft.irfft(bins, at_rate, axis=1)[:count, inside].reshape(-1)
    return Block(sound, pulses, scale, min(WORKING_LIMIT, USABLE_SHARE * rate_held))


def _rate_held(spectrum: NDArray[np.complex64], seconds: float, rate: float) -> float:
    """Return the lowest rate that contains the spectrum: its own, or that of earlier storage."""
    power = power_of(spectrum)
    below = np.append(0.0, np.cumsum(power.mean(axis=0), dtype=np.float64))
    for stored in _STORED_RATES:
        bins = 0.5 * stored * seconds
        end = round(1.15 * bins)
        if stored > 0.9 * rate or power.shape[1] <= 1.15 * bins:
            return rate
        above = (below[-1] - below[end]) / (power.shape[1] - end)
        # Flanks of a tone are as steep, so two ranges below the limit are compared.
        places = [(round(a * bins), round(b * bins)) for a, b in ((0.45, 0.6), (0.75, 0.85))]
        # The median, which is slow, is at most twice the mean.
        if all(above <= 2.0 * _CLIFF * (below[b] - below[a]) / (b - a) for a, b in places) and all(
            above <= _CLIFF * np.median(power[:, a:b]) for a, b in places
        ):
            return float(stored)
    return rate


def _mean_and_peak(x: NDArray[np.float64]) -> tuple[float, float]:
    """Return the mean and the largest deviation from it."""
    mean = float(x.mean())
    return mean, max(float(x.max()) - mean, mean - float(x.min()))


@njit(fastmath={"reassoc", "contract"}, cache=True, **COMPILED)
def _cut(x, starts, mean, gain, ramp, out) -> None:
    """Fill rows with faded parts of a signal from each start, without the mean, times a gain."""
    n = out.shape[1]
    for row in range(starts.size):
        part = x[starts[row] : starts[row] + n]
        for i in range(n):
            out[row, i] = gain * (part[i] - mean)
        for i in range(ramp.size):
            out[row, i] *= ramp[i]
            out[row, n - 1 - i] *= ramp[i]


@lru_cache(maxsize=8)
def _ramp(n: int) -> NDArray[np.float32]:
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * (np.arange(n) + 0.5) / n), dtype=np.float32)


@lru_cache(maxsize=8)
def _gains(microhertz: int, seconds: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the gains of the A-weighted band and of its high part, by bin."""
    limit = min(WORKING_LIMIT, USABLE_SHARE * 1e-6 * microhertz)
    spacing = 1.0 / seconds
    end = 1.07 * limit
    frequency = np.arange(math.ceil(end / spacing)) * spacing
    low = _flank(frequency, *_LOW)
    low *= 1.0 - _flank(frequency, limit, end)
    low[1:] *= 10.0 ** (a_weighting(frequency[1:]) / 20.0)
    return low.astype(np.float32), _flank(frequency, *_HIGH_FROM).astype(np.float32)


def _flank(frequency: NDArray[Any], low: float, high: float) -> NDArray[np.float64]:
    share = np.clip((frequency - low) / (high - low), 0.0, 1.0)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * share))
