"""Sounds that no bushing makes, from a few recipes, for the classifier to learn ``unknown``.

Not a likeness of any recording: each recipe varies one way in which everyday sound differs from
friction noise: pitch that glides, bursts without rhythm, syllables, chords, single blows, rubbing
without a tone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from noise.classifier.hearing import coloured_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["RECIPES", "stranger"]

Recipe = Callable[[int, float, np.random.Generator], "NDArray[np.float64]"]


def stranger(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a sound by a recipe drawn at random, of unit peak.

    Examples
    --------
    >>> sound = stranger(4800, 48e3, np.random.default_rng(2))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((4800,), 1.0)
    """
    recipe = RECIPES[int(rng.integers(len(RECIPES)))]
    sound = recipe(n, rate, rng)
    peak = float(np.abs(sound).max())
    return sound / peak if peak > 0.0 else sound


def _call(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Barks, cries, crows: a rich harmonic sound whose pitch glides within each burst."""
    sound = np.zeros(n)
    start = int(rng.uniform(0.0, 0.2) * rate)
    while start < n:
        m = min(n - start, int(rng.uniform(0.08, 0.9) * rate))
        if m > 64:
            x = np.linspace(0.0, 1.0, m)
            f0 = math.exp(rng.uniform(math.log(200.0), math.log(1200.0)))
            bend = rng.uniform(-0.5, 0.5) * x + rng.uniform(-0.6, 0.6) * np.sin(np.pi * x)
            vibrato = 0.03 * rng.random() * np.sin(2 * np.pi * rng.uniform(4, 12) * x * m / rate)
            pitch = f0 * np.exp2(bend + vibrato)
            voice = _harmonics(pitch, rate, rng.uniform(0.3, 1.5), rng)
            breath = rng.uniform(0.0, 0.5) * coloured_noise(m, 0.5, rng)
            sound[start : start + m] += (voice + breath) * np.sin(np.pi * x) ** rng.uniform(
                0.3, 1.5
            )
        start += m + int(rng.uniform(0.02, 0.5) * rate)
    return sound


def _speech(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Syllables: a voice with moving formants, fricatives between."""
    time = np.arange(n) / rate
    f0 = rng.uniform(85.0, 300.0)
    pitch = f0 * np.exp2(
        0.25 * np.sin(2 * np.pi * rng.uniform(0.5, 2.5) * time + rng.uniform(0, 6))
    )
    voice = _harmonics(pitch, rate, 0.7, rng)
    sound = np.zeros(n)
    start = 0
    while start < n:
        m = min(n - start, int(rng.uniform(0.06, 0.25) * rate))
        part = slice(start, start + m)
        source = voice[part] if rng.random() < 0.75 else 0.3 * rng.standard_normal(m)
        for centre in (rng.uniform(250, 900), rng.uniform(900, 2400), rng.uniform(2400, 3500)):
            source = source + 2.0 * _resonance(source, centre, rng.uniform(60, 200), rate)
        sound[part] = source * np.hanning(m) * rng.uniform(0.1, 1.0)
        start += m
    return sound


def _drops(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Rain, fire, gravel: blows at random times, of widely varying strength, over noise."""
    per_second = math.exp(rng.uniform(math.log(8.0), math.log(800.0)))
    hits = np.zeros(n)
    where = rng.integers(0, n, rng.poisson(per_second * n / rate) + 1)
    hits[where] += rng.pareto(rng.uniform(1.2, 3.0), where.size) * rng.choice([-1, 1], where.size)
    ring = _resonance(hits, rng.uniform(800.0, 6000.0), rng.uniform(300.0, 4000.0), rate)
    bed = coloured_noise(n, rng.uniform(0.0, 1.5), rng)
    return np.asarray(ring / (ring.std() + 1e-12) + rng.uniform(0.05, 1.0) * bed)


def _weather(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Sea, wind, traffic: noise that swells."""
    time = np.arange(n) / rate
    swell = 1.0 + rng.uniform(0.3, 1.0) * np.sin(
        2 * np.pi * rng.uniform(0.3, 3.0) * time + rng.uniform(0, 6)
    )
    return coloured_noise(n, rng.uniform(0.3, 2.2), rng) * swell


def _engine(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Engines, rotors, saws: noise and harmonics, both pulsing with the firing rate."""
    wander = np.cumsum(coloured_noise(n, 1.0, rng)) / n
    f0 = math.exp(rng.uniform(math.log(10.0), math.log(180.0)))
    pitch = f0 * (1.0 + rng.uniform(0.0, 0.3) * wander)
    phase = 2 * np.pi * np.cumsum(pitch) / rate
    beat = np.exp(rng.uniform(0.5, 4.0) * (np.cos(phase) - 1.0))
    noise = coloured_noise(n, rng.uniform(0.3, 1.5), rng)
    tones = _harmonics(pitch, rate, rng.uniform(0.6, 1.2), rng)
    return beat * noise + rng.uniform(0.0, 1.0) * tones + rng.uniform(0.05, 0.5) * noise


def _ticks(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Clocks, footsteps, knocks: a few short ringing blows a second."""
    hits = np.zeros(n)
    step = max(1, int(rate / rng.uniform(1.0, 6.0)))
    hits[int(rng.integers(step)) :: step] = 1.0
    sound = sum(
        _resonance(hits, rng.uniform(500.0, 7000.0), rng.uniform(30.0, 500.0), rate)
        for _ in range(3)
    )
    return np.asarray(sound) + 1e-3 * coloured_noise(n, 1.0, rng)


def _slam(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Slamming doors, dropped tools, sneezes: one burst that dies away."""
    time = np.arange(n) / rate - rng.uniform(0.0, 0.3) * n / rate
    rise = np.clip(1.0 + time / rng.uniform(0.001, 0.08), 0.0, 1.0)
    envelope = rise * np.exp(-np.maximum(time, 0.0) / rng.uniform(0.02, 0.3))
    return coloured_noise(n, rng.uniform(0.0, 2.0), rng) * envelope


def _music(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Chords of decaying notes."""
    sound = np.zeros(n)
    start = 0
    while start < n:
        m = n - start
        time = np.arange(m) / rate
        for _ in range(int(rng.integers(2, 5))):
            pitch = 110.0 * 2.0 ** (rng.integers(0, 40) / 12.0)
            decay = np.exp(-time / rng.uniform(0.1, 1.5))
            sound[start:] += decay * _harmonics(np.full(m, pitch), rate, rng.uniform(1.0, 2.5), rng)
        start += int(rng.uniform(0.12, 0.5) * rate)
    return sound


def _rubbing(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Scraping, brushing: strokes of broadband noise without a tone."""
    time = np.arange(n) / rate
    stroke = np.abs(
        np.sin(np.pi * rng.uniform(0.5, 5.0) * time + rng.uniform(0, 3))
    ) ** rng.uniform(0.3, 2.0)
    noise = coloured_noise(n, rng.uniform(0.0, 1.0), rng)
    broad = _resonance(noise, rng.uniform(800.0, 5000.0), rng.uniform(1000.0, 5000.0), rate)
    return np.asarray((broad / broad.std() + rng.uniform(0.1, 1.0) * noise) * stroke)


RECIPES: tuple[Recipe, ...] = (
    _call, _speech, _drops, _weather, _engine, _ticks, _slam, _music, _rubbing,
)  # fmt: skip
"""Every recipe takes the number of samples, the rate and a generator."""


def _harmonics(
    pitch: NDArray[np.float64], rate: float, roll_off: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    phase = 2.0 * np.pi * np.cumsum(pitch) / rate
    highest = float(pitch.max())
    sound = np.zeros(pitch.size)
    for k in range(1, min(30, int(0.45 * rate / highest) + 1) + 1):
        if k * highest < 0.48 * rate:
            sound += k**-roll_off * np.sin(k * phase + rng.uniform(0.0, 6.3))
    return sound


def _resonance(
    x: NDArray[np.float64], centre: float, bandwidth: float, rate: float
) -> NDArray[np.float64]:
    radius = math.exp(-math.pi * bandwidth / rate)
    turn = 2.0 * radius * math.cos(2.0 * math.pi * min(centre, 0.45 * rate) / rate)
    return np.asarray(lfilter([1.0 - radius], [1.0, -turn, radius**2], x))
