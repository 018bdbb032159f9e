"""The rig that a design of a screen stands for, so that it can be heard."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from noise.recordings.folders import is_file
from noise.screening.design.design import load_design
from noise.screening.design.environments import DRY, environment, in_environment

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from models.rig import Rig
    from noise.pages.screening.screen_maps import ScreenMap

__all__ = ["rig_of"]


def rig_of(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig:
    """Find the rig that a design of a screen stands for, as it is in its environment.

    Parameters
    ----------
    screened : ScreenMap
    folder : Path
        Of the screen.
    designs : sequence of Path
        Design files that were named beside it.

    Raises
    ------
    ParameterError
        It is not to be found, or cannot be simulated; the message says so.
    """
    name = screened.design
    files = [path for path in designs if path.stem == name or _named(path) == name]
    beside = (folder / "designs" / f"{name}.toml", folder / f"{name}.toml")
    files += [path for path in beside if is_file(path)]
    surroundings = environment(screened.environment or DRY)
    if files:
        return in_environment(load_design(files[0]).rig, surroundings)
    try:
        return in_environment(load_design(name).rig, surroundings)
    except ParameterError:
        raise ParameterError(
            f"the file of design {name} is not at hand; name {name}.toml beside the screen"
        ) from None


def _named(path: Path) -> str | None:
    try:
        return load_design(path).name
    except BushingNoiseError:
        return None
