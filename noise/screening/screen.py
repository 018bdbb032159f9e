"""Screening of bushing designs: maps of their noise, margins, risk numbers and a ranking.

Each design is mapped in each environment, at constant speed and, where it says so or the caller
does, swinging to and fro; then graded, and its parts are looked at. A design that cannot be
simulated is refused by name, and what else fails is told; the others go on.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from noise.screening.design.design import Design, Swinging, Use, load_design
from noise.screening.design.environments import DRY, environment, in_environment
from noise.screening.map.batches import batch_evaluator
from noise.screening.map.grid import grid_of
from noise.screening.map.mapping import map_design
from noise.screening.outcome import Screening
from noise.screening.parts.statistics import statistics_of
from noise.screening.ranking.margins import critical_points
from noise.screening.ranking.never_slips import why_never_slipping
from noise.screening.ranking.ranking import standings
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from models.rig import Rig
    from noise.screening.map.batches import Evaluator
    from noise.screening.map.mapping import DesignMap

__all__ = ["DEFAULT_SIMULATIONS", "screen"]

DEFAULT_SIMULATIONS = 500
"""Of a map, more or less: what two cores do of the calibrated fluorocarbon in eight seconds."""


def screen(
    designs: Sequence[str | Path | Design],
    given: Use | None = None,
    *,
    environments: Sequence[str] = (DRY,),
    loudness: bool = False,
    tolerances: bool | None = None,
    rng: np.random.Generator | None = None,
    change: Callable[[Rig], Rig] | None = None,
    simulations: int | None = DEFAULT_SIMULATIONS,
    workers: int = -1,
    scheduler: str | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Screening:
    """Map bushing designs over their conditions, and rank them.

    Parameters
    ----------
    designs : sequence of str, Path or Design
        Design files, names of materials, or designs.
    given : Use, optional
        Conditions of the maps, in place of the designs' own; with speeds alone, or with a swing
        alone, only that is mapped.
    environments : sequence of str
        Of `noise.screening.design.environments`.
    loudness : bool
        Whether to tell loudness as well; needs the extra ``sound-quality``.
    tolerances : bool, optional
        Whether to tell what tolerances do, of all designs, with assumed ones where they state none;
        by default only of those that state some. Takes several seconds a design.
    rng : numpy.random.Generator, optional
        Of the parts within tolerances; by default of seed 0.
    change : callable, optional
        Makes another rig of that of each design, such as ``lambda rig: rig.changed(damping="x2")``.
    simulations : int, optional
        Of a map, more or less; None follows every boundary to the end.
    workers : int
        Threads; -1 is one a core.
    scheduler : str, optional
        Address of a Dask cluster that simulates the maps instead.
    progress : callable
        Is told what is being done.

    Returns
    -------
    Screening

    Raises
    ------
    ParameterError
        An environment is unknown, an extra is missing, there are no designs, or all are refused.

    Examples
    --------
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0, 9.0), support_stiffness=(2214.0,)))
    >>> found.standings[0].shares["none"], found.critical[0].margin_v_crit2
    (1.0, inf)
    >>> found.standings[0].risk
    1
    """
    started = time.perf_counter()
    if not designs:
        raise ParameterError("there is no design to screen")
    in_environments = [environment(name) for name in dict.fromkeys(environments)]
    if loudness:
        from features.sound_quality import check_available

        check_available()
    maps: list[DesignMap] = []
    refused: list[tuple[str, str]] = []
    screened: dict[str, Design] = {}
    files: list[tuple[str, Path]] = []
    with batch_evaluator(workers=workers, scheduler=scheduler) as evaluate:
        for one in designs:
            called = one.name if isinstance(one, Design) else str(one)
            try:
                design = one if isinstance(one, Design) else load_design(one)
                if change is not None:
                    design = replace(design, rig=change(design.rig))
                design = _with_name_of_its_own(design, set(screened))
                found: list[DesignMap] = []
                for text in _remarks(design, given):
                    progress(f"{design.name}: {text}")
                for where in in_environments:
                    progress(f"mapping {design.name}, {where.name}")
                    found += [
                        _mapped(
                            design, given, where.name, swinging, evaluate, simulations, loudness
                        )
                        for swinging in _motions(design, given)
                    ]
            except BushingNoiseError as error:
                refused.append((called, str(error)))
                continue
            screened[design.name] = design
            maps += found
            if change is None and not isinstance(one, Design) and Path(one).is_file():
                files.append((design.name, Path(one)))
    if not maps:
        raise ParameterError(refused[0][1])
    mapped = time.perf_counter()
    critical = tuple(point for found in maps for point in critical_points(found))
    first: dict[tuple[str, str], DesignMap] = {}
    for each in maps:
        first.setdefault((each.design, each.environment), each)
    streams = (rng or np.random.default_rng(0)).spawn(len(first))
    statistics = tuple(
        statistics_of(
            screened[each.design],
            each,
            stream,
            tolerances=tolerances,
            workers=workers,
            progress=progress,
        )
        for each, stream in zip(first.values(), streams, strict=True)
    )
    never_slipping = [
        why_never_slipping(
            in_environment(screened[each.design].rig, environment(each.environment)), each.grid
        )
        for each in maps
    ]
    return Screening(
        designs=tuple(screened.values()),
        maps=tuple(maps),
        critical=critical,
        statistics=statistics,
        standings=standings(maps, critical, statistics, never_slipping),
        refused=tuple(refused),
        files=tuple(files),
        seconds=mapped - started,
        statistics_seconds=time.perf_counter() - mapped,
    )


def _with_name_of_its_own(design: Design, taken: set[str]) -> Design:
    """Two designs of one name are told apart by a number."""
    name, number = design.name, 2
    while name in taken:
        name, number = f"{design.name} ({number})", number + 1
    return replace(design, name=name)


def _remarks(design: Design, given: Use | None) -> list[str]:
    """Say where a map reaches beyond what the design's properties are given for, and the like."""
    grid = grid_of(design, given)
    asked, found = grid.interference, []
    low, high = (1e3 * limit for limit in design.rig.interference_range)
    if 1e3 * asked[0] < low * (1.0 - 1e-9) or 1e3 * asked[-1] > high * (1.0 + 1e-9):
        fits = f"{low:g} mm" if low == high else f"{low:g} to {high:g} mm"
        found.append(f"fits are given for {fits} alone; beyond, those of the nearest are used")
    found += use_remarks(
        design.rig,
        speed=grid.use,
        interference=asked,
        support_stiffness=grid.support_stiffness,
        temperature=grid.temperature,
    )
    if (given is not None and given.temperature) or len(grid.temperature) > 1:
        found.append(temperature_remark(design.rig, grid.temperature[-1]))
    return [text for text in (*found, *effect_remarks(design.rig, EFFECTS)) if text]


def _motions(design: Design, given: Use | None) -> list[Swinging | None]:
    """How the shaft moves: None is constant speed."""
    if given is not None and given.swinging is not None:
        return [None, given.swinging] if given.speed else [given.swinging]
    if design.use.swinging is not None and not (given is not None and given.speed):
        return [None, design.use.swinging]
    return [None]


def _mapped(
    design: Design,
    given: Use | None,
    where: str,
    swinging: Swinging | None,
    evaluate: Evaluator,
    simulations: int | None,
    loudness: bool,
) -> DesignMap:
    rig = in_environment(design.rig, environment(where))
    grid = grid_of(design, given, where=where, swinging=swinging)
    found = map_design(rig, grid, evaluate, design=design.name, environment=where, most=simulations)
    if loudness:
        from noise.screening.map.loudness import with_loudness

        found = with_loudness(found, rig)
    return found
