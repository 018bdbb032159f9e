"""Sounds that no friction makes, a row of ``background_sounds.toml`` each: the label ``unknown``.

Not a likeness of any recording: each row follows how a sound of its kind comes about, with wide
ranges. The hardest are dearest: what is as tonal as a squeal (calls, whistles, beeps), as pulsed as
a creak (crackle, typing, croaks), as harmonic as a squawk (hum, engines, horns).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from noise.base import packaged_toml
from noise.training.classifier.background_sounds.synthesis import synthesised
from noise.training.draws import log_uniform, low_pass, picked

__all__ = ["BACKGROUND_SOUNDS", "WEIGHTS", "background_sound"]

BACKGROUND_SOUNDS: Mapping[str, Mapping[str, Any]] = packaged_toml(
    __name__, "background_sounds.toml"
)
"""Rows by name; ``heard`` says whether in a car, at a rig."""

WEIGHTS = {name: float(row["weight"]) for name, row in BACKGROUND_SOUNDS.items()}
"""How often a sound is drawn, relative to the others."""


def background_sound(
    n: int, rate: float, rng: np.random.Generator, name: str | None = None, *, alone: bool = False
) -> NDArray[np.float64]:
    """Return `n` samples of a sound of unit peak; now and then a second one sounds besides.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator
    name : str, optional
        One of `BACKGROUND_SOUNDS`; by default one is drawn.
    alone : bool
        Whether it is close by, and nothing sounds besides.

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
    sound = _alone(n, rate, rng, name)
    chance = 1.0 if alone else rng.random()
    if chance < 0.12:  # over it
        sound = sound + 10.0 ** (rng.uniform(-25.0, -3.0) / 20.0) * _alone(n, rate, rng)
    elif chance < 0.2:  # after it
        cut = int(rng.uniform(0.4, 0.8) * n)
        sound[cut:] = rng.uniform(0.2, 1.0) * _alone(n - cut, rate, rng)
    if not alone and rng.random() < 0.2:  # far away, or behind a wall
        corner = log_uniform(300.0, 4000.0, rng)
        sound = low_pass(low_pass(sound, corner, rate), corner, rate)
    return np.asarray(sound / np.abs(sound).max())


def _alone(
    n: int, rate: float, rng: np.random.Generator, name: str | None = None
) -> NDArray[np.float64]:
    drawn = name or picked(WEIGHTS, rng)
    for _ in range(5):  # a rest between two blows may be longer than this
        sound = synthesised(BACKGROUND_SOUNDS[drawn], n, rate, rng)
        if sound.std() > 1e-3:
            break
    return np.asarray(sound / np.abs(sound).max())
