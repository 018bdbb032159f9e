"""Further forms of channels that come late."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.ndimage import map_coordinates

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    draw_shares,
    log_uniform,
    on_sensors,
    slowly,
)  # fmt: skip
from sim.effects.effect import Effect

TimeSeries = Callable[[int, float, Rng], Array]

_LATEST = (5e-4, 1.5e-2)
"""Delay at strength 1 [s]."""


def _delays(form: str, a: float, rng: Rng, time_series: TimeSeries) -> Effect:
    delay = a * log_uniform(rng, *_LATEST)

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        when = np.arange(x.size) - share * delay * rate * time_series(x.size, rate, rng)
        return np.interp(when, np.arange(x.size), x)

    return on_sensors("channel_delay", form, a, draw_shares(rng, signed=True), change)


def _delay_packets(a: float, rng: Rng) -> Effect:
    length = log_uniform(rng, 2e-3, 0.05)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        late = rng.exponential(0.7, math.ceil(n / (length * rate)) + 1)
        return np.asarray(late[(np.arange(n) / (length * rate)).astype(np.int64)])

    return _delays("packets", a, rng, time_series)


def _delay_wandering(a: float, rng: Rng) -> Effect:
    corner, mean = log_uniform(rng, 0.5, 30.0), float(rng.uniform(0.0, 1.0))
    return _delays(
        "wandering", a, rng, lambda n, rate, rng: mean + 0.7 * slowly(rng, n, rate, corner)
    )


def _delay_lost(a: float, rng: Rng) -> Effect:
    """Lose packets: the one before is read again, or silence."""
    size, kept = log_uniform(rng, 2e-3, 8e-3), float(rng.choice([0.0, 1.0]))
    chance, mean = 0.5 * a, a * log_uniform(rng, 3e-4, 1.5e-3)

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        length = max(2, round(size * rate))
        at = np.arange(x.size)
        lost = (rng.random(x.size // length + 1) < chance * abs(share))[at // length]
        late = np.interp(at - share * mean * rate, at, x)
        again = late[np.maximum(at - length, 0)]
        return np.asarray(np.where(lost, kept * again + (1.0 - kept) * x.mean(), late))

    return on_sensors("channel_delay", "lost_packets", a, draw_shares(rng, signed=True), change)


def _delay_dispersive(a: float, rng: Rng) -> Effect:
    """Delay by an amount that depends on frequency, all levels being kept."""
    delay, corner = a * log_uniform(rng, *_LATEST), log_uniform(rng, 150.0, 3000.0)
    steep, way = float(rng.uniform(0.5, 3.0)), float(rng.choice([-1.0, 1.0]))

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        n = 2 * x.size
        frequency = np.fft.rfftfreq(n, 1.0 / rate)
        group = delay / (1.0 + (np.maximum(frequency, 1.0) / corner) ** (way * steep))
        phase = 2.0 * np.pi * np.cumsum(group) * frequency[1]
        mirrored = np.concatenate([x, x[::-1]])
        return np.asarray(
            np.fft.irfft(np.fft.rfft(mirrored) * np.exp(-1j * share * phase), n)[: x.size]
        )

    return on_sensors("channel_delay", "dispersive", a, draw_shares(rng, signed=True), change)


def _delay_each_run(a: float, rng: Rng) -> Effect:
    """Start each recording by another delay: a trigger that is late by chance."""
    sides = bool(rng.integers(2))

    def time_series(n: int, _rate: float, rng: Rng) -> Array:
        late = rng.normal() if sides else rng.exponential()
        return np.full(n, float(np.sign(late) * max(abs(late), 0.2)))

    return _delays("each_run", a, rng, time_series)


def _delay_step(a: float, rng: Rng) -> Effect:
    """Lose or repeat a buffer once: late from there on."""

    def time_series(n: int, _rate: float, rng: Rng) -> Array:
        return np.where(np.arange(n) >= int(n * rng.uniform(0.1, 0.9)), 1.0, 0.0)

    return _delays("step", a, rng, time_series)


def _delay_saw(a: float, rng: Rng) -> Effect:
    """Run off and be set right again and again: two clocks that are made to agree."""
    length = log_uniform(rng, 0.02, 0.3)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        return np.asarray((np.arange(n) / (length * rate) + rng.random()) % 1.0)

    return _delays("corrected", a, rng, time_series)


def _delay_swinging(a: float, rng: Rng) -> Effect:
    """Swing about a delay: a tape, a phase-locked loop."""
    frequency, mean = log_uniform(rng, 1.0, 80.0), float(rng.uniform(0.0, 1.0))

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        turn = frequency * np.arange(n) / rate + rng.random()
        return np.asarray(mean + 0.7 * np.sin(2.0 * np.pi * turn))

    return _delays("swinging", a, rng, time_series)


def _delay_whole(a: float, rng: Rng) -> Effect:
    """Come late by a constant, read exactly: two front-ends, a wireless link."""
    delay = a * log_uniform(rng, 3e-4, 3e-2)

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        when = np.clip(np.arange(x.size) - share * delay * rate, 0.0, x.size - 1.0)
        return np.asarray(map_coordinates(x, [when], order=3, mode="mirror"))

    return on_sensors("channel_delay", "whole", a, draw_shares(rng, signed=True), change)


# IEEE 1588 has the clocks of a network, ITU-T G.8260 their packets; tapes: standard practice.
DELAY: tuple[Recipe, ...] = (
    _delay_packets, _delay_wandering, _delay_lost, _delay_dispersive, _delay_each_run, _delay_step,
    _delay_saw, _delay_swinging, _delay_whole,
)  # fmt: skip
