"""Friction laws, one a file: a new law is a file with a ``LAW`` that is named as the file is."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from models.errors import ParameterError
from sim.registry import Library

if TYPE_CHECKING:
    from models.rig import LawSpec
    from sim.friction.law import FrictionLaw

__all__ = ["LAWS", "at_temperature", "friction_law"]

LAWS: Library[FrictionLaw] = Library(__name__, __path__, "LAW", besides=("law", "shared"))
"""Every friction law by name."""


def at_temperature(spec: LawSpec, temperature: float) -> LawSpec:
    """Return a law at an ambient temperature [degree Celsius], unless it says its own.

    Laws that know none stay as they are.

    Examples
    --------
    >>> from models.rig import LawSpec
    >>> at_temperature(LawSpec("master_curve"), 80.0).parameters
    {'temperature': 80.0}
    >>> at_temperature(LawSpec("coulomb"), 80.0).parameters
    {}
    """
    if "temperature" not in friction_law(spec.name).parameters:
        return spec
    return replace(spec, parameters={"temperature": temperature, **spec.parameters})


def friction_law(name: str) -> FrictionLaw:
    """Return the friction law called `name`.

    Raises
    ------
    ParameterError
        If there is none.

    Examples
    --------
    >>> friction_law("coulomb").parameters
    {}
    """
    if name not in LAWS:
        raise ParameterError(f"friction law {name!r} is unknown; there are {', '.join(LAWS)}")
    return LAWS[name]
