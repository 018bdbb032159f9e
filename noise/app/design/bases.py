"""What a design can start from: the shipped materials, and the rig files that were opened."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig_file import base_name, load_material_rig, material_names, read_toml, rig_from
from noise.app.design.controls import Control, controls_of
from noise.app.design.heard import heard_values

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from models.rig import Rig
    from noise.app.opened import Opened

__all__ = ["Base", "base_of", "bases_of"]


@dataclass(frozen=True)
class Base:
    """A rig that designs are changes of.

    Parameters
    ----------
    name : str
        What it is called in the browser.
    file : Path or None
        None for a material.
    """

    name: str
    file: Path | None = None

    @property
    def _where(self) -> str:
        return f"rig file {self.file}"

    @cached_property
    def _content(self) -> dict[str, Any]:
        return {} if self.file is None else read_toml(self.file, self._where)

    @cached_property
    def rig(self) -> Rig:
        """As it was when it was first asked for."""
        if self.file is None:
            return load_material_rig(self.name)
        return rig_from(self._content, self.file.parent, self._where)

    @cached_property
    def controls(self) -> list[Control]:
        """What can be changed about it; the condition is that which the file was heard at."""
        heard = heard_values(self._content, self._where)
        try:
            return controls_of(self.rig, heard)
        except ParameterError as error:
            raise ParameterError(f"{self._where}, design.heard: {error}") from None

    @property
    def heard(self) -> bool:
        """Whether the file says at which condition."""
        return bool(heard_values(self._content, self._where))

    def named_in(self, folder: Path) -> str:
        """Name it as ``base`` in a rig file of a folder."""
        return self.name if self.file is None else base_name(self.file, folder)


def bases_of(opened: Opened) -> dict[str, Base]:
    """Return all bases by what requests call them: rig files by number first, then materials.

    Raises
    ------
    BushingNoiseError
        A rig file cannot be read.

    Examples
    --------
    >>> from noise.app.opened import open_paths
    >>> next(iter(bases_of(open_paths([]))))
    'fluorocarbon'
    """
    found = {f"rig {i}": Base(path.name, path) for i, path in enumerate(opened.rigs)}
    for named in found.values():
        _ = named.controls  # what is wrong with it is told where it was named
    names = sorted(material_names(), key=lambda name: (name != "fluorocarbon", name.lower()))
    return found | {name: Base(name) for name in names}


def base_of(said: object, bases: dict[str, Base]) -> Base:
    """Return the base that a request names.

    Raises
    ------
    ParameterError
        There is none.
    """
    if not isinstance(said, str) or said not in bases:
        raise ParameterError(f"design: base {str(said)[:40]!r} is none of {', '.join(bases)}")
    return bases[said]
