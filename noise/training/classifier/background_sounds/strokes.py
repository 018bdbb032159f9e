"""Strokes: brushing, sawing, scraping, sweeping: rubbing without a tone of its own.

Broadband noise in strokes to and fro; a saw's teeth strike at a rate that follows the stroke's
speed, so the blade hums a little, every stroke the same way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.augmentation.backgrounds import coloured_noise
from noise.training.classifier.background_sounds.building import log_uniform, resonance
from noise.training.classifier.friction_sources.slider import wandering

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["brushing", "hand_saw", "scraping"]


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
