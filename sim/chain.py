"""The linear way from torque to sound as effects change it.

An effect of structure or radiation gives other impulse responses rather than other signals. So it
acts on the run in memory and on the one in blocks alike, and such effects can be combined in any
order. They draw their random numbers from a stream of their own, for the same reason.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import fftconvolve, lfilter

from models.structure.modal import DECAY_EXPONENT

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from sim.effects.effect import ActiveEffect

__all__ = ["HIGHEST_SHARE", "changed_chain", "filter_pressure", "padded_sum", "resonance"]

HIGHEST_SHARE = 0.45
"""Modes above this share of the sampling rate are left out."""

_LONGEST = 2.0
"""A resonance is followed so long at most [s]."""


def changed_chain(
    paths: ImpulseResponses, effects: Sequence[ActiveEffect], rng: np.random.Generator
) -> ImpulseResponses:
    """Apply all effects that act on the chain.

    Parameters
    ----------
    paths : ImpulseResponses
        Of the plain model.
    effects : sequence of ActiveEffect
        Those without a part in the chain are passed over.
    rng : numpy.random.Generator
        Of effects that scatter.

    Returns
    -------
    ImpulseResponses

    Examples
    --------
    >>> from models.radiation.impulse_responses import ImpulseResponses
    >>> from sim.effects import EFFECTS
    >>> one = np.ones(1)
    >>> plain = ImpulseResponses(48e3, one, one, one, one)
    >>> floor = EFFECTS["room_reflections"].active({"form": "floor"})
    >>> changed = changed_chain(plain, [floor], np.random.default_rng(0))
    >>> changed.torque_to_acceleration.size, changed.torque_to_pressure.size
    (1, 254)
    """
    for active in effects:
        if active.effect.chain is not None:
            paths = active.effect.chain(paths, active.form, active.values, rng)
    return paths


def resonance(
    numerator: Sequence[float], frequency: float, damping_ratio: float, rate: float
) -> NDArray[np.float64]:
    """Impulse response of a mode, until it has died away.

    Parameters
    ----------
    numerator : sequence of 3 floats
        In falling powers of s / omega [-], over s^2 / omega^2 + 2 zeta s / omega + 1.
    frequency : float
        Undamped natural frequency, below half of `rate` [Hz].
    damping_ratio : float
        [-]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [-], exact at the natural frequency (bilinear transform).

    Examples
    --------
    >>> ringing = resonance([1.0, 0.0, 0.0], 1000.0, 0.05, 96e3)
    >>> turn = np.exp(-2j * np.pi * 1000.0 / 96e3 * np.arange(ringing.size))
    >>> round(float(abs(ringing @ turn)), 3)
    10.0
    """
    share = frequency / rate
    c = 1.0 / math.tan(math.pi * share)
    b, a = _bilinear(numerator, c), _bilinear((1.0, 2.0 * damping_ratio, 1.0), c)
    dying = DECAY_EXPONENT / (2.0 * np.pi * share * damping_ratio)
    unit = np.zeros(int(min(dying, _LONGEST * rate)) + 2)
    unit[0] = 1.0
    return np.asarray(lfilter(b, a, unit))


def _bilinear(p: Sequence[float], c: float) -> list[float]:
    """Polynomial of second order in s, times (z + 1)^2, for s = c (z - 1) / (z + 1)."""
    high, middle, low = p[0] * c * c, p[1] * c, p[2]
    return [high + middle + low, 2.0 * (low - high), high - middle + low]


def padded_sum(signals: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Sum of responses of different lengths, each of shape (n,) and in one [unit].

    Examples
    --------
    >>> padded_sum([np.ones(3), np.ones(1)])
    array([2., 1., 1.])
    """
    listed = list(signals)
    added = np.zeros(max(signal.size for signal in listed))
    for signal in listed:
        added[: signal.size] += signal
    return added


def filter_pressure(paths: ImpulseResponses, taps: NDArray[np.float64]) -> ImpulseResponses:
    """Send both paths to the pressure through a further filter; nothing else changes.

    Parameters
    ----------
    paths : ImpulseResponses
    taps : ndarray, shape (n,)
        Impulse response of the filter, at the rate of the paths [-].

    Returns
    -------
    ImpulseResponses
        Pressures longer by n - 1 samples.

    Examples
    --------
    >>> from models.radiation.impulse_responses import ImpulseResponses
    >>> one = np.ones(1)
    >>> plain = ImpulseResponses(48e3, one, one, one, one)
    >>> filter_pressure(plain, np.array([1.0, 0.5])).torque_to_pressure
    array([1. , 0.5])
    """
    return replace(
        paths,
        torque_to_pressure=fftconvolve(paths.torque_to_pressure, taps),
        pulse_to_pressure=fftconvolve(paths.pulse_to_pressure, taps),
    )
