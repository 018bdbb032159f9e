"""Maps of screens with the sounds simulated for them."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError
from models.rig import Rig
from noise.base.progress import counted, track
from noise.pages.engine.maps import ConditionMap, Spot, areas_of
from noise.pages.review.design_rig import rig_of
from noise.pages.review.inputs import Refusal
from noise.pages.review.screens import read_screen
from noise.pages.review.simulated import chosen_points, simulated_entry

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from noise.pages.engine.entry import Entry
    from noise.pages.review.inputs import Inputs
    from noise.pages.review.screens import ScreenMap, ScreenPoint

__all__ = ["screened_maps"]


def screened_maps(
    inputs: Inputs, refused: list[Refusal], *, number: int, seed: int
) -> tuple[list[ConditionMap], dict[str, Entry]]:
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
    maps : list of ConditionMap
    heard : dict of str to Entry
        Sounds by id.
    """
    found: list[tuple[Path, ScreenMap]] = []
    for path in inputs.screens:
        try:
            found += [(path, one) for one in read_screen(path)]
        except BushingNoiseError as error:
            refused.append(Refusal.of(path, error))
    if not found:
        return [], {}
    rigs = [_rig(screened, path.parent, inputs.designs) for path, screened in found]
    n_heard = sum(isinstance(rig, Rig) for rig in rigs)
    shares = iter([number // n_heard + (i < number % n_heard) for i in range(n_heard)])
    maps: list[ConditionMap] = []
    heard: dict[str, Entry] = {}
    for (_, screened), rig in track(list(zip(found, rigs, strict=True)), "laying out", unit="map"):
        sounds: list[tuple[ScreenPoint, Entry]] = []
        silent = rig if isinstance(rig, str) else ""
        if isinstance(rig, Rig):
            try:
                chosen = chosen_points(screened.points, next(shares))
                sounds += [
                    (point, simulated_entry(screened, rig, point, seed=seed)) for point in chosen
                ]
            except BushingNoiseError as error:
                silent = str(error)
        keys = [f"m{len(heard) + 1 + i}" for i in range(len(sounds))]
        heard |= {key: entry for key, (_, entry) in zip(keys, sounds, strict=True)}
        maps.append(_map(screened, [point for point, _ in sounds], keys, silent))
    return maps, heard


def _rig(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig | str:
    """Return the rig of a map, or why it cannot be heard."""
    try:
        return rig_of(screened, folder, designs)
    except BushingNoiseError as error:
        return str(error)


def _map(
    screened: ScreenMap, heard: Sequence[ScreenPoint], keys: Sequence[str], silent: str
) -> ConditionMap:
    points = screened.points
    across, up, areas = areas_of(
        np.array([point.speed for point in points]),
        np.array([point.interference for point in points]),
        [point.label for point in points],
    )
    spots = tuple(
        Spot(
            round(across.share(point.speed), 4),
            round(up.share(point.interference), 4),
            point.label,
            point.words,
            (key,),
        )
        for point, key in zip(heard, keys, strict=True)
    )
    told = [f"{counted(len(points), 'point')}{_how(points)}."]
    if spots:
        told.append(
            f"{counted(len(spots), 'sound')} simulated at the spots; a click elsewhere plays the "
            "nearest of the same label."
        )
    if silent:
        told.append(f"{'No more' if spots else 'No'} sounds: {silent}.")
    speed = "Largest speed" if points[0].frequency is not None else "Speed"
    return ConditionMap(screened.title, across, up, areas, spots, " ".join(told), speed)


def _how(points: Sequence[ScreenPoint]) -> str:
    counts = Counter(point.how for point in points if point.how)
    return f" ({', '.join(f'{n} {how}' for how, n in counts.most_common())})" if counts else ""
