"""Random room responses: early reflections and a diffuse tail.

Reflections arrive at random within the first 40 ms, the later the weaker. The tail decays
exponentially with a low-pass. It is no model of a particular room, so that the classifier learns
all rooms.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.training.draws import log_uniform, low_pass


def in_a_room(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return a sound of the same length with random reflections and a tail.

    Examples
    --------
    >>> click = np.zeros(4800)
    >>> click[0] = 1.0
    >>> echoing = in_a_room(click, 48e3, np.random.default_rng(0))
    >>> echoing.shape, round(float(echoing[0]), 6)
    ((4800,), 1.0)
    """
    t60 = log_uniform(0.1, 1.2, rng)
    n = int(min(t60, 0.6) * rate)
    time = np.arange(n) / rate
    taps = rng.standard_normal(n) * 10.0 ** (-3.0 * time / t60)
    taps[: int(rng.uniform(0.002, 0.01) * rate)] = 0.0
    taps = low_pass(taps, rng.uniform(2e3, 12e3), rate)
    taps *= 10.0 ** (rng.uniform(-20.0, 0.0) / 20.0) / math.sqrt(float(np.sum(taps**2)))
    early = int(rng.integers(0, 9))
    if early:
        when = rng.uniform(0.001, 0.04, early)
        taps[np.minimum((when * rate).astype(int), n - 1)] += (
            rng.uniform(0.1, 0.7, early) * rng.choice((-1.0, 1.0), early) / (1.0 + 60.0 * when)
        )
    taps[0] = 1.0
    return np.asarray(fftconvolve(sound, taps)[: sound.size])
