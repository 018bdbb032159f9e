"""Random draws for synthetic sounds and rigs: noise, smooth trajectories, choices, a low-pass."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal import lfilter

from noise.base import log_uniform as log_uniform
from noise.base.arrays import Array, Rng

Span = tuple[float, float]
"""Start and end of a sound in a recording [s]."""


def coloured_noise(n: int, slope: float, rng: Rng) -> Array:
    """Return noise of unit standard deviation with a spectral density of ``f ** -slope``.

    Parameters
    ----------
    n : int
        Number of samples.
    slope : float
        Exponent [-]; 0 is white noise, 1 pink noise.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> noise = coloured_noise(1000, 1.0, np.random.default_rng(0))
    >>> round(float(noise.std()), 6)
    1.0
    """
    m = next_fast_len(n, real=True)
    spectrum = rfft(rng.standard_normal(m))
    frequency = np.arange(spectrum.size, dtype=float)
    frequency[0] = 1.0
    noise = irfft(spectrum * frequency ** (-0.5 * slope), m)[:n]
    return np.asarray(noise / noise.std())


def wandering(n: int, rate: float, frequency: float, rng: Rng) -> Array:
    """Return a smooth random trajectory, mostly within -1 to 1.

    Parameters
    ----------
    n : int
        Number of samples.
    rate, frequency : float
        Sampling rate, and highest frequency of the trajectory [Hz].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> course = wandering(4800, 48e3, 2.0, np.random.default_rng(0))
    >>> course.shape, bool(np.abs(np.diff(course)).max() < 0.01)
    ((4800,), True)
    """
    step = rate / (2.0 * frequency)
    knots = rng.uniform(-1.0, 1.0, int(n / step) + 4)
    place = np.arange(n) / step + 1.0 + rng.random()
    left = place.astype(int)
    x = place - left
    # Catmull-Rom spline through the knots.
    a, b, c, d = (knots[np.minimum(left + shift, knots.size - 1)] for shift in (-1, 0, 1, 2))
    course = b + 0.5 * x * (c - a + x * (2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)))
    return np.asarray(course)


def low_pass(x: Array, corner: float, rate: float) -> Array:
    """Return a signal after a first-order low-pass filter.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Signal [any unit].
    corner, rate : float
        Corner frequency and sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [unit of `x`]

    Examples
    --------
    >>> bool(abs(low_pass(np.ones(4800), 1e3, 48e3)[-1] - 1.0) < 1e-6)
    True
    """
    pole = math.exp(-2.0 * math.pi * corner / rate)
    return np.asarray(lfilter([1.0 - pole], [1.0, -pole], x))


def picked(shares: Mapping[str, float], rng: Rng) -> str:
    """Draw a name with given probabilities.

    Parameters
    ----------
    shares : mapping of str to float
        Relative probability of each name; they need not sum to one [-].
    rng : numpy.random.Generator

    Returns
    -------
    str

    Examples
    --------
    >>> picked({"creak": 0.0, "squeal": 2.0}, np.random.default_rng(0))
    'squeal'
    """
    weights = np.array(list(shares.values()))
    return list(shares)[int(rng.choice(weights.size, p=weights / weights.sum()))]
