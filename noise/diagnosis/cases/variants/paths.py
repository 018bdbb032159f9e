"""Parts of the variants that change the way from torque to sound: other modes, other waves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import map_coordinates

from sim.chain import HIGHEST_SHARE, padded_sum, resonance

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses
    from noise.diagnosis.cases.variants.common import Array


_LONGEST = 0.25
"""Waves are followed so long at most [s]."""

_BAND = (200.0, 6000.0)
"""In which a level is taken [Hz]."""

Mode = tuple[float, float, float]
"""Frequency [Hz], damping ratio, strength with its sense."""


def waveguide(rate: float, first: float, reflection: float, dullness: float) -> Array:
    """Impulse response of a way that a wave goes to and fro, its echoes without the first pass.

    Parameters
    ----------
    rate, first : float
        Sampling rate; how often a second it returns [Hz].
    reflection : float
        Signed, below 1 in magnitude [-].
    dullness : float
        From 0 to 0.5: of what is reflected, how much is smoothed away at the highest frequencies
        [-].

    Returns
    -------
    ndarray, shape (n,)
        Over the impulse [-].

    Examples
    --------
    >>> waveguide(8.0, 2.0, 0.5, 0.0)[:9]
    array([0.  , 0.  , 0.  , 0.  , 0.5 , 0.  , 0.  , 0.  , 0.25])
    """
    way = max(2, round(rate / first))
    passes = int(np.log(1e-4) / np.log(abs(reflection)))
    n = int(min(passes * way + way, max(_LONGEST * rate, 3 * way)))
    echoes = np.zeros(n)
    echo = reflection * np.array([0.5 * dullness, 1.0 - dullness, 0.5 * dullness])
    wave = echo
    for middle in range(way, n, way):
        half = wave.size // 2
        stop = min(middle + half + 1, n)
        echoes[middle - half : stop] += wave[: stop - middle + half]
        wave = np.convolve(wave, echo)
        if wave.size > 2 * way - 3:  # its far tails are as good as nothing
            wave = wave[1:-1]
    return echoes


def rings(rate: float, modes: Sequence[Mode]) -> Array:
    """Sum of resonances of unit peak times their strength.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    modes : sequence of (float, float, float)
        Frequency [Hz], damping ratio [-], strength with its sense [-].

    Returns
    -------
    ndarray, shape (n,)
        Impulse response [-].

    Examples
    --------
    >>> rings(48e3, [(1000.0, 0.05, 0.0)]).any()
    np.False_
    """
    return padded_sum(
        [np.zeros(1)]
        + [
            strength * resonance([0.0, 2.0 * damping, 0.0], frequency, damping, rate)
            for frequency, damping, strength in modes
            if frequency < HIGHEST_SHARE * rate
        ]
    )


def shifted(response: Array, factor: float) -> Array:
    """Move all modes of an impulse response.

    Parameters
    ----------
    response : ndarray, shape (n,)
        [any]
    factor : float
        Of their frequencies [-].

    Returns
    -------
    ndarray, shape (n,)
        [as `response`]

    Examples
    --------
    >>> tone = np.sin(0.2 * np.arange(100.0))
    >>> bool(np.allclose(shifted(tone, 1.5)[9:50], 1.5 * np.sin(0.3 * np.arange(9, 50)), atol=0.01))
    True
    """
    if factor == 1.0 or response.size == 1:
        return response
    at = factor * np.arange(response.size)
    return np.asarray(factor * map_coordinates(response, [at], order=3, mode="constant"))


def damped(response: Array, rate: float, decay: float) -> Array:
    """Let an impulse response decay faster.

    Parameters
    ----------
    response : ndarray, shape (n,)
        [any]
    rate : float
        Sampling rate [Hz].
    decay : float
        By so much [1/s].

    Returns
    -------
    ndarray, shape (n,)
        [as `response`]
    """
    return np.asarray(response * np.exp(-decay / rate * np.arange(response.size)))


def split(response: Array, rate: float, apart: float) -> Array:
    """Split each mode of an impulse response into two.

    Parameters
    ----------
    response : ndarray, shape (n,)
        [any]
    rate : float
        Sampling rate [Hz].
    apart : float
        How far the two lie apart [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [as `response`]
    """
    return np.asarray(response * np.cos(np.pi * apart / rate * np.arange(response.size)))


def band_level(response: Array, rate: float) -> float:
    """Root mean square of what an impulse response passes from 200 to 6000 Hz.

    Parameters
    ----------
    response : ndarray, shape (n,)
        [any]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    float
        [as `response`]
    """
    passed = np.abs(np.fft.rfft(response, max(response.size, 2048)))
    frequency = np.fft.rfftfreq(max(response.size, 2048), 1.0 / rate)
    inside = (frequency >= _BAND[0]) & (frequency <= _BAND[1])
    return float(np.sqrt(np.mean(passed[inside] ** 2)))


def on_acceleration(paths: ImpulseResponses, change: Callable[[Array], Array]) -> ImpulseResponses:
    """Change both ways to the acceleration; what is heard stays."""
    return replace(
        paths,
        torque_to_acceleration=change(paths.torque_to_acceleration),
        pulse_to_acceleration=change(paths.pulse_to_acceleration),
    )


def on_pressure(paths: ImpulseResponses, change: Callable[[Array], Array]) -> ImpulseResponses:
    """Change both ways to the pressure."""
    return replace(
        paths,
        torque_to_pressure=change(paths.torque_to_pressure),
        pulse_to_pressure=change(paths.pulse_to_pressure),
    )
