"""Friction laws, one file each: a new law is a file with a ``LAW`` of the same name."""

from models.errors import ParameterError
from models.schema import did_you_mean
from sim.friction.law import FrictionLaw
from sim.parameters import Library

__all__ = ["LAWS", "friction_law"]

LAWS: Library[FrictionLaw] = Library(__name__, __path__, "LAW", besides=("law", "shared"))
"""Friction laws by name."""


def friction_law(name: str) -> FrictionLaw:
    """Return a friction law by its name.

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
        raise ParameterError(
            f"friction law {name!r} is unknown{did_you_mean(name, LAWS)}; there are "
            f"{', '.join(LAWS)}"
        )
    return LAWS[name]
