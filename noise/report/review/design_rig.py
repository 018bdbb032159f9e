"""The rig that a design of a screen stands for, so that it can be heard."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from models.rig_file import load_material_rig, load_rig

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from models.rig import Rig
    from noise.report.review.screens import ScreenMap

__all__ = ["rig_of"]

_PLAIN = ("", "dry", "nominal")
"""Environments that change nothing about the rig."""


def rig_of(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig:
    """Find the rig that a design of a screen stands for.

    Parameters
    ----------
    screened : ScreenMap
    folder : Path
        Of the screen.
    designs : sequence of Path
        Rig files that were named beside it.

    Raises
    ------
    ParameterError
        It is not to be found, or cannot be simulated; the message says so.
    """
    if screened.environment not in _PLAIN:
        raise ParameterError(
            f"what the environment {screened.environment} changes about the rig is not told"
        )
    name = screened.design
    files = [path for path in designs if path.stem == name or _named(path) == name]
    beside = (folder / "designs" / f"{name}.toml", folder / f"{name}.toml")
    files += [path for path in beside if path.is_file()]
    if files:
        return load_rig(files[0])
    try:
        return load_material_rig(name)
    except ParameterError:
        raise ParameterError(
            f"the rig file of design {name} is not at hand; name {name}.toml beside the screen"
        ) from None


def _named(path: Path) -> str | None:
    try:
        return load_rig(path).name
    except BushingNoiseError:
        return None
