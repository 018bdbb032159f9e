"""Further functional forms of every effect, for training only.

The simulator has about three forms of each effect, and a real rig has none of them exactly. These
are some 240 others, many with random shapes, so that the posterior learns the effect rather than a
formula. Each is a row of ``variants.toml``, which names a function and the distribution of its
parameters.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from noise.base import packaged_toml
from noise.base.arrays import Rng
from noise.diagnosis.cases.draws import draw_numbers
from noise.training.causes.cases.variants import chain, contact, drive, sensors
from sim.effects import EFFECTS
from sim.effects.effect import Effect
from sim.parameters import Parameter

__all__ = ["VARIANTS", "Recipe", "draw_variant", "made"]

Recipe = Callable[[float, Rng], Effect]
"""Of a strength from 0 to 1, and a generator."""

_TABLE = packaged_toml(__name__, "variants.toml")
_MAKERS = {**vars(chain), **vars(contact), **vars(drive), **vars(sensors)}


def made(
    function: Callable[..., Any], specs: Mapping[str, Any], strength: float, rng: Rng, **known: Any
) -> dict[str, Any]:
    """Call a function with a strength, drawn parameters, and the known values that it takes.

    Parameters
    ----------
    function : callable
        Function of the strength and the parameters.
    specs : mapping
        Distributions of the parameters, as explained in the tables.
    strength : float
        [-]
    rng : numpy.random.Generator
    **known
        Values that are passed if the function has such a parameter.

    Returns
    -------
    dict of str to object
        Hooks of an `sim.effects.effect.Effect`.
    """
    parameters = inspect.signature(function).parameters
    given = {name: value for name, value in known.items() if name in parameters}
    acting: dict[str, Any] = function(strength, **given, **draw_numbers(specs, rng))
    return acting


def _drawn(name: str, row: Mapping[str, Any], strength: float, rng: Rng) -> Effect:
    """Draw the parameters of a row, and return its effect."""
    given = {key: spec for key, spec in row.items() if key not in ("form", "make")}
    given |= {k: v for k, v in _TABLE["draws"].get(row["make"], {}).items() if k not in row}
    acting = made(_MAKERS[row["make"]], given, strength, rng, form=row["form"])
    own = {"strength": Parameter(strength, "", 0.0, 1.0, "nothing at 0")}
    return Effect(name, EFFECTS[name].stage, (row["form"],), own, "strength", **acting)


VARIANTS: Mapping[str, tuple[Recipe, ...]] = {
    name: tuple(partial(_drawn, name, row) for row in rows)
    for name, rows in _TABLE["forms"].items()
}
"""Recipes by the name of the effect."""


def draw_variant(name: str, strength: float, rng: Rng) -> Effect:
    """Draw one of the further forms of an effect.

    Parameters
    ----------
    name : str
        Key of `VARIANTS`.
    strength : float
        From 0, without an effect, to 1, which is strong [-].
    rng : numpy.random.Generator

    Returns
    -------
    Effect
        With the one form that was drawn.

    Examples
    --------
    >>> import numpy as np
    >>> drawn = draw_variant("clipping", 0.5, np.random.default_rng(0))
    >>> drawn.name, len(drawn.forms)
    ('clipping', 1)
    """
    recipes = VARIANTS[name]
    return recipes[int(rng.integers(len(recipes)))](strength, rng)
