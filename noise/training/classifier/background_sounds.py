"""Synthetic sounds without friction, labelled ``unknown``: rows of ``background_sounds.toml``.

Each row follows the physical origin of a kind of sound, with wide ranges. The most frequent ones
are most similar to noises: as tonal as a squeal (calls, whistles, beeps), as pulsed as a creak
(crackle, typing, croaks), as harmonic as a squawk (hum, engines, horns).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from noise.base import packaged_toml
from noise.base.arrays import Array, Rng
from noise.training.classifier.synthesis import synthesised
from noise.training.draws import log_uniform, low_pass, picked

BACKGROUND_SOUNDS: Mapping[str, Mapping[str, Any]] = packaged_toml(
    "noise.training.classifier", "background_sounds.toml"
)
"""Rows by name; ``surroundings`` lists where a sound may occur, of car and rig."""

WEIGHTS = {name: float(row["weight"]) for name, row in BACKGROUND_SOUNDS.items()}
"""Relative frequencies of the sounds."""


def background_sound(
    n: int, rate: float, rng: Rng, name: str | None = None, *, alone: bool = False
) -> Array:
    """Return a random background sound of unit peak, sometimes with a second one.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator
    name : str, optional
        One of `BACKGROUND_SOUNDS`; by default one is drawn.
    alone : bool
        Whether the sound is close and has no second one.

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
    if chance < 0.12:  # simultaneous
        sound = sound + 10.0 ** (rng.uniform(-25.0, -3.0) / 20.0) * _alone(n, rate, rng)
    elif chance < 0.2:  # subsequent
        cut = int(rng.uniform(0.4, 0.8) * n)
        sound[cut:] = rng.uniform(0.2, 1.0) * _alone(n - cut, rate, rng)
    if not alone and rng.random() < 0.2:  # distant, or behind a wall
        corner = log_uniform(300.0, 4000.0, rng)
        sound = low_pass(low_pass(sound, corner, rate), corner, rate)
    return np.asarray(sound / np.abs(sound).max())


def _alone(n: int, rate: float, rng: Rng, name: str | None = None) -> Array:
    drawn = name or picked(WEIGHTS, rng)
    for _ in range(5):  # a pause between blows may be longer than the sound
        sound = synthesised(BACKGROUND_SOUNDS[drawn], n, rate, rng)
        if sound.std() > 1e-3:
            break
    return np.asarray(sound / np.abs(sound).max())
