"""What of a design is kept: a rig file."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.app.design.design import design_of
from noise.base.atomic import atomic

if TYPE_CHECKING:
    from pathlib import Path

    from noise.app.design.bases import Base

__all__ = ["name_of", "save_rig"]

_NAME = re.compile(r"[\w][\w .+-]{0,79}")


def name_of(said: object) -> str:
    """Return a name for files that a request states, without ending.

    Raises
    ------
    ParameterError
        It is none, or leads elsewhere.

    Examples
    --------
    >>> name_of({"name": "softer"})
    'softer'
    """
    name = said.get("name") if isinstance(said, dict) else None
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name.endswith((".", " ")):
        raise ParameterError(
            "name: must begin with a letter or digit and hold letters, digits, spaces, and . _ + - "
            "alone, 80 at most"
        )
    return name.removesuffix(".toml")


def save_rig(said: object, bases: dict[str, Base], folder: Path) -> dict[str, str]:
    """Write a design as a rig file, and tell where and how it is simulated.

    Raises
    ------
    ParameterError
        The design or its name cannot be, or a file has that name that is another's.
    """
    design, name = design_of(said, bases), f"{name_of(said)}.toml"
    target = folder / name
    again = isinstance(said, dict) and said.get("replace") is True
    if target.exists() and not again:
        raise ParameterError(f"{name} is there already; take another name, or save again over it")
    if any(base.file is not None and base.file.absolute() == target for base in bases.values()):
        raise ParameterError(f"{name} is a rig file that is open; take another name")
    with atomic(target) as part:
        part.write_text(design.text(folder, name), encoding="utf-8")
    return {
        "file": str(target),
        "command": f"bushing-noise simulate --rig {name} {design.options} --out heard",
    }
