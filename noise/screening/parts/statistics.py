"""Risk number and robustness of a mapped design.

The risk number costs a hundred short runs and is told of every design. What tolerances do costs
several times that, and is told where a design states some, or where it is asked for. Both are of
the design as it was mapped: in its environment, over the conditions of the map. What fails is told
by name, and costs no other design its result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError
from models.show import short_repr
from noise.screening.design.design import Design, Use
from noise.screening.design.environments import environment, in_environment
from noise.screening.map.grid import DEFAULT_SPEEDS
from noise.screening.parts.robustness import Robustness, robustness
from noise.screening.parts.variation import nominal_values
from noise.screening.ranking.use_risk import use_risk

if TYPE_CHECKING:
    from noise.screening.map.mapping import DesignMap


@short_repr
@dataclass(frozen=True, eq=False)
class Statistics:
    """What a screen tells of a design in one environment beyond its map.

    Parameters
    ----------
    design, environment : str
    risk : int, optional
        From 1 to 10; None where it failed, or the shaft turns and the contact never slips.
    robustness : Robustness, optional
        None where it was not asked for, or failed.
    nominal : mapping of str to float
        Values that the robustness's factors are factors on, in the units of
        `noise.screening.design.tolerances.PARAMETERS`; empty without one.
    failed : tuple of str
        What could not be told, and why.
    """

    design: str
    environment: str
    risk: int | None = None
    robustness: Robustness | None = None
    nominal: Mapping[str, float] = field(default_factory=dict)
    failed: tuple[str, ...] = ()


def as_mapped(design: Design, mapped: DesignMap) -> Design:
    """Return the design in the environment and over the conditions of a map.

    Of a swinging shaft the speeds are those it passes through, taken as constant ones.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> as_mapped(load_design("PDMS"), found.maps[0]).use.support_stiffness
    (2214.0,)
    """
    grid = mapped.grid
    slowest, fastest = grid.use
    return replace(
        design,
        rig=in_environment(design.rig, environment(mapped.environment)),
        use=Use(
            speed=(slowest or min(DEFAULT_SPEEDS[0], 0.5 * fastest), fastest),
            interference=grid.interference,
            support_stiffness=grid.support_stiffness,
            temperature=grid.temperature,
        ),
    )


def statistics_of(
    design: Design,
    mapped: DesignMap,
    rng: np.random.Generator,
    *,
    tolerances: bool | None = None,
    slips: bool = True,
    workers: int = -1,
    progress: Callable[[str], None] = lambda _: None,
) -> Statistics:
    """Tell risk and, by its tolerances, robustness of a mapped design.

    Parameters
    ----------
    design : Design
        As it was read.
    mapped : DesignMap
    rng : numpy.random.Generator
        Of the parts.
    tolerances : bool, optional
        Whether to tell robustness; by default where the design states tolerances.
    slips : bool
        Whether the contact ever does; where it does not, there is nothing to tell but that a swing
        is harmless.
    workers : int
        Threads; -1 is one a core.
    progress : callable
        Is told what is being done.

    Returns
    -------
    Statistics
        With what failed, if something did.
    """
    wanted = bool(design.tolerances) if tolerances is None else tolerances
    used = as_mapped(design, mapped)
    found = Statistics(design.name, mapped.environment)
    if not slips:
        return replace(found, risk=_LEAST_RISK if mapped.grid.frequency else None)
    try:
        progress(f"grading {design.name}, {mapped.environment}")
        found = replace(found, risk=use_risk(used, workers=workers))
    except _FAILURES as error:
        found = replace(found, failed=(f"risk: {error}",))
    if not wanted:
        return found
    try:
        progress(f"parts of {design.name}, {mapped.environment}")
        stands = robustness(used, rng, risk=found.risk, workers=workers)
        nominal = nominal_values(used, stands.point)
    except _FAILURES as error:
        return replace(found, failed=(*found.failed, f"tolerances: {error}"))
    return replace(found, robustness=stands, nominal=nominal)


_LEAST_RISK = 1

_FAILURES = (BushingNoiseError, ArithmeticError, ValueError)
"""Singular matrices are among these; anything else is a defect of the program."""
