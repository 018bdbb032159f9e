"""One further form of an effect, as a fit tries it.

The simulator's own forms have parameters with names; a further one has a way to be made of a few
numbers. Both are told of by a `LawSpec` whose ``form`` names which it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from models.errors import ParameterError
from models.rig import LawSpec
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect
from sim.parameters import Parameter

_AMOUNT = Parameter(1.0, "", 0.0, 4.0, "over what was estimated")


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


def amount_form(
    effect: str,
    name: str,
    *,
    highest: float = 4.0,
    tried: tuple[float, ...] = (),
    **acting: object,
) -> Form:
    """Make a form of one number, ``amount``: how much there is of what was estimated.

    Parameters
    ----------
    effect, name : str
        As of `Form`.
    highest : float
        How far the amount may rise [-].
    tried : tuple of float
        Amounts that a fit looks at [-]; by default 1.
    **acting : callable
        Hooks, as of `sim.effects.effect.Effect`; they find the amount among their values.

    Examples
    --------
    >>> amount_form("clipping", "hard", tried=(0.05, 0.2)).start
    {'amount': 0.05}
    """

    def make(values: Mapping[str, float]) -> Effect:
        given = {"amount": replace(_AMOUNT, default=values["amount"])}
        stage = EFFECTS[effect].stage
        return Effect(effect, stage, ("estimated",), given, "amount", **acting)  # type: ignore[arg-type]

    return Form(effect, name, {"amount": (*tried, 1.0)[0]}, {"amount": highest}, make, tried)
