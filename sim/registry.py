"""A folder of modules as a mapping: each file offers one object under its own name.

So a new friction law or effect is one new file and nothing else changes, and only those that a run
needs are imported.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from pkgutil import iter_modules
from typing import Generic, TypeVar

__all__ = ["Library"]

_Item = TypeVar("_Item")


class Library(Mapping[str, _Item], Generic[_Item]):
    """What the modules of a package offer, by name, imported when it is looked up.

    Parameters
    ----------
    package : str
        Its full name.
    path : list of str
        Its ``__path__``.
    attribute : str
        Name of the object in each module.
    besides : tuple of str
        Modules that offer none.
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
