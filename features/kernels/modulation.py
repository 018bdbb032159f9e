"""Changes of a noise over time: tones and levels of short segments, and modulation.

A squeal is one steady tone, a bark or a crow has moving tones, a creak neither. Segments of 64 ms
show this: the fastest slip sequence still covers several, and a gliding tone is still narrow. They
are weighted by energy, so pauses between strokes do not count. A regular creak is modulated at its
slip frequency, a helicopter at its blade frequency, speech at no steady rate. The rate of
modulation is that of the envelope's autocorrelation, since counting pulses fails where they
overlap.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from features.kernels.conditioning import band_signal, forward
from features.kernels.harmonics import strongest_period, track_periods
from features.kernels.spectra import segment_powers, weighted_median

_SEGMENT = 0.064
"""Length of a segment [s]."""

_LOBE = 2
"""Bins on either side of a maximum that belong to it: the Hann window's main lobe. A zero-padded
segment has proportionally more."""

_SAME_TONE = 1.0 / 12.0
"""Largest change of a tone between segments [octave]."""

_TONE_DB = 13.0
"""Least height of a tone above its segment's floor [dB]; noise exceeds it in one of 5e8 bins."""

_TONE_RANGE_DB = 20.0
"""Largest distance of a tone below the strongest of its segment [dB]."""

_FLOOR_BINS = 32
"""Bins in a block whose median is the floor."""

_VOICED = 0.5
"""Autocorrelation from which a segment has a fundamental."""

_LOWEST_FUNDAMENTAL = 60.0
"""Lowest fundamental that segments of 64 ms resolve [Hz]."""

_QUIETEST_DB = -60.0
"""Lowest level of a segment relative to the loudest [dB]; lower ones are raised to it."""

_LEAST_VOICED = 4
_BANDS_PER_OCTAVE = 3
_NORMAL_CONSISTENT = 1.4826
_TINY = float(np.finfo(np.float64).tiny)


def short_time(x: NDArray[np.float64], rate: float, *, low: float, high: float) -> dict[str, float]:
    """Compute features of the changes of a signal between two frequencies.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        In any [unit], mean removed, not silent.
    rate : float
        Sampling rate [Hz].
    low, high : float
        Limits of the band [Hz].

    Returns
    -------
    dict of str to float
        Means over segments, weighted by energy: ``tone_share``, share of the power in the strongest
        line of a segment [-]; ``tone_count``, lines within 20 dB of the strongest and 13 dB above
        the floor; ``second_tone``, level of the second line relative to the strongest, at least -20
        [dB]; ``periodicity``, autocorrelation at the fundamental's period [-];
        ``fundamental_wander``, robust standard deviation of the fundamental [octave], NaN unless
        four segments have one. NaN for a single segment: ``continuity``, ``tone_share`` of tones
        that continue (within a semitone) in the next segment; ``flux``, share of the power that
        changes its one-third octave; ``level_variation``, standard deviation of the levels [dB].

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(16000) / 16e3
    >>> glide = short_time(np.sin(2 * np.pi * (2500 + 300 * t) * t), 16e3, low=150.0, high=7e3)
    >>> [round(glide[name], 2) for name in ("tone_share", "continuity", "tone_count")]
    [1.0, 1.0, 1.0]
    """
    length = max(16, 2 * round(0.5 * _SEGMENT * rate))
    segment = min(length, x.size)
    lobe = math.ceil(_LOBE * length / segment)
    power, _ = segment_powers(x, segment, transform_length=length)
    spacing = rate / length
    first, last = math.ceil(low / spacing), min(math.floor(high / spacing), power.shape[1] - 1)
    power[:, :first] = 0.0
    power[:, last + 1 :] = 0.0
    energy = power.sum(axis=1)
    tone, share = _strongest_tones(power, energy, lobe)
    count, second = _other_tones(power[:, first : last + 1], lobe)
    frequency, strength = track_periods(
        power, spacing, lowest=max(_LOWEST_FUNDAMENTAL, 3.0 * spacing)
    )
    weight = energy / max(float(energy.sum()), _TINY)
    continuity = flux = level_variation = math.nan
    if energy.size > 1:
        bands = np.add.reduceat(power[:, : last + 1], _band_edges(first, last), axis=1)
        bands = bands / np.maximum(energy, _TINY)[:, np.newaxis]
        moved = 0.5 * np.abs(np.diff(bands, axis=0)).sum(axis=1)
        pairs = np.sqrt(weight[1:] * weight[:-1])
        pairs = pairs / max(float(pairs.sum()), _TINY)
        stays = np.abs(np.diff(np.log2(tone))) < _SAME_TONE
        continuity = float(pairs @ (np.sqrt(share[1:] * share[:-1]) * stays))
        flux = float(pairs @ moved)
        quietest = max(float(energy.max()) * 10.0 ** (0.1 * _QUIETEST_DB), _TINY)
        level_variation = float(np.std(10.0 * np.log10(np.maximum(energy, quietest))))
    means = {
        "tone_share": share,
        "tone_count": count,
        "second_tone": second,
        "periodicity": strength,
    }
    return {
        **{name: float(weight @ values) for name, values in means.items()},
        "fundamental_wander": _wander(frequency, strength, weight),
        "continuity": continuity,
        "flux": flux,
        "level_variation": level_variation,
    }


def _strongest_tones(
    power: NDArray[np.float64], energy: NDArray[np.float64], lobe: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the position of each segment's strongest line in bins, and its share of the power."""
    lobe = min(lobe, (power.shape[1] - 1) // 2)
    top = np.clip(power.argmax(axis=1), lobe, power.shape[1] - 1 - lobe)
    bins = top[:, np.newaxis] + np.arange(-lobe, lobe + 1)
    around = np.take_along_axis(power, bins, axis=1)
    sums = around.sum(axis=1)
    tone = np.where(sums > 0.0, (around * bins).sum(axis=1) / np.maximum(sums, _TINY), top)
    return tone, sums / np.maximum(energy, _TINY)


def _other_tones(
    power: NDArray[np.float64], lobe: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the number of lines in each segment, and the level of the second re the first [dB]."""
    n_bins = power.shape[1]
    size = min(_FLOOR_BINS, n_bins)
    blocks = power[:, : n_bins // size * size].reshape(power.shape[0], -1, size)
    block = np.minimum(np.arange(n_bins) // size, blocks.shape[1] - 1)
    floor = np.median(blocks, axis=2)[:, block] / math.log(2.0)
    maxima = ndimage.maximum_filter1d(power, 2 * lobe + 1, axis=1, mode="nearest")
    top = power.max(axis=1, keepdims=True)
    least = np.maximum(top * 10.0 ** (-0.1 * _TONE_RANGE_DB), floor * 10.0 ** (0.1 * _TONE_DB))
    heights = np.where((power == maxima) & (power >= least) & (power > 0.0), power, 0.0)
    count = np.count_nonzero(heights, axis=1).astype(np.float64)
    second = np.partition(heights, -2, axis=1)[:, -2] / np.maximum(top[:, 0], _TINY)
    return count, 10.0 * np.log10(np.maximum(second, 10.0 ** (-0.1 * _TONE_RANGE_DB)))


def _wander(
    frequency: NDArray[np.float64], strength: NDArray[np.float64], weight: NDArray[np.float64]
) -> float:
    """Return the robust deviation of the segments' fundamentals about their median [octave]."""
    voiced = (strength >= _VOICED) & (weight > 0.1 * weight.max())
    if np.count_nonzero(voiced) < _LEAST_VOICED:
        return math.nan
    pitch, weight = np.log2(frequency[voiced]), weight[voiced]
    return _NORMAL_CONSISTENT * weighted_median(
        np.abs(pitch - weighted_median(pitch, weight)), weight
    )


def _band_edges(first: int, last: int) -> NDArray[np.intp]:
    """Return the first bin of each one-third octave from `first` to `last`."""
    first = max(first, 1)
    number = math.ceil(_BANDS_PER_OCTAVE * math.log2(max(last, first + 1) / first))
    edges = first * 2.0 ** (np.arange(max(number, 1)) / _BANDS_PER_OCTAVE)
    return np.unique(edges.astype(np.intp))


_MODULATION_BAND = (2.0, 400.0)
"""Range of the rates of modulation [Hz]."""

_LEAST_DEPTH = 0.01
"""Depth below which modulation is only ripple of the filters."""

_LEAST_STRENGTH = 0.2
"""Autocorrelation below which an envelope has no rate, since noise reaches it."""


class Modulation(NamedTuple):
    """Modulation of an envelope.

    Parameters
    ----------
    rate : float
        Rate of the strongest repetition [Hz]; NaN if there is none.
    strength : float
        Normalised autocorrelation of the envelope at that period, 0 to 1 [-].
    depth : float
        Standard deviation of the envelope between 2 and 400 Hz over its mean: 0.71 for a sinusoidal
        modulation of 100 %.
    """

    rate: float
    strength: float
    depth: float


def modulation(envelope: NDArray[np.float64], rate: float) -> Modulation:
    """Compute the modulation of an envelope.

    Parameters
    ----------
    envelope : ndarray, shape (n_samples,)
        In any [unit], not negative.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    Modulation

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(8000) / 8e3
    >>> beats = modulation(1.0 + np.cos(2 * np.pi * 80 * t), 8e3)
    >>> round(beats.rate), round(beats.strength, 2), round(beats.depth, 2)
    (80, 1.0, 0.71)
    """
    mean = float(envelope.mean())
    if not mean > 0.0:
        return Modulation(math.nan, 0.0, 0.0)
    low, high = _MODULATION_BAND
    transform = forward(envelope - mean, rate)
    beats, beat_rate = band_signal(transform, low, min(high, 0.4 * rate))
    depth = float(np.std(beats)) / mean
    if depth < _LEAST_DEPTH:
        return Modulation(math.nan, 0.0, depth)
    rate, strength = strongest_period(beats, beat_rate, lowest=low, highest=high, whiten=False)
    return Modulation(rate if strength >= _LEAST_STRENGTH else math.nan, strength, depth)
