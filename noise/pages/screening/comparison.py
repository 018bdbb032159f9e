"""Designs compared: their maps side by side over the same axes, and what a script needs for more.

The page itself draws which noise occurs where; its script draws from the same cells how loud it is,
how each point is known, and what differs between any two designs.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from models.rig import Rig
from noise.base.label_names import LABELS
from noise.base.progress import counted
from noise.pages.engine.cells import areas_of, cells_of, common_cells
from noise.pages.engine.maps import Axis, ConditionMap, Spot, axis_of
from noise.pages.engine.page import MAP_SIZE
from noise.pages.screening.compared import Compared, Comparison
from noise.pages.screening.looks import way_look
from noise.pages.screening.screen_maps import shared_points
from noise.pages.screening.sounds import chosen_points, simulated_entries

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.pages.engine.cells import Cells
    from noise.pages.engine.entry import Entry
    from noise.pages.screening.screen_maps import ScreenMap, ScreenPoint, SharedPoint

__all__ = ["compare_designs"]

_FEW_ROWS = 8
"""So many interferences are named by their own numbers."""

_LEAST_HEIGHT, _ROW_HEIGHT = 180.0, 40.0
"""Of a map of few interferences, and what each adds [px]."""

_MOST_HEARD = 12
"""Conditions of one map that are heard: more would hide it."""

_TICK_APART = 18.0
"""Least distance of numbers along the interference [px]."""


def compare_designs(
    maps: Sequence[ScreenMap],
    rigs: Sequence[Rig | str],
    *,
    number: int,
    seed: int,
    workers: int = 1,
    pair: tuple[str, str] | None = None,
) -> tuple[Compared, dict[str, Entry]]:
    """Lay maps of designs side by side, and simulate what is heard on them.

    Parameters
    ----------
    maps : sequence of ScreenMap
    rigs : sequence of (Rig or str)
        Of each map, or why it cannot be heard.
    number : int
        Of sounds, of all maps together.
    seed : int
    workers : int
        Threads; -1 is one a core.
    pair : tuple of str, optional
        Designs that are compared at first; by default the first two.

    Returns
    -------
    compared : Compared
    heard : dict of str to Entry
        Sounds by id.
    """
    names = list(dict.fromkeys(one.design for one in maps))
    places = _places(maps)
    shared = [shared_points([maps[i] for i in members]) for members in places]
    most = _shares(number, [sum(isinstance(rigs[i], Rig) for i in of) for of in places])
    chosen = [chosen_points(points, n) if n else [] for points, n in zip(shared, most, strict=True)]
    jobs: list[tuple[int, ScreenPoint, Rig]] = []
    for members, points in zip(places, chosen, strict=True):
        for point in points:
            for i, own in zip(members, point.points, strict=True):
                if own is not None and isinstance(rig := rigs[i], Rig):
                    jobs.append((i, own, rig))
    heard: dict[str, Entry] = {}
    keys: dict[tuple[int, float, float], str] = {}
    silent = {i: rig for i, rig in enumerate(rigs) if isinstance(rig, str)}
    entries = simulated_entries(
        [(maps[i], rig, own) for i, own, rig in jobs], seed=seed, workers=workers
    )
    for (i, own, _), entry in zip(jobs, entries, strict=True):
        if isinstance(entry, str):
            silent.setdefault(i, entry)
            continue
        keys[i, own.speed, own.interference] = key = f"m{len(heard) + 1}"
        heard[key] = entry
    comparisons = tuple(
        _laid_out(
            [maps[i] for i in members],
            [names.index(maps[i].design) for i in members],
            [
                (one, tuple(keys.get((i, one.speed, one.interference), "") for i in members))
                for one in points
            ],
            [silent.get(i, "") for i in members],
            len(names),
        )
        for members, points in zip(places, chosen, strict=True)
    )
    first, second = pair or (names[0], names[min(1, len(names) - 1)])
    return Compared(tuple(names), comparisons, (names.index(first), names.index(second))), heard


def _places(maps: Sequence[ScreenMap]) -> list[list[int]]:
    """Numbers of the maps that are of one environment, motion, temperature and support."""
    places: dict[str, list[int]] = {}
    for i, one in enumerate(maps):
        places.setdefault(one.where, []).append(i)
    return list(places.values())


def _shares(number: int, designs: Sequence[int]) -> list[int]:
    """Share sounds out: how many conditions are heard at each place, of so many designs there."""
    shares, left = [0] * len(designs), number
    while True:
        before = left
        for i, n in enumerate(designs):
            if 0 < n <= left:
                shares[i] += 1
                left -= n
        if left == before:
            return [min(share, _MOST_HEARD) for share in shares]


def _laid_out(
    maps: Sequence[ScreenMap],
    designs: Sequence[int],
    heard: Sequence[tuple[SharedPoint, tuple[str, ...]]],
    silent: Sequence[str],
    n_designs: int,
) -> Comparison:
    """Lay maps out whose designs have these numbers."""
    cells = common_cells(
        [
            cells_of(
                np.array([point.speed for point in one.points]),
                np.array([point.interference for point in one.points]),
            )
            for one in maps
        ]
    )
    across = axis_of(cells[0].speed_edges, edges=True)
    fits = sorted({point.interference for one in maps for point in one.points})
    height = min(MAP_SIZE[1], _LEAST_HEIGHT + _ROW_HEIGHT * len(fits))
    up = _fit_axis(cells[0], fits, height)
    speed = "Largest speed" if maps[0].points[0].frequency is not None else "Speed"
    laid = [
        ConditionMap(
            one.design,
            across,
            up,
            areas_of(of, [p.label for p in one.points], across, up, (MAP_SIZE[0], height)),
            _spots(across, up, heard, i, designs, n_designs),
            _own_note(one, why),
            speed,
            height,
            number,
            compared=True,
        )
        for i, (one, of, number, why) in enumerate(zip(maps, cells, designs, silent, strict=True))
    ]
    ways = tuple(dict.fromkeys(point.how for one in maps for point in one.points))
    difference = None
    if len(maps) > 1:
        spots = _spots(across, up, heard, None, designs, n_designs)
        difference = ConditionMap(
            "Difference", across, up, (), spots, "", speed, height, compared=True
        )
    return Comparison(
        maps[0].where,
        tuple(laid),
        difference,
        {
            "ways": ways,
            "x": [round(MAP_SIZE[0] * across.share(float(x)), 2) for x in cells[0].speed_edges],
            "y": [round(height * (1 - up.share(float(y))), 2) for y in cells[0].interference_edges],
            "designs": {
                str(number): _cell_values(one, of, ways)
                for one, of, number in zip(maps, cells, designs, strict=True)
            },
        },
        ways,
        _note(maps, heard),
    )


def _cell_values(one: ScreenMap, cells: Cells, ways: Sequence[str]) -> dict[str, object]:
    """Label, level and how it is known of each cell, the lowest row first."""
    points = [one.points[i] if i >= 0 else None for i in cells.point.ravel().tolist()]
    notes = list(dict.fromkeys(["", *(point.note for point in one.points)]))
    return {
        # Numbers of labels; -1 where it was not screened.
        "label": [-1 if point is None else LABELS.index(point.label) for point in points],
        "level": [
            None if point is None or point.level is None else round(point.level, 1)
            for point in points
        ],
        "how": [-1 if point is None else ways.index(point.how) for point in points],
        "notes": notes,
        "note": [0 if point is None else notes.index(point.note) for point in points],
    }


def _fit_axis(cells: Cells, fits: Sequence[float], height: float) -> Axis:
    """Axis of interference; few are named by their own numbers, those that have room."""
    up = axis_of(cells.interference_edges, edges=True)
    if len(fits) > _FEW_ROWS:
        return up
    ticks: list[tuple[float, str]] = []
    for fit in fits:
        share = round(up.share(fit), 4)
        if not ticks or height * (share - ticks[-1][0]) >= _TICK_APART:
            ticks.append((share, f"{fit:.4g}"))
    return Axis(up.low, up.high, tuple(ticks))


def _spots(
    across: Axis,
    up: Axis,
    heard: Sequence[tuple[SharedPoint, tuple[str, ...]]],
    own: int | None,
    designs: Sequence[int],
    n_designs: int,
) -> tuple[Spot, ...]:
    """Spots of one of the maps, or of their difference."""
    spots = []
    for shared, keys in heard:
        point = None if own is None else shared.points[own]
        if own is not None and (point is None or not keys[own]):
            continue
        mates = [""] * n_designs
        for number, key in zip(designs, keys, strict=True):
            mates[number] = key
        where = f"{shared.speed:.3g} rad/s, {shared.interference:.3g} mm"
        spots.append(
            Spot(
                round(across.share(shared.speed), 4),
                round(up.share(shared.interference), 4),
                "" if point is None else point.label,
                where if point is None else point.words,
                tuple(filter(None, keys)) if own is None else (keys[own],),
                tuple(mates),
            )
        )
    return tuple(spots)


def _own_note(one: ScreenMap, silent: str) -> str:
    """Say what to know of a map: where its data are not the design's own, and why it is silent."""
    counts = Counter(part for point in one.points for part in point.note.split("; ") if part)
    told = [
        f"{part[0].upper()}{part[1:]}: {'all' if n == len(one.points) else n} points."
        for part, n in counts.most_common()
    ]
    return " ".join([*told, *([f"No sounds: {silent}."] if silent else [])])


def _note(maps: Sequence[ScreenMap], heard: Sequence[tuple[SharedPoint, tuple[str, ...]]]) -> str:
    """How many points there are, how they are known, and how many are heard."""
    counts = Counter(point.how for one in maps for point in one.points if point.how)
    how = "; ".join(f"{n} {way_look(how).mark}" for how, n in counts.most_common())
    n_points = counted(max(len(one.points) for one in maps), "point")
    of_all = " of each design; of all" if len(maps) > 1 else ""
    told = [f"{n_points}{of_all}: {how}." if how else f"{n_points}{of_all[:15]}."]
    n_sounds = sum(bool(key) for _, keys in heard for key in keys)
    if n_sounds:
        told.append(
            f"{counted(n_sounds, 'sound')} simulated at the spots; a click elsewhere plays the "
            "nearest of the same label."
        )
    return " ".join(told)
