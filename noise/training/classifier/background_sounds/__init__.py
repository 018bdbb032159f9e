"""Sounds that no friction makes, a recipe each, for the classifier to learn ``unknown``.

Not a likeness of any recording: each recipe follows how a sound of its kind comes about, with wide
ranges. The hardest are dearest: what is as tonal as a squeal (calls, whistles, beeps), as pulsed as
a creak (crackle, typing, croaks), as harmonic as a squawk (hum, engines, horns).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.background_sounds import (
    animals,
    blows,
    machines,
    outdoors,
    people,
    signals,
)
from noise.training.draws import coloured_noise, log_uniform, low_pass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["RECIPES", "WEIGHTS", "background_sound"]

Recipe = Callable[[int, float, np.random.Generator], "NDArray[np.float64]"]

WEIGHTS: Mapping[str, float] = {
    "cat": 3.0, "cow": 1.0, "crow": 3.0, "dog": 3.0, "frog": 2.0, "hen": 2.0, "pig": 3.0,
    "rooster": 3.0, "sheep": 2.0, "baby": 3.0, "breathing": 1.0, "cough": 1.0, "laughing": 2.0,
    "sipping": 1.0, "sneeze": 1.0, "snoring": 2.0, "speech": 2.0, "birds": 3.0, "cicada": 1.0,
    "crickets": 2.0, "fly": 2.0, "drops": 1.0, "fire": 2.0, "flush": 1.0, "pouring": 1.0,
    "rain": 1.0, "sea": 1.0, "thunder": 1.0, "wind": 1.0, "can_opening": 1.0, "clapping": 2.0,
    "clock_tick": 3.0, "door_knock": 1.0, "fireworks": 1.0, "footsteps": 2.0, "glass": 1.0,
    "keyboard": 2.0, "mouse_click": 1.0, "slam": 1.0, "airplane": 1.0, "chainsaw": 3.0,
    "engine": 2.0, "helicopter": 3.0, "train": 2.0, "vacuum_cleaner": 1.0, "washing_machine": 2.0,
    "alarm": 3.0, "bells": 2.0, "horn": 3.0, "siren": 3.0, "tone": 2.0, "brushing": 1.0,
    "hand_saw": 3.0, "scraping": 1.0, "music": 2.0,
}  # fmt: skip
"""How often a recipe is drawn, relative to the others."""

_FAMILIES = (animals, blows, machines, outdoors, people, signals)
_MADE = {recipe.__name__: recipe for family in _FAMILIES for recipe in family.RECIPES}

RECIPES: Mapping[str, Recipe] = {name: _MADE[name] for name in WEIGHTS}
"""Every recipe takes the number of samples, the rate [Hz] and a generator."""


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

    Returns
    -------
    ndarray, shape (n,)
        [-]

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
        corner = log_uniform(300.0, 4000.0, rng)
        sound = low_pass(low_pass(sound, corner, rate), corner, rate)
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
