"""Components of background sounds: tones, voices, resonances, blows, envelopes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from noise.training.draws import coloured_noise, log_uniform, wandering


def harmonics(
    pitch: NDArray[np.float64], rate: float, roll_off: float, n_most: int = 30
) -> NDArray[np.float64]:
    """Return the sum of harmonics of a pitch with amplitudes ``k ** -roll_off``.

    Parameters
    ----------
    pitch : ndarray, shape (n,)
        [Hz]
    rate : float
        [Hz]
    roll_off : float
        [-]
    n_most : int
        Maximum number of harmonics.

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> tone = harmonics(np.full(48_000, 440.0), 48e3, 1.0)
    >>> int(np.abs(np.fft.rfft(tone)).argmax())
    440
    """
    phase = 2.0 * np.pi * np.cumsum(pitch) / rate
    n = min(n_most, int(0.48 * rate / float(pitch.max())))
    before, now, twice = np.zeros(pitch.size), np.sin(phase), 2.0 * np.cos(phase)
    sound = np.zeros(pitch.size)
    for k in range(1, max(n, 1) + 1):
        sound += float(k) ** -roll_off * now
        before, now = now, twice * now - before
    return sound


def resonance(
    x: NDArray[np.float64], centre: float, bandwidth: float, rate: float
) -> NDArray[np.float64]:
    """Return a signal filtered by a resonance.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit]
    centre, bandwidth, rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `x`]

    Examples
    --------
    >>> resonance(np.ones(4), 1e3, 100.0, 48e3).shape
    (4,)
    """
    radius = math.exp(-math.pi * bandwidth / rate)
    turn = 2.0 * radius * math.cos(2.0 * math.pi * min(centre, 0.45 * rate) / rate)
    return np.asarray(lfilter([1.0 - radius], [1.0, -turn, radius**2], x))


def through_formants(
    source: NDArray[np.float64], formants: tuple[float, ...], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return a source with parallel resonances of a throat added.

    Parameters
    ----------
    source : ndarray, shape (n,)
        [any unit]
    formants : tuple of float
        [Hz]
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [unit of `source`]

    Examples
    --------
    >>> through_formants(np.ones(8), (500.0, 1500.0), 48e3, np.random.default_rng(0)).shape
    (8,)
    """
    sound = rng.uniform(0.02, 0.3) * source
    for k, formant in enumerate(formants):
        part = resonance(source, formant * rng.uniform(0.85, 1.15), rng.uniform(60, 350), rate)
        sound = sound + part * rng.uniform(0.5, 3.0) / (1.0 + 0.5 * k)
    return np.asarray(sound)


def envelope(
    sound: NDArray[np.float64],
    shape: Mapping[str, Any],
    rate: float,
    draw: Callable[[Any], float],
) -> NDArray[np.float64]:
    """Return an event with an envelope.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    shape : mapping
        ``arch``, a call that rises within that share, holds and fades; ``hann`` to a power;
        ``decay_s``, ``soft_s`` edges [s]; ``rise``, ``after`` and ``fall`` in shares.
    rate : float
        [Hz]
    draw : callable
        Function that draws a number from a range.

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> envelope(np.ones(5), {"hann": 1.0}, 48e3, float).tolist()
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    n = sound.size
    x, time = np.linspace(0.0, 1.0, n), np.arange(n) / rate
    after = draw(shape.get("after", 0.0))
    if "arch" in shape:
        rise, fall = draw([0.3, 1.5]) * draw(shape["arch"]), draw([0.1, 0.7])
        sound = sound * np.minimum(1.0, np.minimum(x / rise, (1.0 - x) / fall)) ** draw([0.5, 2.0])
    if "hann" in shape:
        sound = sound * np.hanning(n) ** draw(shape["hann"])
    if "decay_s" in shape:
        sound = sound * np.exp(-time / draw(shape["decay_s"]))
    if "fall" in shape:
        fallen = np.exp(-np.maximum(x - after, 0.0) / draw(shape["fall"]))
        sound = sound * fallen * (x >= after)
    if "rise" in shape:
        end = draw(shape["rise"])
        sound = sound * x / end * (x <= end)
    if "soft_s" in shape:
        sound = sound * np.minimum(1.0, np.minimum(time, time[::-1]) / draw(shape["soft_s"]))
    return sound


def voiced(
    n: int,
    rate: float,
    pitch: NDArray[np.float64],
    formants: tuple[float, ...],
    rng: np.random.Generator,
    *,
    roughness: float = 0.0,
    breath: float = 0.1,
) -> NDArray[np.float64]:
    """Return a random call: pitch with jitter, subharmonics if rough, formants and breath.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    pitch : ndarray, shape (n,)
        [Hz]
    formants : tuple of float
        [Hz]
    rng : numpy.random.Generator
    roughness : float
        0 is a clear voice; 1 doubles and breaks its periods [-].
    breath : float
        Noise over the voice [-].

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> float(np.abs(voiced(480, 48e3, np.full(480, 300.0), (900.0,), rng)).max())
    1.0
    """
    jitter = coloured_noise(n, 1.5, rng)
    pitch = pitch * np.exp((0.004 + 0.08 * roughness) * jitter)
    source = harmonics(pitch, rate, rng.uniform(0.3, 1.6), n_most=40)
    if roughness > 0.0:
        half = 2.0 * np.pi * np.cumsum(pitch) / rate / float(rng.choice((2.0, 2.0, 3.0)))
        source *= 1.0 + roughness * np.cos(half)
        source *= np.exp(roughness * 0.6 * coloured_noise(n, 0.8, rng))
    source = source / (source.std() + 1e-12) + breath * coloured_noise(n, 0.3, rng)
    sound = through_formants(source, formants, rate, rng)
    return np.asarray(sound / (np.abs(sound).max() + 1e-300))


def placed(
    n: int, times: NDArray[np.float64], strength: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    """Return impulses at given times.

    Parameters
    ----------
    n : int
        Number of samples.
    times : ndarray, shape (m,)
        [s]
    strength : ndarray, shape (m,)
        [any unit]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `strength`]

    Examples
    --------
    >>> placed(4, np.array([0.5]), np.array([2.0]), 4.0).tolist()
    [0.0, 0.0, 2.0, 0.0]
    """
    hits = np.zeros(n)
    index = (np.asarray(times) * rate).astype(int)
    inside = (index >= 0) & (index < n)
    np.add.at(hits, index[inside], strength[inside])
    return hits


def blow(
    rate: float,
    band: tuple[float, float],
    decay: tuple[float, float],
    rng: np.random.Generator,
    *,
    n_modes: int = 8,
    noise: float = 0.5,
    ratios: Sequence[float] = (),
) -> NDArray[np.float64]:
    """Return the sound of a blow: decaying modes in a band, and a noisy knock.

    Parameters
    ----------
    rate : float
        [Hz]
    band : pair of float
        [Hz]
    decay : pair of float
        [s]
    rng : numpy.random.Generator
    n_modes : int
    noise : float
        Maximum level of the knock relative to the modes [-].
    ratios : sequence of float
        Of a bell: frequencies of its modes, over one in the band; the higher ones die sooner.

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> blow(48e3, (500.0, 3000.0), (0.005, 0.02), np.random.default_rng(0)).ndim
    1
    """
    longest = min(7.0 * decay[1], 3.0)
    time = np.arange(max(16, int(longest * rate))) / rate
    sound = np.zeros(time.size)
    for ratio in ratios or [1.0] * n_modes:
        frequency = min(ratio * log_uniform(*band, rng), 0.45 * rate)
        lasting = log_uniform(*decay, rng) / (0.5 + 0.5 * ratio)
        sound += rng.normal() * np.exp(-time / lasting) * np.sin(2 * np.pi * frequency * time)
    sound /= np.abs(sound).max() + 1e-12
    knock = rng.standard_normal(time.size) * np.exp(-time / rng.uniform(0.0005, 0.01))
    return np.asarray(sound + noise * rng.random() * knock)


def wavering(
    n: int, rate: float, frequency: float, depth: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return a random factor near 1 that varies by `depth` with a given frequency.

    Examples
    --------
    >>> float(wavering(10, 10.0, 1.0, 0.0, np.random.default_rng(0)).max())
    1.0
    """
    return np.asarray(np.exp(depth * wandering(n, rate, frequency, rng)))
