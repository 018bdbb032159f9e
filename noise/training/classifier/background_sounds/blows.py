"""Blows: knocks, steps, clicks, keys, ticks, cans, glass, claps, crackers, slams.

Few or many, in rhythm or not; unlike a creak's slips they come singly, at a steady beat, or wholly
at random: their rate does not glide.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.background_sounds.building import blow, resonance
from noise.training.draws import coloured_noise, log_uniform


def _struck(
    n: int,
    rate: float,
    times: NDArray[np.float64],
    make: Callable[[], NDArray[np.float64]],
    scatter: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Put a sound at each of some times [s], of strengths that scatter."""
    sound = np.zeros(n)
    for time in times:
        at = int(time * rate)
        if 0 <= at < n:
            part = make()[: n - at]
            sound[at : at + part.size] += part * rng.lognormal(0.0, scatter)
    return sound + 1e-4 * rng.standard_normal(n)


def _beats(
    n: int, rate: float, per_second: float, jitter: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw times of a beat [s], each off by a share of the period."""
    count = int(n / rate * per_second) + 2
    return np.asarray(
        (np.arange(count) + rng.random() + jitter * rng.standard_normal(count)) / per_second
    )


def door_knock(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Three to six knocks on wood, a rest, again."""
    times = _beats(n, rate, rng.uniform(2.0, 8.0), 0.06, rng)
    times = times[(np.arange(times.size) % 8) < int(rng.integers(2, 7))]
    low = log_uniform(60.0, 300.0, rng)
    one = blow(rate, (low, 8 * low), (0.01, 0.06), rng)
    return _struck(n, rate, times, lambda: one, 0.3, rng)


def footsteps(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw steps, on a floor that booms or on gravel or leaves that crunch."""
    times = _beats(n, rate, rng.uniform(1.2, 3.5), 0.04, rng)
    crunch, low = rng.uniform(0.0, 1.0), log_uniform(60.0, 400.0, rng)

    def step() -> NDArray[np.float64]:
        thud = blow(rate, (low, 10 * low), (0.005, 0.04), rng)
        m = int(rng.uniform(0.08, 0.25) * rate)
        grains = rng.standard_normal(m) * (rng.random(m) < rng.uniform(0.01, 0.3))
        grit = resonance(grains, rng.uniform(1500.0, 6000.0), 2500.0, rate) * np.hanning(m)
        sound = np.zeros(max(m, thud.size))
        sound[: thud.size] += (1.0 - crunch) * thud
        sound[:m] += crunch * grit / (np.abs(grit).max() + 1e-12)
        return sound

    return _struck(n, rate, times, step, 0.3, rng)


def mouse_click(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Clicks in pairs: down and up."""
    times = np.sort(rng.uniform(0.0, n / rate, rng.poisson(rng.uniform(1, 6) * n / rate) + 1))
    times = np.concatenate([times, times + rng.uniform(0.05, 0.15)])
    return _struck(
        n, rate, times, lambda: blow(rate, (1500.0, 9e3), (5e-4, 4e-3), rng, noise=1.0), 0.3, rng
    )


def keyboard(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Typing: 3 to 14 keys a second, each a press and a release."""
    pace = rng.uniform(3.0, 14.0)
    times = np.cumsum(rng.gamma(3.0, 1.0 / (3.0 * pace), int(2 * pace * n / rate) + 4))
    times = np.concatenate([times, times + rng.uniform(0.04, 0.12, times.size)])
    low = rng.uniform(200.0, 1500.0)
    return _struck(
        n, rate, times, lambda: blow(rate, (low, 8e3), (1e-3, 0.012), rng, noise=1.0), 0.5, rng
    )


def clock_tick(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Ticks at an exact beat, tick and tock not quite alike."""
    pace = float(rng.choice((1.0, 2.0, 4.0, 5.0, 8.0))) * rng.uniform(0.98, 1.02)
    sounds = [
        blow(rate, (500.0, 9e3), (5e-4, rng.uniform(2e-3, 0.03)), rng, noise=1.0) for _ in range(2)
    ]
    times = _beats(n, rate, pace, rng.uniform(0.0, 0.005), rng)
    turn = iter(range(10_000))
    return _struck(n, rate, times, lambda: sounds[next(turn) % 2], 0.05, rng)


def can_opening(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a crack, a hiss, a tear."""
    time = np.arange(n) / rate - rng.uniform(0.0, 0.4) * n / rate
    hiss = np.where(time > 0.0, np.exp(-time / rng.uniform(0.05, 0.6)), 0.0)
    sound = coloured_noise(n, rng.uniform(-0.5, 0.5), rng) * hiss * rng.uniform(0.1, 1.0)
    start = max(-time[0], 0.0)
    times = start + np.array([0.0, *rng.uniform(0.05, 0.5, int(rng.integers(0, 4)))])
    return sound + _struck(
        n, rate, times, lambda: blow(rate, (900.0, 9e3), (2e-3, 0.03), rng, noise=2.0), 0.5, rng
    )


def glass(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a crash and tinkling shards, whose modes ring at 1.5 to 12 kHz."""
    start = rng.uniform(0.0, 0.3) * n / rate
    times = start + rng.exponential(rng.uniform(0.1, 0.5), int(rng.integers(5, 60)))
    top = min(12e3, 0.45 * rate)
    sound = _struck(n, rate, times, lambda: blow(rate, (1500.0, top), (5e-3, 0.15), rng), 1.0, rng)
    crash = np.where(np.arange(n) / rate > start, np.exp(-(np.arange(n) / rate - start) / 0.08), 0)
    return sound + rng.uniform(0.0, 3.0) * crash * coloured_noise(n, -0.2, rng)


def clapping(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """One pair of hands at a beat, or a hall of them."""
    people = int(rng.integers(1, 4)) if rng.random() < 0.5 else int(rng.integers(10, 50))
    sound = np.zeros(n)
    for _ in range(people):
        pair = blow(rate, (500.0, 4500.0), (1.5e-3, 6e-3), rng, n_modes=4, noise=3.0)
        times = _beats(n, rate, rng.uniform(1.5, 6.0), 0.08, rng)
        sound += rng.uniform(0.2, 1.0) * _struck(n, rate, times, partial(_same, pair), 0.3, rng)
    return sound


def _same(part: NDArray[np.float64]) -> NDArray[np.float64]:
    return part


def fireworks(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Bangs with a roll, crackle, and rockets that whistle up or down."""
    time = np.arange(n) / rate
    sound = 1e-3 * coloured_noise(n, 1.0, rng)
    for start in rng.uniform(0.0, n / rate, int(rng.integers(1, 6))):
        bang = np.where(time > start, np.exp(-(time - start) / rng.uniform(0.03, 0.4)), 0.0)
        sound += rng.uniform(0.3, 1.0) * bang * coloured_noise(n, rng.uniform(0.8, 2.2), rng)
    if rng.random() < 0.6:
        times = rng.uniform(0.0, n / rate, rng.poisson(log_uniform(5.0, 60.0, rng) * n / rate))
        sound += 0.5 * _struck(
            n, rate, times, lambda: blow(rate, (800.0, 6e3), (5e-4, 6e-3), rng, noise=4.0), 0.8, rng
        )
    if rng.random() < 0.35:
        pitch = log_uniform(800.0, 4000.0, rng) * np.exp2(rng.uniform(-1.0, 1.0) * time / time[-1])
        gate = (time > rng.uniform(0.0, 0.5) * time[-1]) * rng.uniform(0.1, 0.7)
        rough = 1.0 + 0.4 * coloured_noise(n, 0.5, rng)
        sound += gate * rough * np.sin(2 * np.pi * np.cumsum(pitch) / rate)
    return sound


def slam(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Slamming doors, dropped tools: one blow or a few, then their ringing."""
    times = rng.uniform(0.0, 0.5) * n / rate + rng.exponential(0.15, int(rng.integers(1, 4)))
    low = log_uniform(40.0, 1500.0, rng)
    lasting = log_uniform(0.01, 0.3, rng)
    return _struck(
        n, rate, times, lambda: blow(rate, (low, 12 * low), (0.2 * lasting, lasting), rng,
                                     n_modes=12, noise=2.0), 0.5, rng,
    )  # fmt: skip


RECIPES = (
    can_opening, clapping, clock_tick, door_knock, fireworks, footsteps, glass, keyboard,
    mouse_click, slam,
)  # fmt: skip
"""Each takes the number of samples, the rate [Hz] and a generator."""
