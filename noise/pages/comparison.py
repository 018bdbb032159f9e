"""Comparison of designs: maps side by side over common axes, and data for the script.

The page draws noise and level maps; its script draws the difference of any two designs from the
same cells. Words or numbers on the maps repeat the meaning of colours.
"""

from __future__ import annotations

import json
from bisect import bisect
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.rig import Rig
from noise.base.labels import LABEL_LOOKS, MAP_LABELS, Look
from noise.base.progress import counted
from noise.pages.clips import Entry
from noise.pages.maps import (
    LEVEL_STEPS,
    LEVELS,
    MAP_SIZE,
    Area,
    Axis,
    Cells,
    ConditionMap,
    Spot,
    areas_of,
    axis_of,
    cells_of,
    common_cells,
)
from noise.pages.screen_sounds import (
    ScreenMap,
    ScreenPoint,
    SharedPoint,
    chosen_points,
    shared_points,
    simulated_entries,
)

DIFFERENCES = {
    "gone": Look("#3f8fc4", "#dcebf6", "lines", "noise gone"),
    "softer-much": Look("#8dbfe0", "#3f6f94", "plain", "softer by 10 dB or more"),
    "softer": Look("#cfe3f1", "#3f6f94", "plain", "softer by 3 to 10 dB"),
    "alike": Look("#e3e6e9", "#6f7b87", "plain", "within 3 dB"),
    "louder": Look("#fbdcbc", "#94592a", "plain", "louder by 3 to 10 dB"),
    "louder-much": Look("#f0a55f", "#94592a", "plain", "louder by 10 dB or more"),
    "new": Look("#c4571b", "#fbe3d3", "stripes", "noise new"),
    "quiet": Look("#ffffff", "#c9d0d7", "dots", "none in both"),
}
"""Looks of the difference of two designs."""

_HOW_WORDS = {
    "refined": "interpolated",
    "beyond": "not run: vibration dies before",
    "unchanged": "as at another temperature or fit",
}
"""Words for the origin of a point."""

_MOST_OPEN = 4
"""Number of comparisons that are open at first."""

_MAP_BYTES, _AREA_BYTES = 12_000.0, 250.0
"""Maximum sizes of a map and of an area [byte]."""


@dataclass(frozen=True)
class Place:
    """Maps of designs in one environment, motion, temperature and support.

    Parameters
    ----------
    title : str
    maps : tuple of ConditionMap
        One per design; for several designs, another one for the difference.
    cells : dict
        Data of the script: edges of the cells, label and level of each design.
    note : str
    """

    title: str
    maps: tuple[ConditionMap, ...]
    cells: dict[str, object]
    note: str


@dataclass(frozen=True)
class Compared:
    """Content of a comparison.

    Parameters
    ----------
    names : tuple of str
        Names of the designs.
    places : tuple of Place
        One per environment, motion, temperature and support.
    pair : tuple of int
        Indices of the designs compared at first.
    """

    names: tuple[str, ...]
    places: tuple[Place, ...]
    pair: tuple[int, int]
    most_open: int = _MOST_OPEN

    @property
    def n_maps(self) -> int:
        """Number of maps of designs."""
        return sum(of.design is not None for one in self.places for of in one.maps)

    @property
    def weight(self) -> float:
        """Maximum size of the maps on a page [byte]."""
        n_areas = sum(len(of.areas) + len(of.levels) for one in self.places for of in one.maps)
        return _MAP_BYTES * self.n_maps + _AREA_BYTES * n_areas + len(json.dumps(self.data))

    @property
    def looks(self) -> dict[str, Look]:
        """Looks of labels, levels and differences."""
        return LABEL_LOOKS | LEVELS | DIFFERENCES

    @property
    def keys(self) -> list[tuple[str, str, list[tuple[str, str]]]]:
        """Legends: name, heading, and looks with words."""
        looks = self.looks
        kinds = {
            "level": ("L_Aeq in dB(A):", list(LEVELS)),
            "difference": ("Difference, B against A:", list(DIFFERENCES)),
        }  # fmt: skip
        if len(self.names) < 2:
            del kinds["difference"]
        return [
            (name, words, [(key, looks[key].mark) for key in keys])
            for name, (words, keys) in kinds.items()
        ]

    @property
    def data(self) -> dict[str, object]:
        """Data of the script."""
        return {
            "names": self.names,
            "labels": MAP_LABELS,
            "pair": self.pair,
            "places": [one.cells for one in self.places],
        }


_FEW_ROWS = 8
"""Maximum number of interferences with individual ticks."""

_LEAST_HEIGHT, _ROW_HEIGHT = 180.0, 40.0
"""Height of a map: base and increment per interference [px]."""

_MOST_SOUNDS = 12
"""Maximum number of audible conditions per map."""

_TICK_APART = 18.0
"""Minimum distance of ticks of interference [px]."""


def compare_designs(
    maps: Sequence[ScreenMap],
    rigs: Sequence[Rig | str],
    *,
    number: int,
    seed: int,
    workers: int = 1,
    pair: tuple[str, str] | None = None,
) -> tuple[Compared, dict[str, Entry]]:
    """Lay maps of designs side by side, and simulate their sounds.

    Parameters
    ----------
    maps : sequence of ScreenMap
    rigs : sequence of (Rig or str)
        Rig of each map, or the reason why it has no sound.
    number : int
        Number of sounds of all maps together.
    seed : int
    workers : int
        Threads; -1 is one a core.
    pair : tuple of str, optional
        Designs compared at first; by default the first two.

    Returns
    -------
    compared : Compared
    sounds : dict of str to Entry
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
    sounds: dict[str, Entry] = {}
    keys: dict[tuple[int, float, float], str] = {}
    silent = {i: rig for i, rig in enumerate(rigs) if isinstance(rig, str)}
    entries = simulated_entries(
        [(maps[i], rig, own) for i, own, rig in jobs], seed=seed, workers=workers
    )
    for (i, own, _), entry in zip(jobs, entries, strict=True):
        if isinstance(entry, str):
            silent.setdefault(i, entry)
            continue
        keys[i, own.speed, own.interference] = key = f"m{len(sounds) + 1}"
        sounds[key] = entry
    laid = tuple(
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
    at = names.index(first), names.index(second)
    return Compared(tuple(names), laid, at), sounds


def _places(maps: Sequence[ScreenMap]) -> list[list[int]]:
    """Return the indices of maps of the same environment, motion, temperature and support."""
    places: dict[str, list[int]] = {}
    for i, one in enumerate(maps):
        places.setdefault(one.where, []).append(i)
    return list(places.values())


def _shares(number: int, designs: Sequence[int]) -> list[int]:
    """Return the number of audible conditions of each place, given its number of designs."""
    shares, left = [0] * len(designs), number
    while True:
        before = left
        for i, n in enumerate(designs):
            if 0 < n <= left:
                shares[i] += 1
                left -= n
        if left == before:
            return [min(share, _MOST_SOUNDS) for share in shares]


def _laid_out(
    maps: Sequence[ScreenMap],
    designs: Sequence[int],
    audible: Sequence[tuple[SharedPoint, tuple[str, ...]]],
    silent: Sequence[str],
    n_designs: int,
) -> Place:
    """Lay out the maps of one place."""
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

    def condition_map(
        title: str,
        own: int | None,
        areas: tuple[Area, ...] = (),
        levels: tuple[Area, ...] = (),
        note: str = "",
    ) -> ConditionMap:
        spots = _spots(across, up, audible, own, designs, n_designs)
        number = None if own is None else designs[own]
        return ConditionMap(
            title, across, up, areas, spots, note, speed, height, number, True, levels
        )

    laid = []
    for own, (one, of, why) in enumerate(zip(maps, cells, silent, strict=True)):
        kinds = [point.label for point in one.points], list(map(_level_step, one.points))
        areas, levels = (areas_of(of, kind, across, up, (MAP_SIZE[0], height)) for kind in kinds)
        laid.append(condition_map(one.design, own, areas, levels, _own_note(one, why)))
    if len(maps) > 1:
        laid.append(condition_map("Difference: B against A", None))
    values: dict[str, object] = {
        "x": [round(MAP_SIZE[0] * across.share(float(x)), 2) for x in cells[0].speed_edges],
        "y": [round(height * (1 - up.share(float(y))), 2) for y in cells[0].interference_edges],
        "designs": {
            str(number): _cell_values(one, of)
            for one, of, number in zip(maps, cells, designs, strict=True)
        },
    }
    return Place(maps[0].where, tuple(laid), values, _note(maps, audible))


def _level_step(point: ScreenPoint) -> str:
    """Return the look of the level of a point, ``none`` if it is quiet."""
    if point.label == "none" or point.level is None:
        return "none"
    return f"level-{bisect(LEVEL_STEPS, point.level)}"


def _cell_values(one: ScreenMap, cells: Cells) -> dict[str, object]:
    """Return label and level of each cell, lowest row first."""
    points = [one.points[i] if i >= 0 else None for i in cells.point.ravel().tolist()]
    return {
        # Numbers of labels; -1 where it was not screened.
        "label": [-1 if point is None else MAP_LABELS.index(point.label) for point in points],
        "level": [
            None if point is None or point.level is None else round(point.level, 1)
            for point in points
        ],
    }


def _fit_axis(cells: Cells, fits: Sequence[float], height: float) -> Axis:
    """Return the axis of interference, with ticks at the values if they are few."""
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
    audible: Sequence[tuple[SharedPoint, tuple[str, ...]]],
    own: int | None,
    designs: Sequence[int],
    n_designs: int,
) -> tuple[Spot, ...]:
    """Return the spots of a map or of the difference."""
    spots = []
    for shared, keys in audible:
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
    """Return the note of a map: substituted data, and why it has no sounds."""
    counts = Counter(part for point in one.points for part in point.note.split("; ") if part)
    notes = [
        f"{part[0].upper()}{part[1:]}: {'all' if n == len(one.points) else n} points."
        for part, n in counts.most_common()
    ]
    return " ".join([*notes, *([f"No sounds: {silent}."] if silent else [])])


def _note(maps: Sequence[ScreenMap], audible: Sequence[tuple[SharedPoint, tuple[str, ...]]]) -> str:
    """Return the note of a place: number and origin of its points, number of sounds."""
    counts = Counter(point.how for one in maps for point in one.points if point.how)
    how = "; ".join(f"{n} {_HOW_WORDS.get(how, how)}" for how, n in counts.most_common())
    n_points = counted(max(len(one.points) for one in maps), "point")
    of_all = " of each design; of all" if len(maps) > 1 else ""
    sentences = [f"{n_points}{of_all}: {how}." if how else f"{n_points}{of_all[:15]}."]
    n_sounds = sum(bool(key) for _, keys in audible for key in keys)
    if n_sounds:
        sentences.append(
            f"{counted(n_sounds, 'sound')} simulated at the spots; a click elsewhere plays the "
            "nearest of the same label."
        )
    return " ".join(sentences)
