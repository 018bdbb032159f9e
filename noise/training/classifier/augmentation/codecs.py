"""Losses of storage: lossy codecs and few bits.

Vorbis and MP3 are the real ones, through memory, where libsndfile has them; elsewhere their steep
low-pass stands in.
"""

from __future__ import annotations

import io

import numpy as np
import soundfile
from numpy.typing import NDArray
from scipy.signal import firwin, oaconvolve

_AT_ONCE = 4096
"""Frames given to an encoder together; libsndfile's Vorbis encoder overflows its stack on many."""

_MP3_RATES = (16_000, 22_050, 24_000, 32_000, 44_100, 48_000)


def coded(sound: NDArray[np.float64], rate: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Pass through a lossy codec at a random quality; the length stays.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Within -1 to 1 [full scale].
    rate : int
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> tone = 0.5 * np.sin(2 * np.pi * 1e3 * np.arange(24_000) / 48e3)
    >>> decoded = coded(tone, 48_000, np.random.default_rng(0))
    >>> decoded.shape, bool(np.corrcoef(tone, decoded)[0, 1] > 0.9)
    ((24000,), True)
    """
    kind, quality = rng.random(), float(rng.uniform(0.1, 0.8))
    cutoff = min(rng.uniform(10e3, 17e3), 0.45 * rate)
    if kind < 0.45:
        decoded = _round_trip(sound, rate, "OGG", "VORBIS", quality)
    elif kind < 0.75 and rate in _MP3_RATES:
        decoded = _round_trip(sound, rate, "MP3", "MPEG_LAYER_III", quality)
    else:
        decoded = None
    if decoded is None:
        return np.asarray(oaconvolve(sound, firwin(101, cutoff, fs=rate), mode="same"))
    return decoded


def quantised(
    sound: NDArray[np.float64], bits: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Round to so many bits of full scale 1, with or without dither; clip at full scale.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [full scale]
    bits : int
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [full scale]

    Examples
    --------
    >>> quantised(np.array([0.3, 2.0]), 2, np.random.default_rng(1)).tolist()
    [0.5, 0.5]
    """
    steps = 2.0 ** (bits - 1)
    dither = rng.uniform(-0.5, 0.5, sound.size) if rng.random() < 0.3 else 0.0
    return np.asarray(np.clip(np.round(sound * steps + dither), -steps, steps - 1.0) / steps)


def _round_trip(
    sound: NDArray[np.float64], rate: int, container: str, subtype: str, quality: float
) -> NDArray[np.float64] | None:
    """Encode and decode in memory; ``None`` where libsndfile cannot."""
    if container not in soundfile.available_formats():
        return None
    memory = io.BytesIO()
    try:
        with soundfile.SoundFile(
            memory, "w", rate, 1, subtype, format=container, compression_level=1.0 - quality
        ) as file:
            for first in range(0, sound.size, _AT_ONCE):
                file.write(sound[first : first + _AT_ONCE])
        memory.seek(0)
        decoded, _ = soundfile.read(memory)
    except (soundfile.LibsndfileError, TypeError):  # an older soundfile has no quality to set
        return None
    if decoded.size < sound.size:
        decoded = np.pad(decoded, (0, sound.size - decoded.size))
    return np.asarray(decoded[: sound.size])
