"""Maps of screens that are read back, and whether their designs are at hand to be heard."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError
from noise.pages.review.design_rig import rig_of
from noise.pages.review.inputs import Refusal
from noise.pages.review.screens import read_screen
from noise.pages.screening.comparison import compare_designs

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from models.rig import Rig
    from noise.pages.engine.entry import Entry
    from noise.pages.review.inputs import Inputs
    from noise.pages.screening.compared import Compared
    from noise.pages.screening.screen_maps import ScreenMap

__all__ = ["screened_maps"]


def screened_maps(
    inputs: Inputs, refused: list[Refusal], *, number: int, seed: int
) -> tuple[Compared | None, dict[str, Entry]]:
    """Lay screens out, and simulate what is heard on them.

    Parameters
    ----------
    inputs : Inputs
    refused : list of Refusal
        Takes what cannot be read.
    number : int
        Of sounds, of all maps together.
    seed : int

    Returns
    -------
    compared : Compared or None
        None where there is no screen.
    heard : dict of str to Entry
        Sounds by id.
    """
    maps: list[ScreenMap] = []
    rigs: list[Rig | str] = []
    for path in inputs.screens:
        try:
            found = read_screen(path)
        except BushingNoiseError as error:
            refused.append(Refusal.of(path, error))
            continue
        rigs += [_rig(one, path.parent, inputs.designs) for one in found]
        if {one.title for one in maps} & {one.title for one in found}:
            found = [replace(one, design=f"{one.design}, {path.parent.name}") for one in found]
        maps += found
    if not maps:
        return None, {}
    return compare_designs(maps, rigs, number=number, seed=seed)


def _rig(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig | str:
    """Return the rig of a map, or why it cannot be heard."""
    try:
        return rig_of(screened, folder, designs)
    except BushingNoiseError as error:
        return str(error)
