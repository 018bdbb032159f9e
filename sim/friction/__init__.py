"""Friction laws, one a file. A new law is a file with a ``LAW`` and one line here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ParameterError
from sim.friction import contact_with_memory, coulomb, lugre

if TYPE_CHECKING:
    from sim.friction.law import FrictionLaw

__all__ = ["LAWS", "friction_law"]

LAWS: dict[str, FrictionLaw] = {
    module.LAW.name: module.LAW for module in (coulomb, contact_with_memory, lugre)
}
"""Every friction law by name."""


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
