"""What is heard in halls where benches stand: hydraulics, ventilation, compressors, work.

A hydraulic pump whines at its pistons' rate and many harmonics, modulated by its shaft, and its
valves hiss; fans hum at their blades' rate; somebody hammers or grinds at the other end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.training.classifier.augmentation.cabins import orders, shaped_noise
from noise.training.classifier.augmentation.rooms import in_a_room
from noise.training.classifier.background_sounds.building import blow, placed, wavering
from noise.training.draws import log_uniform, wandering

_AIR = ((20, 2), (80, 3), (250, 0), (1000, -8), (3000, -18), (8000, -32), (16000, -46))
_HISS = ((20, -40), (300, -22), (1500, -6), (5000, 0), (12000, -4), (20000, -12))
"""Spectra of ventilation and of valves [dB] over frequency [Hz]."""

_BLADES = (5.0, 7.0, 8.0, 9.0, 11.0)
_PISTONS = (7.0, 9.0, 11.0)


def hydraulic_hall(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw pumps of axial pistons at mains speed, valves, and a fan."""
    sound = _air(n, rate, rng)
    for _ in range(int(rng.integers(1, 3))):
        turns = _mains_turns(rng) * wavering(n, rate, 0.3, 0.004, rng)
        pump = orders(turns, rate, 1.0, float(rng.choice(_PISTONS)), rng.uniform(0.0, 1.2), rng)
        sound += 10.0 ** rng.uniform(-1.0, 0.6) * pump / pump.std()
    valves = 10.0 ** rng.uniform(-1.5, 0.0) * shaped_noise(n, rate, _HISS, rng)
    return np.asarray(sound + valves)


def workshop(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw ventilation, blows at random, and a grinder or a drill far away."""
    sound = _air(n, rate, rng)
    count = rng.poisson(rng.uniform(0.0, 3.0) * n / rate)
    if count:
        hits = placed(n, rng.uniform(0.0, n / rate, count), rng.lognormal(0.0, 0.7, count), rate)
        ring = blow(rate, (150.0, 5000.0), (0.005, 0.1), rng, noise=0.5)
        blows = fftconvolve(hits, ring)[:n]
        sound += rng.uniform(0.5, 4.0) * blows / (np.abs(blows).max() + 1e-12)
    if rng.random() < 0.4:
        turns = rng.uniform(60.0, 180.0) * wavering(n, rate, 1.0, 0.1, rng)
        tool = orders(turns, rate, 1.0, float(rng.integers(2, 9)), rng.uniform(0.3, 1.2), rng)
        tool = tool / tool.std() + 0.5 * shaped_noise(n, rate, _HISS, rng)
        working = np.clip(2.0 * wandering(n, rate, 0.5, rng) + 0.5, 0.0, 1.0)
        sound += rng.uniform(0.02, 0.6) * working * tool
    return sound


def engine_cell(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw an engine on a dynamometer behind glass, and strong ventilation."""
    turns = rng.uniform(13.0, 100.0) * wavering(n, rate, 0.3, 0.02, rng)
    firing = 0.5 * float(rng.choice((3, 4, 6, 8)))
    engine = orders(turns, rate, 0.5, firing, rng.uniform(0.3, 1.5), rng)
    return np.asarray(rng.uniform(0.3, 3.0) * engine / engine.std() + _air(n, rate, rng))


def laboratory(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw computers' fans, a power supply's hum and soft ventilation."""
    sound = _air(n, rate, rng)
    for _ in range(int(rng.integers(1, 4))):
        turns = rng.uniform(12.0, 80.0) * wavering(n, rate, 0.3, 0.01, rng)
        fan = orders(turns, rate, 1.0, float(rng.choice(_BLADES)), rng.uniform(0.5, 2.0), rng)
        sound += 10.0 ** rng.uniform(-1.6, -0.2) * fan / fan.std()
    return sound


def bench_with_a_motor(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw the bench's own drive: a motor with a gear, whose teeth mesh, and its inverter."""
    turns = rng.uniform(2.0, 50.0) * wavering(n, rate, 0.5, 0.02, rng)
    gear = orders(turns, rate, 1.0, float(rng.integers(10, 40)), rng.uniform(0.5, 2.0), rng)
    whine = np.sin(2.0 * np.pi * rng.uniform(2e3, 0.4 * min(rate, 4e4)) * np.arange(n) / rate)
    sound = _air(n, rate, rng) + 10.0 ** rng.uniform(-1.0, 0.3) * gear / (gear.std() + 1e-12)
    return np.asarray(sound + (rng.random() < 0.4) * 10.0 ** rng.uniform(-2.0, -0.7) * whine)


def climate_chamber(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a chamber's blower and its refrigerating compressor."""
    turns = rng.uniform(15.0, 50.0) * wavering(n, rate, 0.2, 0.003, rng)
    blower = orders(turns, rate, 1.0, float(rng.choice(_BLADES)), rng.uniform(0.6, 1.5), rng)
    cold = orders(np.full(n, _mains_turns(rng)), rate, 1.0, 2.0, rng.uniform(0.3, 1.2), rng)
    sound = _air(n, rate, rng) + rng.uniform(0.1, 1.5) * blower / blower.std()
    return np.asarray(sound + rng.uniform(0.1, 1.5) * cold / cold.std())


def compressor_room(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a piston compressor: beats of air and metal, a dozen in a second, and a belt."""
    time = np.arange(n) / rate
    beat = np.cos(2.0 * np.pi * log_uniform(6.0, 25.0, rng) * time + rng.uniform(0.0, 6.3))
    pulses = np.exp(rng.uniform(1.0, 8.0) * (beat - 1.0))
    metal = shaped_noise(n, rate, _HISS, rng)
    sound = _air(n, rate, rng) * (0.3 + pulses) + rng.uniform(0.02, 0.5) * metal * pulses
    return np.asarray(sound)


def _air(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    air = shaped_noise(n, rate, _AIR, rng)
    return in_a_room(air, rate, rng) if rng.random() < 0.2 else air


def _mains_turns(rng: np.random.Generator) -> float:
    """Return turns of an asynchronous motor of two or four poles at 50 or 60 Hz [1/s]."""
    return float(rng.choice((25.0, 30.0, 50.0, 60.0))) * rng.uniform(0.95, 0.995)


HALLS: Mapping[str, Callable[[int, float, np.random.Generator], NDArray[np.float64]]] = {
    recipe.__name__: recipe
    for recipe in (
        hydraulic_hall, workshop, engine_cell, laboratory, bench_with_a_motor, climate_chamber,
        compressor_room,
    )
}  # fmt: skip
"""By name; each takes the number of samples, the rate [Hz] and a generator."""
