"""Squeals of brakes, chalk, tyres, rubber soles and hinges: one mode that friction feeds.

All are `noise.training.classifier.friction_sources.limit_cycle`; they differ in frequency, in how
the load comes and goes, in the noise of the contact, and in the number of harmonics. One frequency
predominates at any time; a second mode may sound 8 dB or more below it, or take its place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.friction_sources.limit_cycle import (
    ENVELOPE_RATE,
    amplitudes,
    carried,
)
from noise.training.draws import coloured_noise, wandering


@dataclass(frozen=True)
class Squealer:
    """What a kind of squeal is drawn from; pairs are the ends of ranges.

    Parameters
    ----------
    frequency : tuple of float
        [Hz]
    drift : tuple of float
        By which share the frequency moves with the load.
    bout : tuple of float
        Length of a contact [s]; gaps between are a third as long.
    growth : tuple of float
        Over the angular frequency [-]; below zero the contact's noise alone sounds.
    roughness : tuple of float
        epsilon over the root of the decay's or growth's size [-].
    harmonics : tuple of float
        Of the sound's second harmonic [dB]; each further one is as much lower again.
    modulation : tuple of float
        Depth of the load's fast changes [-].
    modulation_frequency : tuple of float
        Their frequency [Hz].
    """

    frequency: tuple[float, float]
    drift: tuple[float, float]
    bout: tuple[float, float]
    growth: tuple[float, float]
    roughness: tuple[float, float]
    harmonics: tuple[float, float]
    modulation: tuple[float, float]
    modulation_frequency: tuple[float, float]


SQUEALS = {
    "brake": Squealer(
        (900, 5000), (0.001, 0.02), (0.8, 6.0), (0.003, 0.03), (0.02, 0.5), (-45, -12), (0.0, 0.9),
        (1.0, 12.0),
    ),
    "chalk": Squealer(
        (1200, 4500), (0.01, 0.08), (0.15, 0.9), (0.005, 0.05), (0.1, 0.8), (-20, -1), (0.2, 1.3),
        (10.0, 110.0),
    ),
    "tyre": Squealer(
        (500, 1800), (0.005, 0.1), (0.5, 4.0), (-0.02, 0.02), (0.5, 2.0), (-22, -3), (0.1, 0.8),
        (3.0, 40.0),
    ),
    "rubber": Squealer(
        (300, 1700), (0.05, 0.35), (0.05, 0.35), (0.005, 0.06), (0.05, 0.6), (-28, -4), (0.0, 0.6),
        (5.0, 40.0),
    ),
    "hinge": Squealer(
        (500, 3200), (0.03, 0.3), (0.15, 1.5), (0.004, 0.05), (0.05, 0.8), (-26, -3), (0.0, 1.0),
        (3.0, 60.0),
    ),
}  # fmt: skip
"""What squeals."""


def squeal(kind: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a squeal of unit peak.

    Parameters
    ----------
    kind : str
        One of `SQUEALS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> sound = squeal("chalk", 24_000, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    what = SQUEALS[kind]
    m = int(n / rate * ENVELOPE_RATE) + 2
    load = _load(what, m, rng)
    n_modes = int(rng.choice((1, 2, 3), p=(0.6, 0.3, 0.1)))
    low, high = np.log(what.frequency)
    frequency = np.exp(rng.uniform(float(low), float(high), n_modes))
    growing = 2.0 * np.pi * frequency[0] * rng.uniform(*what.growth)
    pace = max(abs(growing), 0.002 * 2.0 * np.pi * float(frequency[0]))
    # Without contact the mode is damped; each mode has its own optimum of load.
    growth = np.empty((n_modes, m))
    detuning = np.empty((n_modes, m))
    drift = rng.uniform(*what.drift)
    for i in range(n_modes):
        own = load if i == 0 else load * (1.0 + 0.4 * wandering(m, ENVELOPE_RATE, 1.5, rng))
        growth[i] = np.where(load > 0.05, growing * own, -2.0 * pace - 30.0)
        bend = load - 1.0 + 0.4 * wandering(m, ENVELOPE_RATE, rng.uniform(0.7, 6.0), rng)
        detuning[i] = 2.0 * np.pi * frequency[i] * drift * np.clip(bend, -1.2, 1.2)
    cross = rng.uniform(1.2, 2.0)
    coupling = pace * (np.eye(n_modes) * (1.0 - cross) + cross)
    roughness = rng.uniform(*what.roughness) * math.sqrt(pace)
    solved = amplitudes(growth, detuning, coupling, np.full(n_modes, roughness), rng)
    # The loads of the other modes may make them win; else they are heard well below.
    fall = rng.uniform(*what.harmonics)
    sound = np.zeros(n)
    for i in range(n_modes):
        levels = fall * np.arange(int(rng.integers(1, 6))) + rng.normal(0.0, 3.0) * (fall > -40.0)
        strengths = np.minimum(10.0 ** (levels / 20.0), 1.0)
        strengths[0] = 1.0
        sound += carried(solved[i], float(frequency[i]), strengths, n, rate)
    contact = np.interp(np.arange(n) * (ENVELOPE_RATE / rate), np.arange(m), load)
    hiss = coloured_noise(n, rng.uniform(-0.5, 1.5), rng) * np.maximum(contact, 0.0)
    sound += float(sound.std()) * 10.0 ** (rng.uniform(-62.0, -3.0) / 20.0) * hiss
    return np.asarray(sound / np.abs(sound).max())


def _load(what: Squealer, m: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Load of the contact over time: bouts about one with gaps of nought between."""
    load = np.zeros(m)
    start = 0 if rng.random() < 0.5 else int(rng.uniform(0.0, 0.15) * m)
    while start < m:
        bout = rng.uniform(*what.bout)
        end = min(m, start + int(bout * ENVELOPE_RATE) + 1)
        x = np.linspace(0.0, 1.0, end - start)
        arch = np.minimum(1.0, np.minimum(x, 1.0 - x) * rng.uniform(4.0, 40.0)) ** 0.5
        load[start:end] = arch * rng.uniform(0.6, 1.2)
        start = end + int(bout * rng.uniform(0.0, 0.5) * ENVELOPE_RATE)
    pace = math.exp(rng.uniform(*np.log(what.modulation_frequency)))
    fast = 1.0 + rng.uniform(*what.modulation) * wandering(m, ENVELOPE_RATE, pace, rng)
    slow = 1.0 + 0.3 * wandering(m, ENVELOPE_RATE, 1.0, rng)
    return np.asarray(load * np.maximum(fast, 0.0) * slow)
