"""Sounds that no friction makes, a recipe each, for the classifier to learn ``unknown``.

Not a likeness of any recording: each recipe follows how a sound of its kind comes about, with wide
ranges. The hardest are dearest: what is as tonal as a squeal (calls, whistles, beeps), as pulsed as
a creak (crackle, typing, croaks), as harmonic as a squawk (hum, engines, horns).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from noise.training.classifier.augmentation.backgrounds import coloured_noise
from noise.training.classifier.background_sounds import (
    blows,
    insects,
    machines,
    music,
    outdoors,
    people,
    signals,
    strokes,
    voices,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["RECIPES", "WEIGHTS", "background_sound"]

Recipe = Callable[[int, float, np.random.Generator], "NDArray[np.float64]"]

RECIPES: Mapping[str, Recipe] = {
    name: getattr(family, name)
    for family in (voices, people, insects, outdoors, blows, machines, signals, strokes, music)
    for name in family.__all__
}
"""Every recipe takes the number of samples, the rate [Hz] and a generator."""

_HARD = {
    *("hen", "sheep", "crickets", "fly", "snoring", "speech", "music", "clapping", "footsteps"),
    *(
        "keyboard",
        "bells",
        "tone",
        "fire",
        "engine",
        "train",
        "washing_machine",
        "frog",
        "laughing",
    ),
}
_HARDEST = {
    *("dog", "rooster", "pig", "cat", "crow", "baby", "birds", "alarm", "siren", "horn"),
    *("helicopter", "chainsaw", "clock_tick", "hand_saw"),
}

WEIGHTS: Mapping[str, float] = {
    name: 3.0 if name in _HARDEST else 2.0 if name in _HARD else 1.0 for name in RECIPES
}
"""How often a recipe is drawn, relative to the others."""


def background_sound(
    n: int, rate: float, rng: np.random.Generator, name: str | None = None
) -> NDArray[np.float64]:
    """Return `n` samples of a sound of unit peak; now and then a second one sounds besides.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator
    name : str, optional
        Of a recipe in `RECIPES`; by default one is drawn.

    Examples
    --------
    >>> sound = background_sound(4800, 48e3, np.random.default_rng(2))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((4800,), 1.0)
    """
    sound = _alone(n, rate, rng, name or drawn_name(rng))
    chance = rng.random()
    if chance < 0.12:  # over it
        other = _alone(n, rate, rng, drawn_name(rng))
        sound = sound + 10.0 ** (rng.uniform(-25.0, -3.0) / 20.0) * other
    elif chance < 0.2:  # after it
        cut = int(rng.uniform(0.4, 0.8) * n)
        other = _alone(n - cut, rate, rng, drawn_name(rng))
        sound[cut:] = rng.uniform(0.2, 1.0) * other
    if rng.random() < 0.2:  # far away, or behind a wall
        corner = math.exp(rng.uniform(math.log(300.0), math.log(4000.0)))
        pole = math.exp(-2.0 * math.pi * corner / rate)
        for _ in range(2):
            sound = lfilter([1.0 - pole], [1.0, -pole], sound)
    return np.asarray(sound / np.abs(sound).max())


def drawn_name(rng: np.random.Generator) -> str:
    """Draw the name of a recipe.

    Examples
    --------
    >>> drawn_name(np.random.default_rng(0)) in RECIPES
    True
    """
    weights = np.array(list(WEIGHTS.values()))
    return list(RECIPES)[int(rng.choice(weights.size, p=weights / weights.sum()))]


def _alone(n: int, rate: float, rng: np.random.Generator, name: str) -> NDArray[np.float64]:
    sound = RECIPES[name](n, rate, rng)
    peak = float(np.abs(sound).max())
    return sound / peak if peak > 0.0 else 1e-3 * coloured_noise(n, 1.0, rng)
