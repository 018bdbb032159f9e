"""Gain of sound files, stated as the value of a full-scale sample.

There are three ways to choose it. Calibrated: a listening room is set to so many pascals at full
scale, and a sound that would clip there is refused. Common: one full scale for all sounds of a
set, so that the louder one stays louder by as much as it was. Matched: each sound is brought to
the same loudness, so that what is compared is its character; the loudness is that of ITU-R
BS.1770 with the target and the true peak of EBU R 128, because programme meters everywhere can
check it, and because, unlike the loudness of ISO 532-1, a gain shifts it by exactly so many units.

The peak that must not clip is that of the curve through the samples, as a converter draws it, not
the largest sample.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from noise.audio.sound import resampled

LOUDNESS_BLOCK = 0.4
"""Shortest sound that has a loudness [s] (ITU-R BS.1770)."""

_FILTERS = "DeMan"
"""The set of filters that is within 0.002 dB of the standard's table; the default is 0.04 off."""

QUIETEST_FULL_SCALE = 0.1
"""By default no calibrated sound is amplified beyond this full scale [Pa]: silence stays silent."""

CEILING = 0.999
"""Largest true peak that is written, of full scale: rounding and dither stay below it as well."""

TARGET_LOUDNESS = -23.0
"""Of matched sounds [LUFS] (EBU R 128), where none of them has to be quieter for its peaks."""

TARGET_TRUE_PEAK = -1.0
"""Largest true peak of matched sounds [dB re full scale] (EBU R 128)."""

_HEADROOM = 3.0
"""Of the largest peak of sounds with one gain [dB]."""

_OVERSAMPLING = 4
"""ITU-R BS.1770, Annex 2, at 44.1 and 48 kHz."""

_BLOCK, _MARGIN = 1 << 19, 1 << 9
"""Samples oversampled at once, and how many beyond them the filter looks at."""


def common_full_scale(signals: Iterable[NDArray[np.float64]]) -> float:
    """Return the common full scale of a set of sounds, 3 dB above their largest peak.

    Parameters
    ----------
    signals : iterable of ndarray, shape (n_samples,)
        Sounds [unit of the sound], the same for all.

    Returns
    -------
    float
        Value of a full-scale sample [unit of the sound]; 1 where all are silent.

    Examples
    --------
    >>> quiet, loud = np.array([0.0, 0.1]), np.array([0.0, -2.0])
    >>> round(common_full_scale([quiet, loud]), 3)
    2.825
    """
    peak = max((float(np.abs(signal).max(initial=0.0)) for signal in signals), default=0.0)
    return peak * 10.0 ** (_HEADROOM / 20.0) or 1.0


def full_scale_without_clipping(peak: float) -> float:
    """Return the smallest full scale [unit of the peak] with a true peak below `CEILING`.

    It is rounded up to four digits.

    Examples
    --------
    >>> full_scale_without_clipping(2.0)
    2.003
    """
    return _rounded_up(peak / CEILING)


def true_peak(samples: NDArray[np.float64], rate: float) -> float:
    """Return the true peak, between samples, in their unit.

    Parameters
    ----------
    samples : ndarray, shape (n_samples,)
        [unit of the sound]
    rate : float
        Sampling rate [Hz].

    Notes
    -----
    ITU-R BS.1770-5, Annex 2: four times the sampling rate. The largest sample counts as well.

    Examples
    --------
    >>> between = np.sin(2 * np.pi * (np.arange(480) + 0.5) / 4)  # each sample beside a peak
    >>> round(float(between.max()), 3), round(true_peak(between * np.hanning(480), 48000), 2)
    (0.707, 1.0)
    """
    peak = float(np.abs(samples).max(initial=0.0))
    for start in range(0, samples.size, _BLOCK):
        before = min(start, _MARGIN)
        piece = samples[start - before : start + _BLOCK + _MARGIN]
        finer = resampled(piece, rate, _OVERSAMPLING * rate)[_OVERSAMPLING * before :]
        peak = max(peak, float(np.abs(finer[: _OVERSAMPLING * _BLOCK]).max()))
    return peak


def loudness(samples: NDArray[np.float64], rate: int) -> float:
    """Return the integrated loudness of a mono sound.

    Parameters
    ----------
    samples : ndarray, shape (n_samples,)
        Over full scale [-].
    rate : int
        Sampling rate [Hz].

    Returns
    -------
    float
        [LUFS]; minus infinity where nothing reaches -70 LUFS.

    Raises
    ------
    ParameterError
        The sound is shorter than `LOUDNESS_BLOCK`.

    Notes
    -----
    ITU-R BS.1770 with its gates, by pyloudnorm.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 997 * np.arange(96000) / 48e3)
    >>> round(loudness(tone, 48000), 1)
    -3.0
    """
    if samples.size < LOUDNESS_BLOCK * rate:
        raise ParameterError(
            f"a sound of {samples.size / rate:.3g} s has no loudness to be matched; "
            f"ITU-R BS.1770 needs {LOUDNESS_BLOCK:g} s"
        )
    import pyloudnorm

    meter = pyloudnorm.Meter(rate, filter_class=_FILTERS, block_size=LOUDNESS_BLOCK)
    return float(meter.integrated_loudness(samples))


def matched_loudness(loudest: Sequence[float]) -> float:
    """Return the common target loudness of a set of sounds.

    Parameters
    ----------
    loudest : sequence of float
        Of each sound [LUFS], its true peak being at full scale.

    Returns
    -------
    float
        [LUFS]: `TARGET_LOUDNESS`, or less where a true peak would exceed `TARGET_TRUE_PEAK`.

    Examples
    --------
    >>> matched_loudness([-10.0, -30.0])
    -31.0
    """
    return min([TARGET_LOUDNESS, *(value + TARGET_TRUE_PEAK for value in loudest)])


def matched_full_scale(samples: NDArray[np.float64], rate: int, target: float) -> float:
    """Return the full scale at which a sound has a given loudness [LUFS].

    Parameters
    ----------
    samples : ndarray, shape (n_samples,)
        [unit of the sound]
    rate : int
        Sampling rate [Hz].
    target : float
        [LUFS]

    Returns
    -------
    float
        [unit of the sound]

    Raises
    ------
    ParameterError
        The sound is too short, or silent.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 997 * np.arange(96000) / 48e3)
    >>> round(matched_full_scale(3.0 * tone, 48000, -23.0), 1)
    30.0
    """
    full_scale = float(np.abs(samples).max(initial=0.0))
    if full_scale == 0.0:
        raise ParameterError("a silent sound has no loudness to be matched")
    for _ in range(4):  # the absolute gate moves with the gain
        reached = loudness(samples / full_scale, rate)
        if not math.isfinite(reached):
            raise ParameterError("a sound below -70 LUFS has no loudness to be matched")
        if reached == target:
            break
        full_scale *= 10.0 ** ((reached - target) / 20.0)
    return full_scale


def _rounded_up(value: float) -> float:
    """Round up to four digits."""
    if value == 0.0:
        return 0.0
    digit = 10.0 ** (math.floor(math.log10(value)) - 3)
    up = math.ceil(value / digit) * digit
    rounded = float(f"{up:.4g}")
    return rounded if rounded >= value else float(f"{up + digit:.4g}")
