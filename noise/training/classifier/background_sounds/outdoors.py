"""Weather and water: rain, sea, wind, thunder, fire, drops, pouring, a flush.

A bubble rings at the frequency that its radius gives and rises as it nears the surface (Minnaert
1933): drops and pouring are chirps. Rain and fire are blows at random times.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve, lfilter

from noise.training.classifier.background_sounds.building import blow, placed, repeated, resonance
from noise.training.draws import coloured_noise, log_uniform, wandering


def rain(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw drops at random times, of widely varying strength, over noise."""
    hits = _random_blows(n, rate, log_uniform(20.0, 3000.0, rng), rng.uniform(1.2, 4.0), rng)
    sound = resonance(hits, rng.uniform(600.0, 7000.0), rng.uniform(300.0, 5000.0), rate)
    bed = coloured_noise(n, rng.uniform(0.0, 1.2), rng)
    return np.asarray(sound / (sound.std() + 1e-12) + rng.uniform(0.1, 2.0) * bed)


def fire(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Crackling: sparse snaps, in clusters, over a soft low rush."""
    bursts = np.exp(1.2 * wandering(n, rate, rng.uniform(1.0, 8.0), rng))
    hits = _random_blows(n, rate, log_uniform(3.0, 80.0, rng), rng.uniform(1.0, 2.5), rng) * bursts
    sound = np.zeros(n)
    for _ in range(3):
        snap = blow(rate, (800.0, 9000.0), (0.0003, 0.004), rng, noise=1.5)
        sound += fftconvolve(hits * (rng.random(n) < 0.5), snap)[:n]
    bed = coloured_noise(n, rng.uniform(1.0, 2.2), rng)
    return np.asarray(sound / (sound.std() + 1e-12) + rng.uniform(0.02, 1.0) * bed)


def sea(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Waves: noise that swells and brightens as it breaks."""
    swell = np.exp(rng.uniform(0.2, 1.2) * wandering(n, rate, rng.uniform(0.1, 0.8), rng))
    bright = coloured_noise(n, rng.uniform(0.0, 0.7), rng) * swell ** rng.uniform(1.0, 3.0)
    return np.asarray(coloured_noise(n, rng.uniform(1.0, 2.0), rng) * swell + 0.5 * bright)


def wind(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Gusts; at times a whistle of narrow noise that moves with them."""
    gust = wandering(n, rate, rng.uniform(0.2, 1.5), rng)
    sound = coloured_noise(n, rng.uniform(1.0, 2.6), rng) * np.exp(rng.uniform(0.2, 1.5) * gust)
    if rng.random() < 0.35:  # howling: noise about a frequency that glides
        pitch = log_uniform(250.0, 1200.0, rng) * np.exp2(0.5 * gust)
        slow = coloured_noise(n, 0.0, rng)
        pole = np.exp(-2 * np.pi * rng.uniform(10.0, 80.0) / rate)
        slow = lfilter([1.0 - pole], [1.0, -pole], slow + 1j * coloured_noise(n, 0.0, rng))
        howl = (slow * np.exp(2j * np.pi * np.cumsum(pitch) / rate)).real
        sound += rng.uniform(0.3, 2.0) * sound.std() * howl / howl.std() * np.exp(gust)
    return np.asarray(sound)


def thunder(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a crack and a long roll."""
    time = np.arange(n) / rate - rng.uniform(0.0, 0.3) * n / rate
    roll = np.where(time > 0.0, np.exp(-time / rng.uniform(0.5, 2.5)), 0.0)
    roll *= np.exp(1.2 * wandering(n, rate, rng.uniform(2.0, 8.0), rng))
    crack = np.where(time > 0.0, np.exp(-time / 0.08), 0.0) * coloured_noise(n, 0.8, rng)
    bed = 0.05 * coloured_noise(n, 0.5, rng)
    return np.asarray(
        coloured_noise(n, 2.5, rng) * roll + rng.random() * crack + bed * rng.random()
    )


def drops(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a dripping tap: a click, then a bubble."""
    return repeated(n, rate, (0.02, 0.12), (0.05, 1.2), lambda m: _bubble(m, rate, rng), rng)


def pouring(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Many bubbles at random, noise, and a vessel whose resonance rises as it fills."""
    sound = np.zeros(n)
    for _ in range(min(500, rng.poisson(log_uniform(20.0, 150.0, rng) * n / rate))):
        m = int(rng.uniform(0.005, 0.05) * rate)
        at = int(rng.integers(0, n))
        part = _bubble(m, rate, rng)[: n - at]
        sound[at : at + part.size] += part * rng.lognormal(0.0, 0.6)
    noise = coloured_noise(n, rng.uniform(0.3, 1.5), rng)
    sound = sound / (sound.std() + 1e-12) + rng.uniform(0.1, 1.5) * noise
    if rng.random() < 0.5:
        cut = int(n * rng.random())
        f = log_uniform(300.0, 1500.0, rng)
        for half, centre in ((slice(0, cut), f), (slice(cut, n), 1.3 * f)):
            sound[half] += rng.uniform(0.5, 3.0) * resonance(sound[half], centre, 80.0, rate)
    return np.asarray(sound)


def flush(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a rush that swells, gurgles and dies."""
    x = np.linspace(0.0, 1.0, n)
    envelope = np.minimum(1.0, x / rng.uniform(0.02, 0.3)) * np.exp(-rng.uniform(0.0, 2.0) * x)
    sound = coloured_noise(n, rng.uniform(0.3, 1.5), rng) * envelope
    gurgle = pouring(n, rate, rng)
    return np.asarray(sound + rng.uniform(0.1, 1.0) * gurgle * x / gurgle.std())


def _bubble(m: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a chirp that rises by up to an octave and dies away."""
    time = np.arange(max(m, 16)) / rate
    start = log_uniform(400.0, 5000.0, rng)
    rise = rng.uniform(0.0, 1.0) * time / time[-1]
    phase = 2 * np.pi * np.cumsum(np.minimum(start * np.exp2(rise), 0.45 * rate)) / rate
    sound = np.sin(phase) * np.exp(-5.0 * time / time[-1])
    sound[: max(2, int(0.0005 * rate))] += rng.normal(0.0, 0.5)
    return np.asarray(sound)


def _random_blows(
    n: int, rate: float, per_second: float, tail: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Blows at random times, whose strengths have a Pareto tail."""
    count = rng.poisson(per_second * n / rate) + 1
    strength = np.minimum(rng.pareto(tail, count) + 0.05, 60.0) * rng.choice((-1.0, 1.0), count)
    return placed(n, rng.uniform(0.0, n / rate, count), strength, rate)


RECIPES = (drops, fire, flush, pouring, rain, sea, thunder, wind)
"""Each takes the number of samples, the rate [Hz] and a generator."""
