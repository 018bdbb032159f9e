"""Maps of designs side by side over common axes, with simulated sounds at selected points.

Words or numbers on the maps repeat the meaning of colours. A screen knows thousands of conditions,
and nobody listens to them all: each chosen condition is heard of every design. Chosen are where
each noise of each design is loudest, the middles of the regions of each combination of noises, and
points far from these; a click anywhere else plays the nearest.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from features.kernels.weighting import a_weighted_level
from models.errors import BushingNoiseError
from models.rig import Rig
from noise.audio.sound import RATE, audible
from noise.base.labels import NAMED, PERSISTS
from noise.base.progress import track
from noise.batch.work import one_thread
from noise.pages.clips import Entry
from noise.pages.maps import MAP_SIZE, ConditionMap, Spot, areas_of, axis_of
from noise.pictures.figure import support_words
from noise.screening.mapping import REFINED
from noise.screening.point import swing
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from noise.screening.mapping import DesignMap
    from noise.screening.screen import Screening

SECONDS = 2.0
"""Duration of a simulated sound [s]."""

MOST_SILENT = 2
"""Maximum number of sounds of a place that are ``none`` of every design."""

_MOST_SOUNDS = 12
"""Maximum number of audible conditions of a place."""

_NEAR = 0.05
"""Distance of points of the same labels that sound alike, as a share of the axes."""

_LEAST_HEIGHT, _ROW_HEIGHT = 180.0, 40.0
"""Height of a map: base and increment per interference [px]."""


@dataclass(frozen=True)
class Place:
    """Maps of the designs in one environment and motion, at one temperature, on one support.

    Parameters
    ----------
    maps : tuple of DesignMap
    temperature, support : int
        Indices on the grid, which the maps share.
    """

    maps: tuple[DesignMap, ...]
    temperature: int
    support: int

    @property
    def title(self) -> str:
        """Environment, motion, temperature and support."""
        one = self.maps[0]
        parts = [one.environment] + [one.motion] * (one.motion != "steady")
        parts.append(f"{one.grid.temperature[self.temperature]:g} °C")
        return ", ".join([*parts, support_words(one.grid.support_stiffness[self.support])])

    def of(self, name: str) -> NDArray[np.generic]:
        """Return an array of the maps, shape (n_designs, n_fits, n_speeds)."""
        return np.stack([getattr(one, name)[self.temperature, self.support] for one in self.maps])


def places_of(screening: Screening) -> list[Place]:
    """Return the places of a screening.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0, math.inf)))
    >>> [one.title for one in places_of(found)]
    ['dry, 23 °C, 2214 Nm/rad', 'dry, 23 °C, clamp fixed']
    """
    alike: dict[tuple[str, str], list[DesignMap]] = {}
    for one in screening.maps:
        alike.setdefault((one.environment, one.motion), []).append(one)
    return [
        Place(tuple(maps), temperature, support)
        for maps in alike.values()
        for temperature, support in np.ndindex(maps[0].grid.shape[:2])
    ]


def chosen_points(place: Place, most: int) -> list[tuple[int, int]]:
    """Return the conditions with sounds: row and column, in the order of the speed.

    Parameters
    ----------
    place : Place
    most : int
        How many at most.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(1.0, 5.0, 9.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> chosen_points(places_of(screen(["PDMS"], use))[0], 12)
    [(0, 0), (0, 1)]
    """
    label, level = place.of("label"), place.of("level").astype(float)
    grid = place.maps[0].grid
    axes = (np.array(axis) for axis in (grid.interference, grid.speed))
    fits, speeds = ((axis - axis[0]) / (np.ptp(axis) or 1.0) for axis in axes)
    at = np.stack(np.meshgrid(fits, speeds, indexing="ij"), axis=-1).reshape(-1, 2)
    labels, levels = (one.reshape(one.shape[0], -1).T for one in (label, level))
    combination = np.unique(labels, axis=0, return_inverse=True)[1].reshape(-1)
    silent = (labels == "none").all(axis=1)
    certain = (place.of("how") != REFINED).all(axis=0).ravel()
    middles = np.array([at[combination == kind].mean(axis=0) for kind in combination])
    off_middle = np.linalg.norm(at - middles, axis=1)
    chosen: list[int] = []

    def values() -> NDArray[np.float64]:
        """Return how much each point adds: its distance from those of the same labels."""
        value = 4.0 - off_middle  # where there is none, more, and most in the middle
        for one in chosen:
            alike = combination == combination[one]
            value[alike] = np.minimum(value[alike], np.linalg.norm(at[alike] - at[one], axis=1))
        value[silent] *= silent[chosen].sum() < MOST_SILENT
        return np.asarray(np.where(certain, value, 0.5 * value))

    loudest = [
        (levels[own, design].max(), int(own[levels[own, design].argmax()]))
        for design in range(labels.shape[1])
        for name in NAMED
        if (own := np.flatnonzero(labels[:, design] == name)).size
    ]
    for _, one in sorted(loudest, reverse=True):
        if len(chosen) < most and values()[one] > _NEAR:
            chosen.append(one)
    while len(chosen) < most and (value := values()).max() > _NEAR:
        chosen.append(int(value.argmax()))
    rows, columns = np.unravel_index(np.array(chosen, int), label.shape[1:])
    return sorted(zip(rows.tolist(), columns.tolist(), strict=True), key=lambda one: one[::-1])


@dataclass(frozen=True)
class Compared:
    """Content of a comparison.

    Parameters
    ----------
    names : tuple of str
        Names of the designs.
    places : tuple of (str, tuple of ConditionMap)
        Title of each place, and its maps, one per design.
    pair : tuple of int
        Indices of the designs compared at first.
    """

    names: tuple[str, ...]
    places: tuple[tuple[str, tuple[ConditionMap, ...]], ...]
    pair: tuple[int, int]


def compare_designs(
    screening: Screening,
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
    screening : Screening
    rigs : sequence of (Rig or str)
        Rig of each of its maps, or the reason why it has no sound.
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
    places = places_of(screening)
    names = list(dict.fromkeys(one.design for one in screening.maps))
    rig_of = {id(one): rig for one, rig in zip(screening.maps, rigs, strict=True)}
    n_audible = sum(isinstance(rig_of[id(one)], Rig) for one in places[0].maps)
    share, more = divmod(number // max(1, n_audible), len(places))
    chosen = [
        chosen_points(one, min(share + (i < more), _MOST_SOUNDS)) for i, one in enumerate(places)
    ]
    jobs = [
        (place, design, rig, at)
        for place, points in zip(places, chosen, strict=True)
        for at in points
        for design in place.maps
        if isinstance(rig := rig_of[id(design)], Rig)
    ]
    with one_thread():
        work = Parallel(n_jobs=workers, prefer="threads", return_as="generator")
        entries: Iterable[Entry | str] = ()
        if jobs:  # a generator that is not used warns
            done = work(delayed(_sound)(*job, seed) for job in jobs)
            entries = track(done, "simulating sounds", unit="sound", total=len(jobs))
        sounds: dict[str, Entry] = {}
        keys: dict[tuple[int, int, tuple[int, int]], str] = {}
        silent = {of: rig for of, rig in rig_of.items() if isinstance(rig, str)}
        for (place, design, _, at), entry in zip(jobs, entries, strict=True):
            if isinstance(entry, str):
                silent.setdefault(id(design), entry)
                continue
            keys[id(place), id(design), at] = key = f"m{len(sounds) + 1}"
            sounds[key] = entry
    laid = []
    for place, points in zip(places, chosen, strict=True):
        audible_points = [
            (at, [keys.get((id(place), id(one), at), "") for one in place.maps]) for at in points
        ]
        maps = [
            _map(place, i, names, audible_points, silent.get(id(one), ""))
            for i, one in enumerate(place.maps)
        ]
        laid.append((place.title, tuple(maps)))
    first, second = pair or (names[0], names[min(1, len(names) - 1)])
    return Compared(tuple(names), tuple(laid), (names.index(first), names.index(second))), sounds


def _sound(
    place: Place, design: DesignMap, rig: Rig, at: tuple[int, int], seed: int
) -> Entry | str:
    """Simulate the sound of a point; return the reason if that is impossible."""
    grid, (row, column) = design.grid, at
    speed, frequency = grid.speed[column], grid.frequency[column] if grid.frequency else None
    try:
        run = simulate(
            rig,
            speed if frequency is None else swing(speed, frequency),
            interference=grid.interference[row],
            seconds=SECONDS,
            acquisition=Acquisition(rate=RATE),
            rng=np.random.default_rng(seed),
            support_stiffness=grid.support_stiffness[place.support],
            temperature=grid.temperature[place.temperature],
        )
    except BushingNoiseError as error:
        return str(error)
    where = place.temperature, place.support, row, column
    label, level = str(design.label[where]), float(design.level[where])
    note = f"simulated, {a_weighted_level(run.recording['pressure'], RATE):.0f} dB(A)"
    if label == PERSISTS:
        note += " from rest; a vibration that runs already goes on"
    if design.how[where] == REFINED:
        known = f", {level:.0f} dB(A)" if math.isfinite(level) else ""
        note += f"; the screen interpolates {label}{known}"
    return Entry(
        title=f"{design.design}: {speed:.3g} rad/s, {1e3 * grid.interference[row]:.3g} mm, "
        f"{place.title}",
        rows=({"label": "none" if label == PERSISTS else label},),
        condition=replace(run.recording.condition, material=design.design),
        duration=SECONDS,
        sound=audible(run.recording).astype(np.float32),
        note=note,
    )


def _map(
    place: Place,
    own: int,
    names: Sequence[str],
    points: Sequence[tuple[tuple[int, int], list[str]]],
    silent: str,
) -> ConditionMap:
    """Lay out the map of a design with its spots and a note."""
    design, grid = place.maps[own], place.maps[own].grid
    label, level, regime = (
        getattr(design, name)[place.temperature, place.support]
        for name in ("label", "level", "regime")
    )
    height = min(MAP_SIZE[1], _LEAST_HEIGHT + _ROW_HEIGHT * len(grid.interference))
    across = axis_of(grid.speed)
    up = axis_of([round(1e3 * fit, 9) for fit in grid.interference], named_over=height)
    spots = []
    for at, keys in points:
        if not keys[own]:
            continue
        speed, fit = grid.speed[at[1]], 1e3 * grid.interference[at[0]]
        words = [f"{speed:.3g} rad/s, {fit:.3g} mm: {label[at]}"]
        words += [str(regime[at]).replace("_", " ")] * bool(regime[at])
        words += [f"{level[at]:.0f} dB(A)"] * math.isfinite(level[at])
        mates = dict(zip((one.design for one in place.maps), keys, strict=True))
        spots.append(
            Spot(
                round(across.share(speed), 4), round(up.share(fit), 4), str(label[at]),
                ", ".join(words), keys[own], tuple(mates.get(name, "") for name in names),
            )
        )  # fmt: skip
    return ConditionMap(
        design.design, across, up, areas_of(label, across, up, height), tuple(spots),
        f"No sounds: {silent}." if silent else "",
        "Largest speed" if grid.frequency else "Speed", height, names.index(design.design),
    )  # fmt: skip
