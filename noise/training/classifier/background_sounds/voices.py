"""Animals with a throat: dogs, roosters, pigs, cows, frogs, cats, hens, sheep, crows.

What tells them from a squeal: a pitch that glides by octaves within a call, formants that stay
while it does, many harmonics, a call's own envelope. What tells a rough one from a squawk or a
creak: periods that double and break, and noise in time with them.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.background_sounds.building import (
    arch,
    log_uniform,
    placed,
    repeated,
    resonance,
    voiced,
    wavering,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["cat", "cow", "crow", "dog", "frog", "hen", "pig", "rooster", "sheep"]


def _glide(m: int, low: float, high: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a pitch between `low` and `high` [Hz] that arches, rises or falls by up to an octave."""
    x = np.linspace(0.0, 1.0, m)
    f0 = log_uniform(low, high, rng)
    size = 1.0 if rng.random() < 0.6 else 0.2  # some calls hold their pitch
    peak = rng.uniform(0.1, 0.6)
    shape = np.where(
        x < peak, np.sin(0.5 * np.pi * x / peak), np.cos(0.5 * np.pi * (x - peak) / (1.0 - peak))
    )
    return np.asarray(
        f0 * np.exp2(size * (rng.uniform(-0.15, 1.0) * shape + rng.uniform(-0.5, 0.3) * (x - 0.5)))
    )


def _call(
    m: int,
    rate: float,
    rng: np.random.Generator,
    *,
    pitch: tuple[float, float],
    formants: tuple[float, ...],
    roughness: tuple[float, float] = (0.0, 0.3),
    breath: tuple[float, float] = (0.02, 0.4),
    attack: float = 0.15,
) -> NDArray[np.float64]:
    course = _glide(m, *pitch, rng)
    sound = voiced(
        m,
        rate,
        course,
        formants,
        rng,
        roughness=rng.uniform(*roughness),
        breath=rng.uniform(*breath),
    )
    return np.asarray(sound * arch(m, rng, attack))


def dog(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Barks, yaps, whines and growls."""
    size = log_uniform(0.6, 2.2, rng)
    formants = tuple(size * f for f in (600.0, 1300.0, 2400.0))
    kind = rng.random()
    if kind < 0.7:
        low = log_uniform(150.0, 900.0, rng)
        make = partial(
            _call, rate=rate, rng=rng, pitch=(low, 1.4 * low), formants=formants,
            roughness=(0.0, 1.0), breath=(0.05, 1.0), attack=0.08,
        )  # fmt: skip
        return repeated(n, rate, (0.07, 0.35), (0.05, 0.8), make, rng)
    if kind < 0.85:  # a whine
        make = partial(_call, rate=rate, rng=rng, pitch=(500.0, 1800.0), formants=formants)
        return repeated(n, rate, (0.2, 1.2), (0.1, 0.8), make, rng)
    make = partial(
        _call, rate=rate, rng=rng, pitch=(40.0, 120.0), formants=formants, roughness=(0.4, 1.0)
    )
    return repeated(n, rate, (0.4, 1.5), (0.1, 0.4), make, rng)


def rooster(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Crowing: three or four syllables, the last but one long and highest."""
    top = log_uniform(400.0, 1300.0, rng)
    formants = tuple(rng.uniform(0.8, 1.3) * f for f in (1100.0, 2300.0, 3600.0))

    def syllable(m: int) -> NDArray[np.float64]:
        return _call(
            m, rate, rng, pitch=(0.7 * top, top), formants=formants, roughness=(0.0, 0.8),
            breath=(0.02, 0.3),
        )  # fmt: skip

    return repeated(n, rate, (0.12, 1.1), (0.02, 0.15), syllable, rng)


def pig(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Grunts, rough and low, and squeals, rough and high."""
    if rng.random() < 0.6:
        make = partial(
            _call, rate=rate, rng=rng, pitch=(35.0, 180.0), formants=(400.0, 1100.0, 2200.0),
            roughness=(0.4, 1.2), breath=(0.3, 2.0),
        )  # fmt: skip
        return repeated(n, rate, (0.1, 0.6), (0.03, 0.5), make, rng)
    make = partial(
        _call, rate=rate, rng=rng, pitch=(500.0, 1600.0), formants=(1500.0, 2800.0, 4000.0),
        roughness=(0.3, 1.0), breath=(0.1, 0.8),
    )  # fmt: skip
    return repeated(n, rate, (0.25, 1.5), (0.05, 0.4), make, rng)


def cow(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Mooing."""
    make = partial(
        _call, rate=rate, rng=rng, pitch=(70.0, 280.0), formants=(350.0, 800.0, 2000.0),
        roughness=(0.0, 0.7), attack=0.3,
    )  # fmt: skip
    return repeated(n, rate, (0.6, 2.5), (0.2, 1.0), make, rng)


def sheep(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Bleating: a voice that trembles 5 to 14 times a second."""

    def bleat(m: int) -> NDArray[np.float64]:
        tremble = np.sin(2 * np.pi * rng.uniform(5.0, 14.0) * np.arange(m) / rate + rng.random())
        course = log_uniform(120.0, 600.0, rng) * np.exp2(0.1 * rng.random() * tremble)
        course = course * wavering(m, rate, 2.0, 0.15, rng)
        sound = voiced(
            m, rate, course, (700.0, 1600.0, 2700.0), rng, roughness=rng.uniform(0.0, 0.7),
            breath=rng.uniform(0.05, 0.4),
        )  # fmt: skip
        return np.asarray(sound * (1.0 + rng.uniform(0.2, 0.9) * tremble) * arch(m, rng))

    return repeated(n, rate, (0.4, 1.5), (0.1, 1.0), bleat, rng)


def cat(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Meowing, at times hissing or purring."""
    if rng.random() < 0.12:
        beats = rng.uniform(20.0, 30.0)
        make = partial(_call, rate=rate, rng=rng, pitch=(beats, beats * 1.1),
                       formants=(200.0, 600.0, 1500.0), breath=(0.5, 2.0))  # fmt: skip
        return repeated(n, rate, (0.4, 1.2), (0.02, 0.1), make, rng)
    make = partial(
        _call, rate=rate, rng=rng, pitch=(300.0, 1000.0), formants=(900.0, 1800.0, 3500.0),
        roughness=(0.0, 0.5), attack=0.3,
    )  # fmt: skip
    return repeated(n, rate, (0.3, 1.6), (0.1, 1.0), make, rng)


def hen(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Clucking: short calls in series, now and then a long one."""
    top = log_uniform(300.0, 1000.0, rng)

    def cluck(m: int) -> NDArray[np.float64]:
        longer = int(m * (1.0 if rng.random() < 0.8 else 4.0))
        return _call(
            longer, rate, rng, pitch=(0.8 * top, 1.2 * top), formants=(1000.0, 2200.0, 3500.0),
            roughness=(0.1, 0.9), breath=(0.05, 0.8),
        )  # fmt: skip

    return repeated(n, rate, (0.04, 0.18), (0.06, 0.5), cluck, rng)


def crow(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Cawing: harsh calls of 0.2 to 0.6 s."""
    low = log_uniform(200.0, 800.0, rng)

    def caw(m: int) -> NDArray[np.float64]:
        return _call(
            m, rate, rng, pitch=(low, 1.2 * low), formants=(1200.0, 1900.0, 3200.0),
            roughness=(0.4, 1.4), breath=(0.1, 1.0),
        )  # fmt: skip

    return repeated(n, rate, (0.15, 0.6), (0.05, 0.8), caw, rng)


def frog(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Croaking: each croak a train of pulses of the throat's sac; or a chorus of peeps."""
    centre = log_uniform(250.0, 3500.0, rng)
    pace = log_uniform(15.0, 180.0, rng)

    def croak(m: int) -> NDArray[np.float64]:
        period = 1.0 / (pace * rng.uniform(0.9, 1.1))
        times = np.arange(0.0, m / rate, period)
        times = times + rng.normal(0.0, rng.uniform(0.0, 0.08) * period, times.size)
        hits = placed(m, times, rng.uniform(0.7, 1.3, times.size), rate)
        sound = resonance(hits, centre, rng.uniform(80.0, 400.0), rate)
        sound += rng.uniform(0.0, 0.7) * resonance(hits, 2.2 * centre, 300.0, rate)
        sound *= arch(m, rng, 0.4)
        return np.asarray(sound / (np.abs(sound).max() + 1e-300))

    sound = repeated(n, rate, (0.08, 0.9), (0.05, 0.8), croak, rng)
    for _ in range(int(rng.integers(0, 4))):
        centre, pace = log_uniform(250.0, 3500.0, rng), log_uniform(15.0, 180.0, rng)
        sound += rng.uniform(0.1, 0.8) * repeated(n, rate, (0.08, 0.9), (0.05, 0.8), croak, rng)
    return sound
