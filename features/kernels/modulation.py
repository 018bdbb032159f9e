"""Modulation: whether the loudness of a noise beats, how fast, how deeply.

A regular creak beats at its slip frequency, a helicopter at its blades', speech with no rate that
lasts. Counting pulses fails where they run into each other; the envelope still repeats. Its period
is that of its autocorrelation, like the period of the vibration itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from features.kernels.conditioning import band_signal, forward
from features.kernels.periodicity import Period, strongest_period

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["MODULATION_BAND", "Modulation", "described_modulation", "modulation"]

MODULATION_BAND = (2.0, 400.0)
"""Rates of modulation that are looked at [Hz]."""

_LEAST_DEPTH = 0.01
"""Depth below which a rate means nothing: the ripple that filters leave."""

_LEAST_STRENGTH = 0.2
"""Autocorrelation below which an envelope counts as not repeating: that of noise reaches it."""


class Modulation(NamedTuple):
    """Modulation of an envelope.

    Parameters
    ----------
    rate : float
        Of its strongest repetition [Hz]; NaN if it does not repeat.
    strength : float
        Normalised autocorrelation of the envelope there, 0 to 1 [-].
    depth : float
        Standard deviation of the envelope between 2 and 400 Hz over its mean: 0.71 for a sinusoidal
        modulation of 100 %.
    """

    rate: float
    strength: float
    depth: float


def modulation(envelope: NDArray[np.float64], rate: float) -> Modulation:
    """Describe the modulation of an envelope.

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
    low, high = MODULATION_BAND
    transform = forward(envelope - mean, rate)
    beats, beat_rate = band_signal(transform, low, min(high, 0.4 * rate))
    return described_modulation(
        mean,
        float(np.std(beats)),
        lambda: strongest_period(beats, beat_rate, lowest=low, highest=high, whiten=False),
    )


def described_modulation(mean: float, deviation: float, period: Callable[[], Period]) -> Modulation:
    """Describe the modulation of an envelope of which the numbers are at hand.

    Parameters
    ----------
    mean : float
        Of the envelope, in any [unit].
    deviation : float
        Standard deviation of its part within `MODULATION_BAND` [unit].
    period : callable
        Gives the period of that part.

    Returns
    -------
    Modulation

    Examples
    --------
    >>> described_modulation(2.0, 0.0, lambda: Period(80.0, 1.0)).depth
    0.0
    """
    if not mean > 0.0:
        return Modulation(math.nan, 0.0, 0.0)
    depth = deviation / mean
    if depth < _LEAST_DEPTH:
        return Modulation(math.nan, 0.0, depth)
    rate, strength = period()
    return Modulation(rate if strength >= _LEAST_STRENGTH else math.nan, strength, depth)
