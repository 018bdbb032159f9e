"""First hint of what would make a design quieter, told from its map and from stability.

A map says with which support and at which interference the use is quietest; stability, a
hundredth of a second for a whole use, which change of the bushing by a fifth steadies most of it.
Neither simulates the changed design: what a hint brings is told by screening it, and the smallest
change that is enough by the advice of its tolerances (`noise.screening.parts.advice`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.rig import Rig
from noise.screening.design.environments import FIT_PARAMETERS, scaled_fit
from noise.screening.map.grid import Grid
from noise.screening.map.mapping import DesignMap, growth_rates
from noise.screening.ranking.plain_words import fit_words, supports_words
from noise.screening.ranking.use_risk import ends_and_middle

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
