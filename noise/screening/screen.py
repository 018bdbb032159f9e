"""Screening of bushing designs: maps of their noise, margins, risk numbers and a ranking.

Each design is mapped in each environment, at constant speed and, where any of them says so or the
caller does, swinging to and fro, over conditions that all share; then graded, and its parts are
looked at. A design that cannot be simulated is refused by name, and what else fails is told; the
others go on.

Designs whose contact never lets go in use, which are quiet for no good reason.

A shaft that turns on winds the bushing up until the contact slips. Where it would have to wind it
up further than rubber bears, or longer than a run of the map lasts at the fastest speed of use,
with every fit and support, nothing is known of the design's noise, and it gets no rank; most often
a torque or a stiffness is in another unit. A shaft that swings may well never make the contact
slip, which is a result.

First hint of what would make a design quieter, told from its map and from stability.

A map says with which support and at which interference the use is quietest; stability, a
hundredth of a second for a whole use, which change of the bushing by a fifth steadies most of it.
Neither simulates the changed design: what a hint brings is told by screening it, and the smallest
change that is enough by the advice of its tolerances (`noise.screening.parts.advice`).
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig, effective_stiffness
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from noise.batch import Journal
from noise.screening.design.design import Design, Swinging, Use
from noise.screening.design.environments import (
    DRY,
    FIT_PARAMETERS,
    environment,
    in_environment,
    scaled_fit,
)
from noise.screening.design.loading import load_designs
from noise.screening.map.batches import Evaluator, batch_evaluator, keeping
from noise.screening.map.grid import Grid, shared_grid, shared_motions
from noise.screening.map.mapping import DesignMap, growth_rates, map_design
from noise.screening.map.point import LONGEST_POINT
from noise.screening.map.provenance import fits_remark
from noise.screening.outcome import Screening
from noise.screening.parts.statistics import statistics_of
from noise.screening.ranking.margins import critical_points
from noise.screening.ranking.plain_words import fit_words, supports_words
from noise.screening.ranking.ranking import standings
from noise.screening.ranking.use_risk import ends_and_middle
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import never_slips
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.screening.map.grid import Grid

_CHANGE = 0.2
"""Of a parameter of the bushing, as a share of its value."""

_NO_TORQUE = 1e-12
"""[N m]"""

_SPEEDS = 17
"""Of the use, at which stability is asked, at the ends and the middle of the other axes."""

_BETTER = 0.8
"""Share of what is noisy, or unsteady, that must be left at most for a hint."""


def first_hint(rig: Rig, found: DesignMap) -> str:
    """Say what would make a design quieter; empty where it is quiet or nothing is known to.

    Parameters
    ----------
    rig : Rig
        In the environment of the map.
    found : DesignMap

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(1.0, 5.0, 9.0), support_stiffness=(2214.0,))
    >>> screen(["PDMS"], use).standings[0].hint
    ''
    >>> screen(["fluorocarbon-thesis"], use).standings[0].hint
    'quietest at 0.178 mm: 33% of the use is noisy, not 44%'
    """
    noisy = found.label[..., found.grid.used] != "none"
    if not noisy.any():
        return ""
    return "; ".join(filter(None, (_by_stability(rig, found.grid), _by_map(noisy, found))))


def _by_stability(rig: Rig, grid: Grid) -> str:
    """Name the change that steadies most, of laws that stability tells of, with the shaft turning.

    A constant torque slides stably at any speed, however it sticks and slips.
    """
    if grid.frequency:
        return ""
    now = _unsteady(rig, grid)
    if now == 0.0:
        return ""
    tried = [
        (_unsteady(changed, grid), name, change)
        for name in FIT_PARAMETERS
        for aimed in (-_CHANGE, _CHANGE)
        for changed, change in [_changed(rig, name, 1.0 + aimed)]
        if change
    ]
    share, name, change = min(tried)
    if share > _BETTER * now:
        return ""
    return f"{name} {change:+.0%}: by stability {share:.0%} of the use is unsteady, not {now:.0%}"


def _unsteady(rig: Rig, grid: Grid) -> float:
    """Share of the use at which steady sliding cannot last [-]."""
    axes = tuple(
        np.array(ends_and_middle(axis))
        for axis in (grid.temperature, grid.support_stiffness, grid.interference)
    )
    return float(np.mean(growth_rates(rig, axes, np.linspace(*grid.use, _SPEEDS)) > 0.0))


def _changed(rig: Rig, name: str, factor: float) -> tuple[Rig, float]:
    """Change a parameter of all fits, no further than until both torques are one.

    The change is told as a share of the value [-].
    """
    ratio = min(fit.critical_torque / max(fit.kinetic_torque, _NO_TORQUE) for fit in rig.fits)
    factor = {
        "critical_torque": max(factor, 1.0 / ratio),
        "kinetic_torque": min(factor, ratio),
    }.get(name, factor)
    changed = replace(rig, fits=tuple(scaled_fit(fit, {name: factor}) for fit in rig.fits))
    return changed, factor - 1.0


def _by_map(noisy: NDArray[np.bool_], found: DesignMap) -> str:
    """Name the support or the interference at which the use is quietest by far."""
    overall = float(noisy.mean())
    tried = list(_shares(noisy, found))
    share, where = min(tried, default=(overall, ""))
    if share > _BETTER * overall:
        return ""
    return f"quietest {where}: {share:.0%} of the use is noisy, not {overall:.0%}"


def _shares(noisy: NDArray[np.bool_], found: DesignMap) -> Iterator[tuple[float, str]]:
    grid, own = found.grid, ~found.substituted
    for i, support in enumerate(grid.support_stiffness):
        yield float(noisy[:, i].mean()), supports_words([support])
    for i, fit in enumerate(grid.interference):
        if own[:, :, i].any():
            yield float(noisy[:, :, i].mean()), fit_words([fit])


_MOST_TWIST = 2.0
"""Of a bushing [rad]: one half as thick as its radius is then sheared by 400 %, and tears."""


def why_never_slipping(rig: Rig, grid: Grid) -> str:
    """Say why the contact slips at no point of a map; empty where it does.

    Parameters
    ----------
    rig : Rig
        In its environment.
    grid : Grid

    Examples
    --------
    >>> from noise.screening.design.design import Use, load_design
    >>> from noise.screening.map.grid import grid_of
    >>> design = load_design("fluorocarbon-thesis")
    >>> grid = grid_of(design, Use(speed=(5.0,), interference=(0.279e-3,)))
    >>> why_never_slipping(design.rig, grid)
    ''
    >>> in_nmm = design.rig.changed(critical_torque="x1000", kinetic_torque="x1000")
    >>> why_never_slipping(in_nmm, grid)
    'never slips: the contact holds 10700 Nm, for which the shaft winds the bushing up by 16.1 rad'
    """
    twist, torque, interference, support = min(
        (fit.critical_torque / effective_stiffness(fit, support), fit.critical_torque, at, support)
        for at, support in itertools.product(grid.interference, grid.support_stiffness)
        for fit in (rig.fit(at),)
    )
    swing = bool(grid.frequency)
    fastest = grid.use[1]
    way = fastest / (2.0 * math.pi * min(grid.frequency)) if swing else fastest * LONGEST_POINT
    if twist <= (way if swing else min(way, _MOST_TWIST)):
        return ""
    if not swing and twist <= _MOST_TWIST:
        motion = motion_from_rest(rig, fastest, interference, support, seconds=LONGEST_POINT)
        if not never_slips(motion):
            return ""
    return (
        f"never slips: the contact holds {torque:g} Nm, for which the shaft winds the bushing up "
        f"by {twist:.3g} rad"
    )


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
