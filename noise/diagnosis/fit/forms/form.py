"""One further form of an effect, as a fit tries it.

The simulator's own forms have parameters with names; a further one has a way to be made of a few
numbers. Both are told of by a `LawSpec` whose ``form`` names which it is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig import LawSpec

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sim.effects.effect import ActiveEffect, Effect

__all__ = ["Form"]


@dataclass(frozen=True, eq=False)
class Form:
    """A further form of an effect.

    Parameters
    ----------
    effect, name : str
        Of the effect; its own, which no other form of the effect may have.
    start : mapping of str to float
        What it is made of, as a fit begins with it [unit of the number].
    highest : mapping of str to float
        How far each may rise [unit of the number].
    make : callable
        ``make(values)``: the effect with these numbers.
    tried : tuple of float
        Of the first of these numbers, what a fit looks at; by default where it begins [unit of the
        number].
    """

    effect: str
    name: str
    start: Mapping[str, float]
    highest: Mapping[str, float]
    make: Callable[[Mapping[str, float]], Effect]
    tried: tuple[float, ...] = ()

    def active(self, given: Mapping[str, float | str]) -> ActiveEffect:
        """Return the effect with these numbers, the others as a fit begins with them.

        Raises
        ------
        ParameterError
            A number that it is not made of.
        """
        values = dict(self.start)
        for key, value in given.items():
            if key == "form":
                continue
            if key not in values or isinstance(value, str):
                raise ParameterError(
                    f"form {self.name!r} of {self.effect!r} has no {key!r}; it has "
                    f"{', '.join(values)}"
                )
            values[key] = value
        return replace(self.make(values).active({}), form=self.name, values=values)

    def specs(self) -> list[LawSpec]:
        """Return what a fit looks at, as models name it."""
        first = next(iter(self.start))
        return [self.spec(**{first: value}) for value in self.tried or (self.start[first],)]

    def spec(self, **values: float) -> LawSpec:
        """Return it as models name it."""
        return LawSpec(self.effect, {"form": self.name, **self.start, **values})
