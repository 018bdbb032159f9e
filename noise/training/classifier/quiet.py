"""Quiet, which is no noise at all: hiss, hum, rumble, steady sliding, digital silence."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.augmentation.backgrounds import background
from noise.training.draws import coloured_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KINDS", "quiet"]

KINDS = ("hiss", "hum", "background", "sliding", "silence")
"""Of the quiet."""

_SHARES = (0.28, 0.32, 0.2, 0.17, 0.03)


def quiet(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of what a microphone records where nothing sounds.

    Hum is the mains' or a transformer's, 50 to 120 Hz, with up to 20 harmonics, odd ones stronger;
    steady sliding hisses without a line, as strongly as it may.

    Examples
    --------
    >>> quiet(480, 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    kind = KINDS[int(rng.choice(len(KINDS), p=_SHARES))]
    if kind == "silence":
        return np.zeros(n)
    if kind == "background":
        return background(n, rate, rng)
    noise = coloured_noise(n, rng.uniform(0.0, 2.2), rng)
    if kind == "hum":
        return noise + _hum(n, rate, rng)
    if kind == "sliding":
        octaves = coloured_noise(n, rng.uniform(0.0, 1.5), rng)
        return np.asarray(noise + rng.uniform(0.0, 2.0) * np.diff(octaves, prepend=octaves[0]))
    return noise


def _hum(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    time = np.arange(n) / rate
    mains = float(rng.choice((50.0, 60.0, 100.0, 120.0))) * rng.uniform(0.999, 1.001)
    loud = 10.0 ** rng.uniform(-0.3, 1.7)
    roll_off = rng.uniform(0.3, 2.5)
    odd = rng.random() < 0.5
    hum = np.zeros(n)
    for k in range(1, int(rng.integers(2, 21))):
        strength = loud * k**-roll_off * rng.lognormal(0.0, 0.5)
        if odd and k % 2 == 0:
            strength *= 0.1
        hum += strength * np.sin(2 * math.pi * (k * mains * time + rng.random()))
    return hum
