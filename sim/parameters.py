"""Declared parameters of friction laws and effects (unit, default, range, meaning), and registries.

Help texts and all messages about unusable values follow from the declarations.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import Generic, TypeVar

from models.errors import ParameterError


@dataclass(frozen=True)
class Parameter:
    """Declaration of a numeric parameter of a friction law or an effect.

    Parameters
    ----------
    default : float
        [`unit`]
    unit : str
    low, high : float
        Allowed range, both ends included [`unit`].
    meaning : str
        One line.
    """

    default: float
    unit: str
    low: float
    high: float
    meaning: str


def resolve(
    owner: str, declared: Mapping[str, Parameter], overrides: Mapping[str, float | str]
) -> dict[str, float]:
    """Return the values of all declared parameters, with defaults for those not set.

    Raises
    ------
    ParameterError
        If a name is not declared, or a value is not a number or out of range.

    Examples
    --------
    >>> declared = {"duration": Parameter(50e-6, "s", 1e-6, 1e-3, "of the pulse")}
    >>> resolve("slip_pulse", declared, {"duration": 1e-4})
    {'duration': 0.0001}
    """
    for name in overrides:
        if name not in declared:
            known = ", ".join(declared) or "none"
            raise ParameterError(f"{owner}: no parameter {name!r}; it has {known}")
    values = {}
    for name, parameter in declared.items():
        raw = overrides.get(name, parameter.default)
        try:
            value = float(raw)
        except (TypeError, ValueError):
            raise ParameterError(f"{owner}: {name} = {raw!r} is no number") from None
        if not (math.isfinite(value) and parameter.low <= value <= parameter.high):
            raise ParameterError(
                f"{owner}: {name} = {value:g} {parameter.unit} is out of range; it must lie in "
                f"[{parameter.low:g}, {parameter.high:g}] {parameter.unit}".rstrip()
            )
        values[name] = value
    return values


_Item = TypeVar("_Item")


class Library(Mapping[str, _Item], Generic[_Item]):
    """Lazy registry of the entries of a package, by name: a module is imported at first use.

    Parameters
    ----------
    package : str
        Full name of the package.
    path : list of str
        Its ``__path__``.
    attribute : str
        Name of the entry in each module.
    besides : tuple of str
        Modules without an entry.
    """

    def __init__(
        self, package: str, path: list[str], attribute: str, besides: tuple[str, ...]
    ) -> None:
        self._package = package
        self._attribute = attribute
        self._names = tuple(
            sorted(module.name for module in iter_modules(path) if module.name not in besides)
        )

    def __getitem__(self, name: str) -> _Item:
        if name not in self._names:
            raise KeyError(name)
        item: _Item = getattr(import_module(f"{self._package}.{name}"), self._attribute)
        return item

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
