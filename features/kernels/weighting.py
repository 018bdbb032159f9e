# mypy: allow-untyped-decorators
"""Overall, A-weighted and fast levels of a sound.

Overall levels are mean squares of the whole sound in time, so a click counts by its energy wherever
it lies. The A-weighting is applied to the transform of the sound with the magnitudes of the
standard, in segments of about a second; a recursive filter would be wrong near half the sampling
rate, by several decibels where a creak is strong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from features.kernels.conditioning import checked_signal
from features.kernels.levels import THIRD_OCTAVE_RESOLUTION, band_levels, third_octave_levels
from features.kernels.spectra import welch
from models.compilation import COMPILED
from models.recording import REFERENCE_PRESSURE, Read
from models.show import short_repr

_A_POLES = (20.598997, 107.65265, 737.86223, 12194.217)
"""Frequencies of the poles of the A-weighting [Hz]."""


def a_weighting(frequency: ArrayLike) -> NDArray[np.float64]:
    """Return the gain of the A-weighting.

    Parameters
    ----------
    frequency : array_like
        [Hz]

    Returns
    -------
    ndarray
        Of the same shape [dB]; minus infinity at 0 Hz.

    Notes
    -----
    IEC 61672-1:2013, Annex E: the analytic expression with its four poles, normalised to 0 dB at
    1 kHz.

    Examples
    --------
    >>> a_weighting([100.0, 1000.0, 10000.0]).round(1).tolist()
    [-19.1, 0.0, -2.5]
    """
    with np.errstate(divide="ignore"):
        gain = 20.0 * np.log10(_a_response(np.asarray(frequency, dtype=np.float64)))
    reference = 20.0 * np.log10(_a_response(np.array(1000.0)))
    return np.asarray(gain - reference)


def _a_response(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    f2 = frequency**2
    p1, p2, p3, p4 = (pole**2 for pole in _A_POLES)
    return np.asarray((p4 * f2**2) / ((f2 + p1) * np.sqrt((f2 + p2) * (f2 + p3)) * (f2 + p4)))


FAST = 0.125
"""Time constant of the weighting F [s] (IEC 61672-1)."""

_SEGMENT = 0.8
"""Length of a transformed segment [s], which fits into the cache."""

_MARGIN = 0.1
"""Margin of a segment on either side [s], in which the A-weighting's lowest pole decays by 110 dB.
At its ends a sound is continued by point reflection; cut off, a hum would end in a click louder
than itself."""

_SEGMENTS_AT_ONCE = 4
"""Segments transformed together."""


@short_repr
@dataclass(frozen=True)
class SoundLevels:
    """Levels of a sound, all re the same value.

    Parameters
    ----------
    level : float
        Level about the mean [dB].
    level_a : float
        A-weighted level [dB].
    level_af_max : float
        Largest A-weighted level with the time weighting F [dB].
    third_octaves : dict of str to float
        [dB] by nominal mid-band frequency; NaN for a band that is not measured.
    """

    level: float
    level_a: float
    level_af_max: float
    third_octaves: dict[str, float]

    def raised(self, gain_db: float) -> SoundLevels:
        """Return the levels of the sound with a gain.

        Parameters
        ----------
        gain_db : float
            [dB]

        Returns
        -------
        SoundLevels

        Examples
        --------
        >>> SoundLevels(60.0, 59.0, 61.0, {"1000": 60.0}).raised(3.0).level_a
        62.0
        """
        return replace(
            self,
            level=self.level + gain_db,
            level_a=self.level_a + gain_db,
            level_af_max=self.level_af_max + gain_db,
            third_octaves={band: level + gain_db for band, level in self.third_octaves.items()},
        )


def sound_levels(
    signal: ArrayLike, rate: float, *, reference: float = REFERENCE_PRESSURE
) -> SoundLevels:
    """Return the levels of a whole sound.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Sound pressure [Pa], or fractions of full scale.
    rate : float
        Sampling rate [Hz]. Bands beyond it are NaN.
    reference : float
        [unit]; 1.0 for levels in dB re full scale.

    Returns
    -------
    SoundLevels
        Minus infinity for silence.

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Examples
    --------
    >>> t = np.arange(96000) / 48e3
    >>> pascal = sound_levels(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> round(pascal.level, 2), round(pascal.level_a, 2), round(pascal.third_octaves["1000"], 2)
    (93.98, 93.98, 93.98)
    """
    x = checked_signal(signal, rate)
    x = x - x.mean()
    level = float(band_levels(np.mean(x**2), reference))
    weighted = weighted_levels(_reader(x), x.size, rate, reference=reference)
    bands = third_octave_levels(welch(x, rate, THIRD_OCTAVE_RESOLUTION), reference=reference)
    return SoundLevels(level, weighted.level_a, weighted.level_af_max, bands)


@dataclass(frozen=True, eq=False)
class WeightedLevels:
    """A-weighted levels of a sound, all re the same value.

    Parameters
    ----------
    level_a : float
        Level of the whole sound [dB].
    level_af_max : float
        Largest level with the time weighting F [dB].
    short : ndarray, shape (n,)
        Level of each complete eighth of a second [dB].
    """

    level_a: float
    level_af_max: float
    short: NDArray[np.float64]


def weighted_levels(
    read: Read, n: int, rate: float, *, reference: float = REFERENCE_PRESSURE
) -> WeightedLevels:
    """Return the A-weighted levels of a sound that is read in pieces.

    Parameters
    ----------
    read : callable
        Function of first and last sample that returns the samples, shape (last - first,), finite.
    n : int
        Samples of the sound.
    rate : float
        Sampling rate [Hz].
    reference : float
        [unit]; 1.0 for levels in dB re full scale.

    Returns
    -------
    WeightedLevels
        Minus infinity for silence. The meter is at rest before the first sample.

    Examples
    --------
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(96000) / 48e3)
    >>> levels = weighted_levels(lambda first, last: tone[first:last], 96000, 48e3)
    >>> round(levels.level_a, 2), round(levels.level_af_max, 2), levels.short.round(1)[1:3].tolist()
    (93.98, 93.98, [94.0, 94.0])
    """
    smoothing, step = math.exp(-1.0 / (FAST * rate)), max(1, round(FAST * rate))
    state, sums = np.zeros(2), np.zeros(-(-n // step))
    first = 0
    for piece, scale in _weighted_pieces(read, n, rate):
        _meter(piece, float(scale) ** 2, smoothing, state, sums, step, first)
        first += piece.size
    level, most = band_levels(np.array([sums.sum() / n, state[1]]), reference).tolist()
    return WeightedLevels(level, most, band_levels(sums[: n // step] / step, reference))


def a_weighted_level(
    signal: ArrayLike, rate: float, *, reference: float = REFERENCE_PRESSURE
) -> float:
    """Return the A-weighted level of a sound.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Sound pressure [Pa], or fractions of full scale.
    rate : float
        Sampling rate [Hz].
    reference : float
        [unit]

    Returns
    -------
    float
        [dB]; minus infinity for silence.

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Examples
    --------
    >>> hum = np.sqrt(2) * np.sin(2 * np.pi * 100 * np.arange(48000) / 48e3)
    >>> round(a_weighted_level(hum, 48e3, reference=1.0), 1)
    -19.1
    """
    x = checked_signal(signal, rate)
    return weighted_levels(_reader(x), x.size, rate, reference=reference).level_a


def _reader(x: NDArray[np.float64]) -> Read:
    return lambda first, last: x[first:last]


@njit(fastmath={"contract"}, cache=True, **COMPILED)
def _meter(
    weighted: NDArray[np.float32],
    unit: float,
    smoothing: float,
    state: NDArray[np.float64],
    sums: NDArray[np.float64],
    step: int,
    first: int,
) -> None:
    """Update the smoothed square and its maximum in `state`, and the sums of each step."""
    smoothed, most = state[0], state[1]
    cell, left = first // step, step - first % step
    total = 0.0
    for i in range(weighted.size):
        square = unit * np.float64(weighted[i]) * np.float64(weighted[i])
        smoothed = smoothing * smoothed + (1.0 - smoothing) * square
        most = max(most, smoothed)
        total += square
        left -= 1
        if left == 0:
            sums[cell] += total
            cell, left, total = cell + 1, step, 0.0
    if total > 0.0:
        sums[cell] += total
    state[0], state[1] = smoothed, most


def a_weighted(signal: ArrayLike, rate: float) -> NDArray[np.float64]:
    """Apply the A-weighting to a sound.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        In any [unit].
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n_samples,)
        In the unit of the sound [unit]. Magnitudes are those of IEC 61672-1:2013, Annex E, up to
        half the sampling rate; phases do not change.

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Examples
    --------
    >>> hum = np.sin(2 * np.pi * 100 * np.arange(48000) / 48e3)
    >>> round(float(20 * np.log10(a_weighted(hum, 48e3)[12000:36000].max())), 1)
    -19.1
    """
    x = checked_signal(signal, rate)
    pieces = _weighted_pieces(_reader(x), x.size, rate)
    return np.concatenate([piece * scale for piece, scale in pieces])


def _weighted_pieces(
    read: Read, n: int, rate: float
) -> Iterator[tuple[NDArray[np.float32], float]]:
    """Yield the weighted sound piece by piece, each with its scale."""
    margin = min(n - 1, round(_MARGIN * rate))
    length = int(fft.next_fast_len(max(16, round(_SEGMENT * rate), 4 * margin), real=True))
    useful = length - 2 * margin
    gain = (10.0 ** (a_weighting(fft.rfftfreq(length, 1.0 / rate)) / 20.0)).astype(np.float32)
    for start in range(0, n, _SEGMENTS_AT_ONCE * useful):
        end = min(n, start + _SEGMENTS_AT_ONCE * useful)
        count = -(-(end - start) // useful)
        longer = _continued(read, n, start - margin, start + count * useful + margin, margin)
        longer = longer - longer.mean()  # inaudible, and it would cost accuracy
        scale = float(max(longer.max(), -longer.min()))
        if scale > 0.0:
            single = (longer / scale).astype(np.float32)
            bins = fft.rfft(sliding_window_view(single, length)[::useful], axis=1)
            bins *= gain
            whole = fft.irfft(bins, length, axis=1)[:, margin : margin + useful]
        else:
            whole = np.zeros((count, useful), dtype=np.float32)
        yield whole.reshape(-1)[: end - start], scale


def _continued(read: Read, n: int, first: int, last: int, margin: int) -> NDArray[np.float64]:
    """Return samples `first` up to `last`, with point reflections of `margin` at the ends."""
    x = read(max(first, 0), min(last, n))
    before, after = max(0, -first), max(0, last - n)
    if before:
        x = np.concatenate([2.0 * x[0] - x[before:0:-1], x])
    if after:
        turned = min(after, margin)
        x = np.concatenate([x, 2.0 * x[-1] - x[-2 : -2 - turned : -1]])
        x = np.concatenate([x, np.full(after - turned, x[-1])])
    return x
