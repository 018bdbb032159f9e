"""Levels of a sound that is read in parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from features.kernels.bands import (
    THIRD_OCTAVE_RESOLUTION,
    band_levels,
    resolved_third_octaves,
)
from features.kernels.levels import SoundLevels, sound_levels, weighted_levels
from features.long.parts import LONG, in_pieces
from features.long.sums import WelchSum
from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from features.long.parts import Read
    from features.long.sums import Moments

__all__ = ["long_sound_levels"]


def long_sound_levels(
    read: Read,
    n_samples: int,
    rate: float,
    moments: Moments,
    *,
    reference: float = REFERENCE_PRESSURE,
) -> SoundLevels:
    """Tell `features.kernels.levels.sound_levels` of a sound of any length.

    Parameters
    ----------
    read : callable
        From first and last sample to the samples between them, shape (n,), finite.
    n_samples : int
        Of the sound.
    rate : float
        Sampling rate [Hz].
    moments : Moments
        Of the sound [unit].
    reference : float
        [unit]; 1.0 for levels in dB re full scale.

    Returns
    -------
    SoundLevels

    Raises
    ------
    ParameterError
        A sound that can't be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> from features.long.sums import Moments
    >>> tone, moments = np.sqrt(2) * np.sin(2 * np.pi * np.arange(96000) / 48), Moments()
    >>> moments.add(tone)
    >>> pascal = long_sound_levels(lambda first, last: tone[first:last], 96000, 48e3, moments)
    >>> round(pascal.level, 2), round(pascal.third_octaves["1000"], 2)
    (93.98, 93.98)
    """
    if n_samples < LONG:
        return sound_levels(read(0, n_samples), rate, reference=reference)
    spectrum = WelchSum(n_samples, rate, THIRD_OCTAVE_RESOLUTION)
    for piece in in_pieces(read, n_samples)():
        spectrum.add(piece)
    mean = moments.mean
    weighted = weighted_levels(
        lambda first, last: read(first, last) - mean, n_samples, rate, reference=reference
    )
    return SoundLevels(
        float(band_levels(moments.variance, reference)),
        weighted.level_a,
        weighted.level_af_max,
        resolved_third_octaves(spectrum.spectrum(), reference=reference),
    )
