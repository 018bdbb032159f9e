"""Sound quality: loudness, sharpness, roughness and prominent tones.

The standards' procedures are those of MoSQITo (Apache-2.0), an optional extra that is imported at
first use, which takes a second. Inputs that it accepts silently are refused here: sounds too short
for its filters and windows, and rates other than 48 kHz. Silence has a loudness of zero and neither
sharpness nor tone.

Sound arrives from the front, in a free field. Roughness is that of Daniel and Weber, the mean of
its windows of 200 ms. Tones are determined second by second, so that a run-up does not smear them.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.conditioning import checked_signal
from models.errors import ParameterError, not_installed

SOUND_QUALITY_RATE = 48000
"""Sampling rate of the procedures' tables [Hz]."""

SHORTEST = 0.5
"""Shortest sound with a sound quality [s]."""

_OVER_N5 = 95.0
"""Percentile that is exceeded in 5 % of the time [%]."""

_BLOCK = 1.0
"""Length of the blocks in which tones are determined [s]."""


@dataclass(frozen=True)
class SoundQuality:
    """Psychoacoustic measures of a sound.

    Parameters
    ----------
    loudness : float
        ISO 532-1, method for stationary sounds [sone].
    loudness_n5, loudness_n10 : float
        ISO 532-1, method for time-varying sounds: exceeded in 5 and 10 % of the time [sone].
    sharpness : float
        DIN 45692 [acum]; NaN for an inaudible sound.
    roughness : float
        Daniel and Weber (1997) [asper].
    tone_to_noise : float
        Largest tone-to-noise ratio of a prominent tone, ECMA-418-1 [dB]; NaN without such a tone.
    prominence : float
        Largest prominence ratio of a prominent tone, ECMA-418-1 [dB]; NaN without such a tone.
    tone_frequency : float
        Frequency of the tone with the largest prominence ratio [Hz]; NaN without such a tone.
    """

    loudness: float
    loudness_n5: float
    loudness_n10: float
    sharpness: float
    roughness: float
    tone_to_noise: float
    prominence: float
    tone_frequency: float


def check_available() -> None:
    """Raise if the extra is not installed.

    Raises
    ------
    ParameterError
        MoSQITo is not installed.

    Examples
    --------
    >>> from importlib.util import find_spec
    >>> if find_spec("mosqito"):
    ...     check_available()
    """
    _library()


def sound_quality_of(pressure: ArrayLike, rate: float) -> SoundQuality:
    """Compute the psychoacoustic measures of a sound.

    Parameters
    ----------
    pressure : array_like, shape (n_samples,)
        Sound pressure [Pa]; half a second or longer.
    rate : float
        Sampling rate [Hz]: `SOUND_QUALITY_RATE`.

    Returns
    -------
    SoundQuality

    Raises
    ------
    ParameterError
        The extra is not installed, or the sound is too short, has another rate, or cannot be
        analysed.

    Notes
    -----
    ISO 532-1:2017; DIN 45692:2009; ECMA-418-1:2021; P. Daniel and R. Weber, Psychoacoustical
    roughness: implementation of an optimized model, Acustica 83 (1997) 113-123.

    Examples
    --------
    >>> tone = 2e-3 * np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(24000) / 48e3)  # 40 dB
    >>> from importlib.util import find_spec
    >>> round(sound_quality_of(tone, 48000).loudness, 1) if find_spec("mosqito") else 1.0
    1.0
    """
    x = _long_enough(pressure, rate)
    library = _library()
    x = x - x.mean()
    fs = SOUND_QUALITY_RATE
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # silence divides by zero; its result is NaN
        loudness = float(library.loudness_zwst(x, fs)[0])
        over_time = np.asarray(library.loudness_zwtv(x, fs)[0])
        sharpness = float(library.sharpness_din_st(x, fs)) if loudness > 0.0 else math.nan
        roughness = float(np.mean(library.roughness_dw(x, fs, overlap=0)[0]))
        tone_to_noise, _ = _strongest_tone(library.tnr_ecma_st, x)
        prominence, frequency = _strongest_tone(library.pr_ecma_st, x)
    n5, n10 = np.percentile(over_time, [_OVER_N5, 90.0]).tolist()
    return SoundQuality(
        loudness, n5, n10, sharpness, roughness, tone_to_noise, prominence, frequency
    )


def loudness_n5(pressure: ArrayLike, rate: float) -> float:
    """Return the loudness exceeded in 5 % of the time, ISO 532-1 for time-varying sounds.

    It takes a sixth of the time of `sound_quality_of`.

    Parameters
    ----------
    pressure : array_like, shape (n_samples,)
        [Pa]
    rate : float
        Sampling rate [Hz], 48 kHz.

    Returns
    -------
    float
        [sone]

    Raises
    ------
    ParameterError
        The procedures do not support the sound or its rate, or MoSQITo is not installed.

    Examples
    --------
    >>> tone = 2e-3 * np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(24000) / 48e3)  # 40 dB
    >>> from importlib.util import find_spec
    >>> round(loudness_n5(tone, 48000), 1) if find_spec("mosqito") else 1.0
    1.0
    """
    x = _long_enough(pressure, rate)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        over_time = np.asarray(_library().loudness_zwtv(x - x.mean(), SOUND_QUALITY_RATE)[0])
    return float(np.percentile(over_time, _OVER_N5))


def _long_enough(pressure: ArrayLike, rate: float) -> NDArray[np.float64]:
    """Check that the procedures support a sound, and return it as an array."""
    x = checked_signal(pressure, rate)
    if rate != SOUND_QUALITY_RATE:
        raise ParameterError(f"sound quality needs 48000 Hz; resample from {rate:g} Hz first")
    if x.size < SHORTEST * rate:
        raise ParameterError(
            f"sound of {x.size / rate:.3g} s is too short for sound quality; give "
            f"{SHORTEST:g} s or more"
        )
    return x


def _strongest_tone(
    ratios: Callable[[NDArray[np.float64], int], tuple[Any, Any, Any, Any]], x: NDArray[np.float64]
) -> tuple[float, float]:
    """Return the largest ratio of a prominent tone in any block, and its frequency."""
    n_blocks = max(1, int(x.size / (_BLOCK * SOUND_QUALITY_RATE)))
    best = (math.nan, math.nan)
    for block in np.array_split(x, n_blocks):
        if not block.any():
            continue
        _, ratio, _, frequency = ratios(block, SOUND_QUALITY_RATE)
        for value, where in zip(ratio, frequency, strict=True):
            if not float(value) <= best[0]:
                best = (float(value), float(where))
    return best


def _library() -> Any:
    try:
        return import_module("mosqito")
    except ImportError:
        raise ParameterError(
            not_installed("sound quality needs", "MoSQITo", "sound-quality")
        ) from None
