"""Screening of bushing designs: maps of their noise, margins, risk numbers and a ranking.

Each design is mapped in each environment, at constant speed and, where any of them says so or the
caller does, swinging to and fro, over conditions that all share; then graded, and its parts are
looked at. A design that cannot be simulated is refused by name, and what else fails is told; the
others go on.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from noise.batch import Journal
from noise.screening.design.design import Design, Swinging, Use
from noise.screening.design.environments import DRY, environment, in_environment
from noise.screening.design.loading import load_designs
from noise.screening.map.batches import Evaluator, batch_evaluator, keeping
from noise.screening.map.grid import Grid, shared_grid, shared_motions
from noise.screening.map.mapping import DesignMap, map_design
from noise.screening.map.provenance import fits_remark
from noise.screening.outcome import Screening
from noise.screening.parts.statistics import statistics_of
from noise.screening.ranking.first_hint import first_hint
from noise.screening.ranking.margins import critical_points
from noise.screening.ranking.never_slips import why_never_slipping
from noise.screening.ranking.ranking import standings
from sim.effects import EFFECTS

DEFAULT_SIMULATIONS = 500
"""Of a map, more or less: what two cores do of the calibrated fluorocarbon in eight seconds."""

_ONE_SWING = 2
"""Motions up to which no swing needs a name: constant speed and one swing."""


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
    kept: Journal | None = None,
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
    kept : Journal, optional
        Where to keep what is simulated of the maps, and what of it is there already.

    Returns
    -------
    Screening

    Raises
    ------
    ParameterError
        An environment is unknown, an extra is missing, there are no designs, or all are refused.

    Examples
    --------
    >>> from noise.screening.design.design import Use
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
    loaded, refused, files = load_designs(designs, change)
    motions = shared_motions(list(loaded.values()), given)
    grids = {
        (name, swinging): shared_grid(list(loaded.values()), given, where=name, swinging=swinging)
        for name in dict.fromkeys(where.name for where in in_environments)
        for swinging in motions
    }
    maps: list[DesignMap] = []
    screened: dict[str, Design] = {}
    remarks: dict[tuple[str, str], list[str]] = {}
    with batch_evaluator(workers=workers, scheduler=scheduler) as evaluate:
        if kept is not None:
            evaluate = keeping(evaluate, kept)
        for design in loaded.values():
            try:
                told = {
                    (design.name, where): _remarks(design, where, grids, given)
                    for where in dict.fromkeys(where for where, _ in grids)
                }
                for text in dict.fromkeys(text for texts in told.values() for text in texts):
                    progress(f"{design.name}: {text}")
                remarks |= told
                found: list[DesignMap] = []
                for (where, swinging), grid in grids.items():
                    progress(f"mapping {design.name}, {where}")
                    one = _mapped(design, where, grid, evaluate, simulations, loudness)
                    if swinging is not None and len(motions) > _ONE_SWING:
                        degrees = math.degrees(swinging.amplitude)
                        one = replace(one, motion=f"swinging by {degrees:.4g} degrees")
                    found.append(one)
            except BushingNoiseError as error:
                refused.append((design.name, str(error)))
                continue
            screened[design.name] = design
            maps += found
    if not maps:
        raise ParameterError(refused[0][1])
    mapped = time.perf_counter()
    critical = tuple(point for found in maps for point in critical_points(found))
    rigs = [in_environment(screened[one.design].rig, environment(one.environment)) for one in maps]
    never_slipping = [
        why_never_slipping(rig, each.grid) for rig, each in zip(rigs, maps, strict=True)
    ]
    first: dict[tuple[str, str], tuple[DesignMap, str]] = {}
    for each, why in zip(maps, never_slipping, strict=True):
        first.setdefault((each.design, each.environment), (each, why))
    streams = (rng or np.random.default_rng(0)).spawn(len(first))
    statistics = tuple(
        statistics_of(
            screened[each.design],
            each,
            stream,
            tolerances=tolerances,
            slips=not why,
            workers=workers,
            progress=progress,
        )
        for (each, why), stream in zip(first.values(), streams, strict=True)
    )
    hints = [first_hint(rig, each) for rig, each in zip(rigs, maps, strict=True)]
    return Screening(
        designs=tuple(screened.values()),
        maps=tuple(maps),
        critical=critical,
        statistics=statistics,
        standings=standings(maps, critical, statistics, never_slipping, hints, remarks),
        refused=tuple(refused),
        files=tuple(one for one in files if one[0] in screened),
        seconds=mapped - started,
        statistics_seconds=time.perf_counter() - mapped,
    )


def _remarks(
    design: Design,
    where: str,
    grids: Mapping[tuple[str, Swinging | None], Grid],
    given: Use | None,
) -> list[str]:
    """Say what to know of a design's numbers in an environment, most of all those not its own."""
    here = [grid for (name, _), grid in grids.items() if name == where]
    rig, grid = design.rig, here[0]
    temperature = sorted({value for each in here for value in each.temperature})
    found = use_remarks(
        rig,
        speed=[max(each.use[1] for each in here)],
        interference=grid.interference,
        support_stiffness=grid.support_stiffness,
        temperature=temperature,
    )
    found.append(fits_remark(rig, grid.interference))
    if rig.temperature or (given is not None and given.temperature) or len(temperature) > 1:
        found.append(temperature_remark(rig, *temperature))
    found += effect_remarks(in_environment(rig, environment(where)), EFFECTS)
    return list(dict.fromkeys(filter(None, found)))


def _mapped(
    design: Design,
    where: str,
    grid: Grid,
    evaluate: Evaluator,
    simulations: int | None,
    loudness: bool,
) -> DesignMap:
    rig = in_environment(design.rig, environment(where))
    found = map_design(rig, grid, evaluate, design=design.name, environment=where, most=simulations)
    if loudness:
        from noise.screening.map.loudness import with_loudness

        found = with_loudness(found, rig)
    return found
