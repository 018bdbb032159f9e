"""What a point of a map rests on: the design's own data, or their interpolation.

Designs that are compared are mapped at the same conditions, and not each has data for all. None is
left out for that; one rule, `RULE`, says what stands in. Between two fits everything is linear in
the interference. Between two supports the damping is linear in the support's compliance, which is
the measure in which a clamp that is bolted down is not infinitely far from the beams: what the
beams add to c_E falls as they move less, 0.105 to 0.085 Nm s/rad from 2214 to 3745 Nm/rad in Table
5.5, whose 0.236 at 0.381 mm is a beat. Beyond the first and the last of either no source says how
they go on, and those of the nearest are held.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED
from noise.screening.axis_values import axis_words

if TYPE_CHECKING:
    from models.rig import Fit, Rig
    from noise.screening.grid import Grid


RULE = (
    "where a design has no data of its own, stiffness, torques and damping are interpolated "
    "linearly in the interference between two fits, the damping linearly in the support's "
    "compliance between two supports; beyond the first and the last those of the nearest are held"
)
"""What stands in at conditions that a design is not given for."""

_HELD = " held"

_SAME = 0.01
"""Relative distance within which a fit or a support is one that data are given for."""


def point_notes(rig: Rig, grid: Grid) -> NDArray[np.object_]:
    """Say of each point what is not the design's own there.

    Parameters
    ----------
    rig : Rig
    grid : Grid

    Returns
    -------
    ndarray of str, shape of the grid
        What was interpolated, held, or is faster than anything that the rig was fitted to; empty
        where nothing is.

    Examples
    --------
    >>> from noise.screening.design import Use, load_design
    >>> from noise.screening.grid import grid_of
    >>> design = load_design("fluorocarbon")
    >>> use = Use(speed=(5.0,), interference=(0.3e-3,), support_stiffness=(2214.0, 3000.0))
    >>> for note in point_notes(design.rig, grid_of(design, use)).flat:
    ...     print(note)
    interpolated between fits of 0.279 and 0.381 mm
    interpolated between fits of 0.279 and 0.381 mm; damping interpolated between 2214 Nm/rad and...
    """
    of_fit = [_fit_note(rig, fit) for fit in grid.interference]
    of_support = [
        [_support_note(rig, fit, support) for fit in grid.interference]
        for support in grid.support_stiffness
    ]
    fast = f"faster than {rig.fastest_fitted:.4g} rad/s, the fastest that was fitted"
    of_speed = [fast if v > rig.fastest_fitted * (1.0 + 1e-9) else "" for v in grid.speed]
    notes = np.empty(grid.shape, dtype=object)
    for at in np.ndindex(grid.shape):
        _, support, fit, speed = at
        told = (of_fit[fit], of_support[support][fit], of_speed[speed])
        notes[at] = "; ".join(text for text in told if text)
    return notes


def is_substituted(note: str) -> bool:
    """Whether a point's note says that `RULE` stands in for data of the design's own.

    Examples
    --------
    >>> is_substituted("damping of 3745 Nm/rad held"), is_substituted("faster than 13 rad/s, ...")
    (True, False)
    """
    return "interpolated" in note or note.endswith(_HELD) or f"{_HELD};" in note


def rows_of(rig: Rig, interference: Sequence[float]) -> list[int]:
    """Tell by which row of a map each is known: its own, or that whose fit is held there.

    Parameters
    ----------
    rig : Rig
    interference : sequence of float
        Rising [m].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rows_of(load_material_rig("PDMS"), [0.127e-3, 0.178e-3, 0.254e-3, 0.3e-3, 0.5e-3, 0.6e-3])
    [2, 2, 2, 3, 4, 4]
    """
    low, high = rig.interference_range
    below = [i for i, fit in enumerate(interference) if fit <= low]
    above = [i for i, fit in enumerate(interference) if fit >= high]
    rows = list(range(len(interference)))
    for i in below:
        rows[i] = below[-1]
    for i in above:
        rows[i] = above[0]
    return rows


def within_fits(rig: Rig, interference: float) -> bool:
    """Whether an interference [m] lies within the fits that a rig is given for.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> [within_fits(load_material_rig("PDMS"), fit) for fit in (0.178e-3, 0.254e-3)]
    [False, True]
    """
    low, high = rig.interference_range
    return low * (1.0 - _SAME) <= interference <= high * (1.0 + _SAME)


def fits_remark(rig: Rig, interference: Sequence[float]) -> str:
    """Say at which interferences a rig's properties are not its own; empty where all are.

    Parameters
    ----------
    rig : Rig
    interference : sequence of float
        [m]

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> fits_remark(load_material_rig("PDMS"), [0.178e-3, 0.254e-3, 0.3e-3])
    'fits are given for 0.254 and 0.381 mm; for 0.178 mm the nearest is held, for 0.3 mm they are...
    """
    between = [fit for fit in interference if len(_around(rig, fit)) > 1]
    held = [fit for fit in interference if fit not in between and _fit_note(rig, fit)]
    told = [f"for {_millimetres(held)} mm the nearest is held"] if held else []
    told += [f"for {_millimetres(between)} mm they are interpolated"] if between else []
    if not told:
        return ""
    given = _millimetres([fit.interference for fit in rig.fits])
    return f"fits are given for {given} mm; {', '.join(told)}"


def _millimetres(values: Sequence[float]) -> str:
    return axis_words([1e3 * value for value in values])


def _fit_note(rig: Rig, interference: float) -> str:
    around = _around(rig, interference)
    if len(around) == 2:
        left, right = (f"{1e3 * fit.interference:g}" for fit in around)
        return f"interpolated between fits of {left} and {right} mm"
    [nearest] = around
    if math.isclose(nearest.interference, interference, rel_tol=_SAME):
        return ""
    return f"properties of the fit of {1e3 * nearest.interference:g} mm{_HELD}"


def _support_note(rig: Rig, interference: float, support: float) -> str:
    # One damping alone, without a support of its own, is of every support.
    given = [set(fit.damping) for fit in _around(rig, interference) if set(fit.damping) != {FIXED}]
    if not given:
        return ""
    own = sorted(set.intersection(*given)) or sorted(set.union(*given))
    if any(math.isclose(each, support, rel_tol=_SAME) for each in own):
        return ""
    below = [each for each in own if each < support]
    above = [each for each in own if each > support]
    if below and above:
        return f"damping interpolated between {_words(below[-1])} and {_words(above[0])}"
    return f"damping of {_words((below[-1:] or above)[0])}{_HELD}"


def _around(rig: Rig, interference: float) -> list[Fit]:
    """Fits that an interference lies between, or the one that it is or is nearest to."""
    for fit in rig.fits:
        if math.isclose(fit.interference, interference, rel_tol=_SAME):
            return [fit]
    left = [fit for fit in rig.fits if fit.interference < interference]
    right = [fit for fit in rig.fits if fit.interference > interference]
    return [left[-1], right[0]] if left and right else [(left[-1:] or right)[0]]


def _words(support: float) -> str:
    return "the bolted clamp" if math.isinf(support) else f"{support:g} Nm/rad"
