"""Machines and tools: engines, vehicles, aircraft, household machines; brushes, saws, scrapers.

The tones of a machine hang together: harmonics of one shaft that turns steadily or is run up, with
noise in time with it. A train's and a saw's may be as rough as a creak, but keep their pace. A tool
in a hand makes broadband noise in strokes to and fro; a saw's teeth strike at a rate that follows
the stroke's speed, so the blade hums a little, every stroke the same way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.background_sounds.building import (
    blow,
    harmonics,
    placed,
    resonance,
    wavering,
)
from noise.training.draws import coloured_noise, log_uniform, wandering


def engine(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw an engine idling or revved: firing pulses of unequal strength through an exhaust."""
    firing = log_uniform(10.0, 180.0, rng)
    pitch = firing * np.exp(rng.uniform(0.0, 0.5) * wandering(n, rate, rng.uniform(0.2, 1.5), rng))
    return _fired(n, rate, pitch, rng)


def chainsaw(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a small two-stroke engine, 70 to 250 firings a second, revved, with a rattling chain."""
    pitch = log_uniform(70.0, 250.0, rng) * np.exp(
        rng.uniform(0.05, 0.6) * wandering(n, rate, rng.uniform(0.3, 2.0), rng)
    )
    sound = _fired(n, rate, pitch, rng)
    chain = resonance(rng.standard_normal(n), rng.uniform(2e3, 6e3), 2500.0, rate)
    return np.asarray(sound / sound.std() + rng.uniform(0.2, 1.5) * chain / chain.std())


def _fired(
    n: int, rate: float, pitch: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    phase = 2 * np.pi * np.cumsum(pitch) / rate
    phase += 0.5 * rng.random() ** 3 * coloured_noise(n, 1.8, rng)
    unequal = 1.0 + rng.uniform(0.0, 0.6) * np.sin(phase / float(rng.choice((2.0, 3.0, 4.0))))
    beat = np.exp(rng.uniform(0.5, 8.0) * (np.cos(phase) - 1.0)) * unequal
    source = np.gradient(beat)
    noise = coloured_noise(n, rng.uniform(0.2, 1.5), rng)
    sound = source / (source.std() + 1e-12) + rng.uniform(0.0, 1.5) * beat * noise
    for _ in range(3):
        centre, width = log_uniform(80.0, 2500.0, rng), rng.uniform(60.0, 500.0)
        sound = sound + rng.uniform(0.0, 2.0) * resonance(sound, centre, width, rate)
    return np.asarray(sound + rng.uniform(0.02, 0.7) * sound.std() * noise)


def helicopter(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Blades slap 8 to 30 times a second; turbine and wash between."""
    slaps = log_uniform(8.0, 70.0, rng)
    phase = 2 * np.pi * np.cumsum(slaps * wavering(n, rate, 0.5, 0.03, rng)) / rate
    beat = np.exp(rng.uniform(1.0, 10.0) * (np.cos(phase) - 1.0))
    noise = coloured_noise(n, rng.uniform(0.6, 2.0), rng)
    whine = harmonics(np.full(n, log_uniform(300.0, 3000.0, rng)), rate, 2.0, n_most=3)
    bed = rng.uniform(0.05, 1.5) * coloured_noise(n, rng.uniform(0.4, 1.8), rng)
    thump = rng.uniform(0.0, 2.0) * np.gradient(beat)
    thump = thump / (np.abs(thump).max() + 1e-12)
    return np.asarray(noise * beat + thump + bed + rng.uniform(0.0, 0.2) * whine)


def airplane(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a jet's roar, or a propeller's drone, that passes by."""
    passing = np.exp(rng.uniform(0.0, 1.5) * wandering(n, rate, 0.3, rng))
    roar = coloured_noise(n, rng.uniform(0.5, 2.0), rng)
    drone = harmonics(
        log_uniform(50.0, 250.0, rng) * wavering(n, rate, 0.3, 0.06, rng), rate, 1.0, n_most=25
    )
    whine = harmonics(log_uniform(1e3, 5e3, rng) * wavering(n, rate, 0.3, 0.1, rng), rate, 2.0, 2)
    drone = rng.uniform(0.0, 1.0) * (rng.random() < 0.5) * drone
    return np.asarray(passing * (roar + drone + rng.uniform(0.0, 0.4) * whine))


def train(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw rolling noise with joints in pairs, or a horn of several notes."""
    roll = coloured_noise(n, rng.uniform(0.6, 2.0), rng) * wavering(n, rate, 3.0, 0.5, rng)
    pace = rng.uniform(0.8, 4.0)
    times = np.arange(0.0, n / rate, 1.0 / pace) + rng.random() / pace
    times = np.concatenate([times, times + 0.2 / pace])
    joints = np.convolve(
        placed(n, times, rng.lognormal(0.0, 0.2, times.size), rate)[::8],
        blow(rate / 8, (60.0, 1200.0), (0.01, 0.08), rng, noise=1.0),
    )[: n // 8 + 1]
    sound = roll + rng.uniform(0.5, 4.0) * np.interp(
        np.arange(n) / 8, np.arange(joints.size), joints
    )
    if rng.random() < 0.3:
        gate = (wandering(n, rate, 0.7, rng) > rng.uniform(-0.3, 0.3)).astype(float)
        for ratio in (1.0, 1.25, 1.5, 1.68):
            note = np.full(n, ratio * rng.uniform(250.0, 420.0))
            sound += rng.uniform(0.3, 2.0) * gate * harmonics(note, rate, 0.8, n_most=12)
    return np.asarray(sound)


def vacuum_cleaner(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Rush of air and the whine of a motor of some 200 to 700 turns a second."""
    turns = log_uniform(90.0, 700.0, rng) * wavering(n, rate, 0.5, rng.uniform(0.0, 0.05), rng)
    whine = harmonics(turns, rate, rng.uniform(0.2, 1.2), n_most=15)
    air = coloured_noise(n, rng.uniform(0.0, 1.2), rng)
    strokes = wavering(n, rate, 1.5, 0.3, rng)
    return np.asarray((air + rng.uniform(0.05, 1.0) * whine) * strokes)


def washing_machine(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a drum that turns and sloshes, a motor's hum, or the spin."""
    time = np.arange(n) / rate
    hum = harmonics(np.full(n, log_uniform(40.0, 400.0, rng)), rate, rng.uniform(0.5, 1.5), 20)
    turn = 1.0 + rng.uniform(0.1, 1.0) * np.sin(2 * np.pi * log_uniform(0.5, 20.0, rng) * time)
    slosh = coloured_noise(n, rng.uniform(0.7, 2.0), rng) * turn
    return np.asarray(slosh + rng.uniform(0.1, 1.5) * hum * wavering(n, rate, 2.0, 0.2, rng))


def brushing(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Brushing teeth: two to six strokes a second, each way a little different."""
    pace = rng.uniform(2.0, 6.5)
    noise = resonance(rng.standard_normal(n), rng.uniform(1500, 7000), rng.uniform(800, 4e3), rate)
    return _stroked(noise / noise.std(), rate, pace, rng)


def hand_saw(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Sawing: strokes of 0.2 to 0.8 s; teeth that strike wood and a blade that rings."""
    pace = rng.uniform(0.8, 3.5)
    time = np.arange(n) / rate
    speed = np.abs(np.sin(np.pi * pace * time))
    teeth = np.cumsum(speed) / rate * log_uniform(60.0, 700.0, rng)
    strike = np.exp(rng.uniform(1.0, 4.0) * (np.cos(2 * np.pi * teeth) - 1.0))
    strike *= np.exp(0.5 * coloured_noise(n, 0.7, rng))
    source = rng.standard_normal(n) * (rng.uniform(0.1, 1.0) + strike)
    sound = source * rng.uniform(0.05, 0.5)
    for _ in range(int(rng.integers(2, 7))):
        mode = resonance(source, log_uniform(300.0, 6e3, rng), rng.uniform(40.0, 800.0), rate)
        sound = sound + rng.uniform(0.2, 1.0) * mode / (mode.std() + 1e-12)
    return _stroked(sound / sound.std(), rate, pace, rng, at_rest=0.0)


def scraping(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Scraping, sweeping, rustling: noise whose strength wanders with pressure and speed."""
    noise = coloured_noise(n, rng.uniform(0.0, 1.6), rng)
    broad = resonance(noise, rng.uniform(500.0, 6000.0), rng.uniform(800.0, 5000.0), rate)
    sound = broad / broad.std() + rng.uniform(0.1, 1.0) * noise
    rough = np.exp(rng.uniform(0.1, 1.2) * coloured_noise(n, rng.uniform(1.0, 2.0), rng))
    swell = np.exp(rng.uniform(0.2, 2.0) * wandering(n, rate, rng.uniform(0.5, 6.0), rng))
    return np.asarray(sound * rough * swell)


def _stroked(
    sound: NDArray[np.float64],
    rate: float,
    pace: float,
    rng: np.random.Generator,
    *,
    at_rest: float = 0.05,
) -> NDArray[np.float64]:
    """Give a noise the strokes of a hand, forth and back of different strength."""
    x = np.arange(sound.size) / rate * pace + rng.random()
    x = x + 0.15 * wandering(sound.size, rate, pace, rng)
    stroke = np.abs(np.sin(np.pi * x)) ** rng.uniform(0.4, 2.0)
    back = np.where(x.astype(int) % 2 == 0, 1.0, rng.uniform(0.1, 1.0))
    return np.asarray(sound * (at_rest + stroke * back))


RECIPES = (
    airplane, brushing, chainsaw, engine, hand_saw, helicopter, scraping, train, vacuum_cleaner,
    washing_machine,
)  # fmt: skip
"""Each takes the number of samples, the rate [Hz] and a generator."""
