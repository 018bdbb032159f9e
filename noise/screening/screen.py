"""Screening of bushing designs: maps of their noise, margins, a ranking and advice.

Each design is mapped in each environment, at constant speed and, where any of them says so or the
caller does, swinging to and fro, over conditions that all share. Then the designs are ranked, the
changes that end the loudest noise of each are sought and verified, and its parts are looked at. A
design that cannot be simulated is refused by name, and other failures are reported; the others go
on.

A shaft that turns on winds the bushing up until the contact slips. Where it would have to wind it
up further than rubber bears, or longer than a few seconds at the fastest speed of use, with every
fit and support, nothing is known of the design's noise, and it is refused; most often a torque or a
stiffness is in another unit. A shaft that swings may well never make the contact slip, which is a
result.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig, effective_stiffness
from models.show import short_repr
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from noise.batch.journal import Journal
from noise.screening.advice import advise
from noise.screening.design import Design, Use, load_designs
from noise.screening.environments import DRY, environment, in_environment
from noise.screening.grid import Grid, shared_grid, shared_motions
from noise.screening.mapping import SIMULATED, DesignMap, map_design
from noise.screening.parts import noisy_parts
from noise.screening.point import batch_evaluator, keeping
from noise.screening.standing import Standing, condition_at, ranked, standing_of
from noise.screening.vibration import Condition
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

DEFAULT_SIMULATIONS = 500
"""Of a map, more or less."""

_STATISTICS = 150
"""Points of a map that take as long as its advice and tolerances."""

_ONE_SWING = 2
"""Motions up to which no swing needs a name: constant speed and one swing."""

_LONGEST_WINDING = 2.0
"""[s]"""

_ELSEWHERE = 6
"""Number of other noisy conditions at which advice is simulated."""

_FAILURES = (BushingNoiseError, ArithmeticError, ValueError)
"""Singular matrices are among these; anything else is a defect of the program."""


@short_repr
@dataclass(frozen=True)
class Screening:
    """Results of a screening.

    Parameters
    ----------
    designs : tuple of Design
        Those that were screened, as they were: named, and changed where a change was given.
    maps : tuple of DesignMap
        One for each design, environment and motion; all designs have the same grids.
    standings : tuple of Standing
        The designs ranked, the quietest first; one for each map.
    refused : tuple of (str, str)
        Designs that could not be screened, or not in all, and why.
    seconds : float
        How long it took [s].

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> found.refused, found.standings[0].shares["none"]
    ((), 1.0)
    """

    designs: tuple[Design, ...]
    maps: tuple[DesignMap, ...]
    standings: tuple[Standing, ...]
    refused: tuple[tuple[str, str], ...]
    seconds: float

    def plot(
        self,
        ax: Axes | None = None,
        *,
        number: int = 0,
        support: int = 0,
        temperature: int = 0,
    ) -> Axes:
        """Plot the noises of a design over speed and interference, with one support.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.
        number : int
            Of the map among `maps`, from 0.
        support, temperature : int
            Which of the map's, from 0.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from noise.screening.design import Use
        >>> from noise.screening.screen import screen
        >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
        >>> found.plot(Figure().subplots()).get_ylabel()
        'Interference [mm]'
        """
        from noise.pictures.maps import plot_map

        return plot_map(self.maps[number], ax, support=support, temperature=temperature)

    def to_pandas(self, table: str = "designs") -> DataFrame:
        """Return one of the tables that ``bushing-noise screen --out`` writes, as a data frame.

        Parameters
        ----------
        table : str
            ``designs``, ``map``, ``critical_speeds``; ``advice`` where something is noisy.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        ParameterError
            There is no such table, or pandas is not installed.
        """
        from models.show import data_frame
        from noise.screening.tables import screening_tables

        tables = screening_tables(self)
        if f"{table}.csv" not in tables:
            there = ", ".join(name.removesuffix(".csv") for name in tables)
            raise ParameterError(f"there is no table {table!r}; there are {there}")
        return data_frame(*tables[f"{table}.csv"])


def screen(
    designs: Sequence[str | Path | Design],
    given: Use | None = None,
    *,
    environments: Sequence[str] = (DRY,),
    tolerances: bool = True,
    rng: np.random.Generator | None = None,
    change: Callable[[Rig], Rig] | None = None,
    simulations: int = DEFAULT_SIMULATIONS,
    workers: int = -1,
    progress: Callable[[str], None] = lambda _: None,
    advance: Callable[[float], None] = lambda _: None,
    journal: Journal | None = None,
) -> Screening:
    """Map bushing designs over their conditions, rank them, and find changes that end their noise.

    Parameters
    ----------
    designs : sequence of str, Path or Design
        Design files, names of materials, or designs.
    given : Use, optional
        Conditions of the maps, in place of the designs' own; with speeds alone, or with a swing
        alone, only that is mapped.
    environments : sequence of str
        Of `noise.screening.environments`.
    tolerances : bool
        Whether to look at the parts of designs that state tolerances, which takes several seconds
        per design.
    rng : numpy.random.Generator, optional
        Of the parts within tolerances; by default of seed 0.
    change : callable, optional
        Makes another rig of that of each design, such as ``lambda rig: rig.changed(damping="x2")``.
    simulations : int
        Of a map, more or less.
    workers : int
        Threads; -1 is one a core.
    progress : callable
        Is called with the name of each piece of work.
    advance : callable
        Is called with the share of all work that is done, about as it takes time [-].
    journal : Journal, optional
        Results of simulations of the maps, which are read from it and added to it.

    Returns
    -------
    Screening

    Raises
    ------
    ParameterError
        An environment is unknown, an extra is missing, there are no designs, or all are refused.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0, 9.0), support_stiffness=(2214.0,)))
    >>> found.standings[0].shares["none"], found.standings[0].worst("margin_v_crit2")
    (1.0, inf)
    """
    started = time.perf_counter()
    if not designs:
        raise ParameterError("there is no design to screen")
    names = list(dict.fromkeys(environment(name).name for name in environments))
    loaded, refused = load_designs(designs, change)
    motions = shared_motions(list(loaded.values()), given)
    grids = {
        where: {
            swinging: shared_grid(list(loaded.values()), given, where=where, swinging=swinging)
            for swinging in motions
        }
        for where in names
    }
    n_maps = len(loaded) * len(names) * len(motions)
    total, done = n_maps * (simulations + _STATISTICS), 0

    def work_on(points: int) -> None:
        nonlocal done
        done += points
        advance(min(1.0, done / total))

    maps: list[DesignMap] = []
    notes: dict[tuple[str, str], list[str]] = {}
    evaluate = batch_evaluator(workers=workers, advance=work_on)
    if journal is not None:
        evaluate = keeping(evaluate, journal)
    for name, design in loaded.items():
        try:
            own = {
                (name, where): _remarks(design, where, [*grids[where].values()], given)
                for where in names
            }
            for text in dict.fromkeys(itertools.chain(*own.values())):
                progress(f"{name}: {text}")
            of_design: list[DesignMap] = []
            for where, swinging in itertools.product(names, motions):
                progress(f"mapping {name}, {where}")
                rig, grid = in_environment(design.rig, environment(where)), grids[where][swinging]
                refuse_never_slipping(rig, grid)
                one = map_design(
                    rig, grid, evaluate, design=name, environment=where, most=simulations
                )
                if swinging is not None and len(motions) > _ONE_SWING:
                    degrees = math.degrees(swinging.amplitude)
                    one = replace(one, motion=f"swinging by {degrees:.4g} degrees")
                of_design.append(one)
                work_on((len(maps) + len(of_design)) * simulations - done)  # whatever it took
        except BushingNoiseError as error:
            refused.append((name, str(error)))
        else:
            maps, notes = maps + of_design, notes | own
    if not maps:
        raise ParameterError(refused[0][1])
    standings: list[Standing] = []
    rng = rng or np.random.default_rng(0)
    for one, stream in zip(maps, rng.spawn(len(maps)), strict=True):
        design = loaded[one.design]
        design = replace(design, rig=in_environment(design.rig, environment(one.environment)))
        standing = standing_of(one)
        standing = replace(standing, notes=tuple(notes[one.design, one.environment]))
        loudest, steady = standing.loudest, one.motion == "steady"
        try:
            if steady and loudest is not None:
                progress(f"advice for {one.design}, {one.environment}")
                others = _other_noisy(one, loudest)
                offers = advise(design.rig, loudest, others, workers=workers)
                standing = replace(standing, offers=offers)
            if steady and tolerances and design.tolerances:
                progress(f"tolerances of {one.design}, {one.environment}")
                at, use = loudest or _middle(one.grid), one.grid.use
                parts = noisy_parts(design, at, use, stream, workers=workers)
                standing = replace(standing, parts=parts)
        except _FAILURES as error:
            refused.append((f"{one.design}, in part", f"advice or tolerances: {error}"))
        standings.append(standing)
        work_on(_STATISTICS)
    screened = {one.design: loaded[one.design] for one in maps}
    return Screening(
        designs=tuple(screened.values()),
        maps=tuple(maps),
        standings=ranked(standings),
        refused=tuple(refused),
        seconds=time.perf_counter() - started,
    )


def _middle(grid: Grid) -> Condition:
    """Return the condition in the middle of a use."""
    axes = grid.interference, grid.support_stiffness, grid.temperature
    return Condition(0.5 * sum(grid.use), *(axis[(len(axis) - 1) // 2] for axis in axes))


def _other_noisy(mapped: DesignMap, loudest: Condition) -> list[Condition]:
    """Choose some simulated noisy conditions of use from all over the map, the loudest first."""
    sound, how, level = (
        each[..., mapped.grid.used] for each in (mapped.sound, mapped.how, mapped.level)
    )
    noisy = np.argwhere((sound != "none") & (how == SIMULATED)).tolist()
    noisy = [at for at in noisy if condition_at(mapped.grid, at) != loudest]
    if len(noisy) > _ELSEWHERE:
        noisy = [noisy[i] for i in np.linspace(0, len(noisy) - 1, _ELSEWHERE).astype(int)]
    noisy.sort(key=lambda at: -level[tuple(at)])
    return [condition_at(mapped.grid, at) for at in noisy]


_MOST_TWIST = 2.0
"""Of a bushing [rad]: one half as thick as its radius is then sheared by 400 %, and tears."""


def refuse_never_slipping(rig: Rig, grid: Grid) -> None:
    """Refuse a rig of which the contact slips at no point of a map of constant speeds.

    Parameters
    ----------
    rig : Rig
        In its environment.
    grid : Grid

    Raises
    ------
    ParameterError
        The message says which torque holds.

    Examples
    --------
    >>> from noise.screening.design import Use, load_design
    >>> from noise.screening.grid import shared_grid
    >>> design = load_design("fluorocarbon-thesis")
    >>> grid = shared_grid([design], Use(speed=(5.0,), interference=(0.279e-3,)))
    >>> refuse_never_slipping(design.rig, grid)
    >>> in_nmm = design.rig.changed(critical_torque="x1000", kinetic_torque="x1000")
    >>> refuse_never_slipping(in_nmm, grid)
    Traceback (most recent call last):
    models.errors.ParameterError: never slips: the contact holds 10700 Nm, for which the shaft ...
    """
    if grid.frequency:
        return
    fits = [rig.fit(interference) for interference in grid.interference]
    twist, torque = min(
        (fit.critical_torque / effective_stiffness(fit, support), fit.critical_torque)
        for fit, support in itertools.product(fits, grid.support_stiffness)
    )
    if twist <= min(grid.use[1] * _LONGEST_WINDING, _MOST_TWIST):
        return
    raise ParameterError(
        f"never slips: the contact holds {torque:g} Nm, for which the shaft winds the bushing up "
        f"by {twist:.3g} rad; are torque and stiffness in their units?"
    )


def _remarks(design: Design, where: str, here: Sequence[Grid], given: Use | None) -> list[str]:
    """Return remarks on the data of a design over its grids in an environment."""
    rig, fits = design.rig, here[0].interference
    temperature = sorted({value for each in here for value in each.temperature})
    speed = [max(each.use[1] for each in here)]
    remarks = use_remarks(
        rig, speed=speed, interference=fits, support_stiffness=here[0].support_stiffness,
        temperature=temperature,
    )  # fmt: skip
    if rig.temperature or (given is not None and given.temperature) or len(temperature) > 1:
        remarks.append(temperature_remark(rig, *temperature))
    remarks += effect_remarks(in_environment(rig, environment(where)), EFFECTS)
    return list(dict.fromkeys(filter(None, remarks)))
