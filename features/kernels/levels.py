"""Levels that a sound level meter shows: overall, A-weighted, the fast maximum, one-third octaves.

Overall levels are mean squares of the whole sound in time, so that a click counts by its energy
wherever it lies. The A-weighting is applied to the sound's transform with the magnitudes that the
standard tabulates; a recursive filter would miss them near half the sampling rate, by several
decibels where a creak is strong. One-third octaves are integrals of the autospectrum, whose
segments are long enough for four bins in the lowest band; a band of fewer bins is not measured.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from features.kernels.bands import a_weighting, band_levels, fine_third_octaves
from features.kernels.conditioning import checked_signal
from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "FAST",
    "SoundLevels",
    "a_weighted",
    "fast_levels",
    "sound_levels",
]

FAST = 0.125
"""Time constant of the weighting F [s] (IEC 61672-1)."""

_MARGIN = 0.25
"""By which a sound is continued on either side, turned about its last sample [s]: cut off, a hum
would click louder than it hums. The lowest pole of the A-weighting has died away by then."""

_BLOCK = 30.0
"""Transformed at once [s], so that a long recording takes little memory."""


@dataclass(frozen=True)
class SoundLevels:
    """Levels of one sound, all re the same value.

    Parameters
    ----------
    level : float
        Of the mean square about the mean [dB].
    level_a : float
        The same, A-weighted [dB].
    level_af_max : float
        Largest A-weighted level with the time weighting F [dB].
    third_octaves : dict of str to float
        [dB] by nominal mid-band frequency; NaN where a band is not measured.
    """

    level: float
    level_a: float
    level_af_max: float
    third_octaves: dict[str, float]

    def raised(self, gain_db: float) -> SoundLevels:
        """Return the levels of the same sound, this much louder.

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
    """Levels of a sound as a whole.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Sound pressure [Pa], or fractions of full scale.
    rate : float
        Sampling rate [Hz]. Bands that it does not reach are NaN.
    reference : float
        [unit]; 1.0 for levels in dB re full scale.

    Returns
    -------
    SoundLevels
        Minus infinity for silence.

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

    Examples
    --------
    >>> t = np.arange(96000) / 48e3
    >>> pascal = sound_levels(np.sqrt(2) * np.sin(2 * np.pi * 1000 * t), 48e3)
    >>> round(pascal.level, 2), round(pascal.level_a, 2), round(pascal.third_octaves["1000"], 2)
    (93.98, 93.98, 93.98)
    """
    x = checked_signal(signal, rate)
    x = x - x.mean()
    weighted = a_weighted(x, rate)
    mean_squares = [np.mean(x**2), np.mean(weighted**2)]
    level, level_a = band_levels(mean_squares, reference).tolist()
    fast = float(fast_levels(weighted, rate, reference=reference).max())
    return SoundLevels(level, level_a, fast, fine_third_octaves(x, rate, reference=reference))


def a_weighted(signal: ArrayLike, rate: float) -> NDArray[np.float64]:
    """Return a sound with the A-weighting on it.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
    rate : float
        In any [unit].
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n_samples,)
        In the sound's own [unit]. Magnitudes are those of IEC 61672-1:2013, Annex E, up to half
        the sampling rate; phases are left as they are.

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

    Examples
    --------
    >>> hum = np.sin(2 * np.pi * 100 * np.arange(48000) / 48e3)
    >>> round(float(20 * np.log10(a_weighted(hum, 48e3)[12000:36000].max())), 1)
    -19.1
    """
    x = checked_signal(signal, rate)
    margin = min(x.size - 1, round(_MARGIN * rate))
    longer = np.pad(x, margin, mode="reflect", reflect_type="odd")
    block = max(1, round(_BLOCK * rate))
    weighted = np.empty_like(x)
    for start in range(0, x.size, block):
        kept = min(block, x.size - start)
        piece = longer[start : start + kept + 2 * margin]
        length = int(fft.next_fast_len(piece.size, real=True))
        bins = fft.rfft(piece, length)
        bins *= 10.0 ** (a_weighting(fft.rfftfreq(length, 1.0 / rate)) / 20.0)
        weighted[start : start + kept] = fft.irfft(bins, length)[margin : margin + kept]
    return weighted


def fast_levels(
    signal: ArrayLike, rate: float, *, reference: float = REFERENCE_PRESSURE
) -> NDArray[np.float64]:
    """Levels over time with the time weighting F.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Frequency-weighted already, where that is wanted.
    rate : float
        Sampling rate [Hz].
    reference : float
        [unit]

    Returns
    -------
    ndarray, shape (n_samples,)
        [dB]; what a meter shows that was at rest before the first sample.

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

    Examples
    --------
    >>> burst = np.sqrt(2) * np.sin(2 * np.pi * 4000 * np.arange(9600) / 48e3)
    >>> round(float(fast_levels(burst, 48e3, reference=1.0).max()), 1)
    -1.0
    """
    from scipy.signal import lfilter

    x = checked_signal(signal, rate)
    kept = float(np.exp(-1.0 / (FAST * rate)))
    smoothed = lfilter([1.0 - kept], [1.0, -kept], x**2)
    return band_levels(smoothed, reference)
