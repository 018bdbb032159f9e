"""Background noise of rooms, cabins, roads and wind, and recordings of quiet."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from noise.training.classifier.augmentation.places import place
from noise.training.draws import coloured_noise, log_uniform, picked

_QUIETS = {
    "hiss": 0.12, "hum": 0.14, "background": 0.09, "sliding": 0.07, "place": 0.56, "silence": 0.02,
}  # fmt: skip
"""Shares of the kinds of quiet [-]."""


def background(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return steady noise of a room, a cabin, a road or wind, of unit standard deviation.

    The noise of a cabin falls by 6 to 10 dB per octave, with weak engine orders; that of tyres has
    a hump at 150-1000 Hz; wind has low frequencies and gusts.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> float(background(4800, 48e3, np.random.default_rng(1)).std().round(6))
    1.0
    """
    kind = rng.random()
    if kind < 0.5:
        return coloured_noise(n, rng.uniform(0.0, 2.0), rng)
    if kind < 0.7:
        noise = coloured_noise(n, rng.uniform(1.8, 3.2), rng)
        if rng.random() < 0.5:
            noise = noise + _engine_orders(n, rate, rng)
    elif kind < 0.85:
        noise = _hump(n, rate, rng) + rng.uniform(0.2, 1.0) * coloured_noise(n, 1.5, rng)
    else:
        gust = coloured_noise(n, 3.0, rng)
        noise = coloured_noise(n, rng.uniform(1.5, 2.5), rng) * np.exp(
            0.5 * rng.uniform(0.0, 1.0) * gust
        )
    return np.asarray(noise / noise.std())


def _engine_orders(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    time = np.arange(n) / rate
    firing = rng.uniform(25.0, 120.0)
    orders = np.zeros(n)
    for k in (0.5, 1.0, 1.5, 2.0, 3.0):
        strength = rng.uniform(0.0, 0.5) / k
        orders += strength * np.sin(2.0 * np.pi * (k * firing * time + rng.random()))
    return orders


def _hump(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return noise in a band of one or two octaves."""
    m = next_fast_len(n, real=True)
    spectrum = rfft(rng.standard_normal(m))
    frequency = np.maximum(np.arange(spectrum.size) * rate / m, 1.0)
    centre = log_uniform(150.0, 1000.0, rng)
    octaves = np.log2(frequency / centre) / rng.uniform(0.5, 1.5)
    noise = irfft(spectrum * np.exp(-0.5 * octaves**2), m)[:n]
    return np.asarray(noise / noise.std())


def quiet(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a random recording of quiet: a place, hiss, hum, background, sliding, silence.

    More than half are cabins and halls without people. Hum is of the mains or a transformer, 50 to
    120 Hz, with up to 20 harmonics, of which odd ones may be stronger. Steady sliding hisses
    without lines.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> quiet(480, 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    kind = picked(_QUIETS, rng)
    if kind == "silence":
        return np.zeros(n)
    if kind == "place":
        return place(n, rate, rng, peopled=False)
    if kind == "background":
        return background(n, rate, rng)
    noise = coloured_noise(n, rng.uniform(0.0, 2.2), rng)
    if kind == "hum":
        return noise + _hum(n, rate, rng)
    if kind == "sliding":
        octaves = coloured_noise(n, rng.uniform(0.0, 1.5), rng)
        return np.asarray(noise + rng.uniform(0.0, 2.0) * np.diff(octaves, prepend=octaves[0]))
    return noise


def _hum(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    time = np.arange(n) / rate
    mains = float(rng.choice((50.0, 60.0, 100.0, 120.0))) * rng.uniform(0.999, 1.001)
    loud = 10.0 ** rng.uniform(-0.3, 1.7)
    roll_off = rng.uniform(0.3, 2.5)
    odd = rng.random() < 0.5
    hum = np.zeros(n)
    for k in range(1, int(rng.integers(2, 21))):
        strength = loud * k**-roll_off * rng.lognormal(0.0, 0.5)
        if odd and k % 2 == 0:
            strength *= 0.1
        hum += strength * np.sin(2 * math.pi * (k * mains * time + rng.random()))
    return hum
