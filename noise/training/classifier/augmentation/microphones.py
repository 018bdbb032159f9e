"""Microphones and what recorders do behind them: a band, a gain that follows, a limit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.signal import lfilter

from noise.training.draws import coloured_noise, log_uniform, low_pass, wandering

_BANDS = {
    "free": ((15.0, 250.0), (5e3, 20e3), 2, 4.0),
    "phone": ((80.0, 250.0), (6.5e3, 12e3), 4, 7.0),
    "pocket": ((80.0, 250.0), (700.0, 3e3), 3, 8.0),
    "stethoscope": ((30.0, 150.0), (800.0, 3e3), 4, 12.0),
}
"""Between which frequencies the ends of the band lie [Hz], order, and most of the ripple [dB]."""


def through_a_microphone(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator, *, kind: str = "free"
) -> NDArray[np.float64]:
    """Colour by slopes at both ends of the band and a gentle ripple between.

    A phone's band is narrower, 100 Hz to 8 kHz or so, and steeper, of second order; its ripple
    larger. In a pocket it hears little above 2 kHz, and cloth that rubs; a stethoscope's membrane
    and tube end about there too, and resound.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator
    kind : {"free", "phone", "pocket", "stethoscope"}

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> through_a_microphone(np.ones(480), 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    m = next_fast_len(sound.size, real=True)
    frequency = rfftfreq(m, 1.0 / rate)
    lows, highs, order, most = _BANDS[kind]
    low, high = log_uniform(*lows, rng), log_uniform(*highs, rng)
    gain = 1.0 / np.sqrt(
        (1.0 + (low / np.maximum(frequency, 1.0)) ** order) * (1.0 + (frequency / high) ** order)
    )
    octaves = np.log2(np.maximum(frequency, 20.0) / 1e3)
    ripple = np.sin(rng.uniform(1.0, 4.0) * octaves + rng.uniform(0.0, 6.3))
    gain *= 10.0 ** (rng.uniform(0.0, most) / 20.0 * ripple)
    heard = irfft(rfft(sound, m) * gain, m)[: sound.size]
    return heard + _rubbing(heard, rate, rng) if kind == "pocket" else np.asarray(heard)


def _rubbing(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return what cloth adds that moves against the microphone: soft noise that comes and goes."""
    n = sound.size
    noise = low_pass(coloured_noise(n, rng.uniform(0.5, 1.5), rng), rng.uniform(500, 4000), rate)
    strokes = np.maximum(wandering(n, rate, log_uniform(0.5, 6.0, rng), rng), 0.0) ** 2
    return np.asarray(10.0 ** rng.uniform(-2.0, -0.5) * sound.std() * strokes * noise / noise.std())


def levelled(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Compress as an automatic gain does: the gain falls as the smoothed level rises.

    The level of the output rises by 1 dB where that of the input rises by 1.3 to 4 dB.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> quiet_then_loud = np.repeat([0.01, 1.0], 48_000) * np.sin(np.arange(96_000))
    >>> even = levelled(quiet_then_loud, 48e3, np.random.default_rng(0))
    >>> bool(np.std(even[60_000:]) < 60.0 * np.std(even[:40_000]))
    True
    """
    time = rng.uniform(0.02, 0.4)
    pole = math.exp(-1.0 / (time * rate))
    power = lfilter([1.0 - pole], [1.0, -pole], sound**2)
    floor = 1e-4 * float(np.mean(sound**2)) + 1e-300
    exponent = 0.5 * (1.0 - 1.0 / rng.uniform(1.3, 4.0))
    return np.asarray(sound * (power + floor) ** -exponent)


def clipped(sound: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Limit to 30-90 % of the peak, hard or softly.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> wave = np.sin(np.arange(100.0))
    >>> bool(np.abs(clipped(wave, np.random.default_rng(0))).max() < 0.95)
    True
    """
    limit = rng.uniform(0.3, 0.9) * float(np.abs(sound).max())
    if not limit > 0.0:
        return sound
    if rng.random() < 0.5:
        return np.clip(sound, -limit, limit)
    return np.asarray(limit * np.tanh(sound / limit))
