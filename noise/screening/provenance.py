"""Provenance of the data at a point of a map: the design's own, interpolated or held.

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
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED
from noise.screening.axis_values import axis_words

if TYPE_CHECKING:
    from models.rig import Rig
    from noise.screening.grid import Grid


RULE = (
    "where a design has no data of its own, stiffness, torques and damping are interpolated "
    "linearly in the interference between two fits, the damping linearly in the support's "
    "compliance between two supports; beyond the first and the last those of the nearest are held"
)
"""Rule for conditions without data of the design."""

_SAME = 0.01
"""Relative tolerance of a fit or support that data are given for."""


def point_notes(rig: Rig, grid: Grid) -> tuple[NDArray[np.object_], NDArray[np.bool_]]:
    """Return a note at each point on data that are not the design's own.

    Parameters
    ----------
    rig : Rig
    grid : Grid

    Returns
    -------
    notes : ndarray of str, shape of the grid
        What was interpolated, held, or is faster than anything that the rig was fitted to; empty
        where nothing is.
    substituted : ndarray of bool, same shape
        Where `RULE` stands in.

    Examples
    --------
    >>> from noise.screening.design import Use, load_design
    >>> from noise.screening.grid import shared_grid
    >>> design = load_design("fluorocarbon")
    >>> use = Use(speed=(5.0,), interference=(0.3e-3,), support_stiffness=(2214.0, 3000.0))
    >>> for note in point_notes(design.rig, shared_grid([design], use))[0].flat:
    ...     print(note)
    interpolated between fits of 0.279 and 0.381 mm
    interpolated between fits of 0.279 and 0.381 mm; damping interpolated between 2214 Nm/rad and...
    """
    fast = f"faster than {rig.fastest_fitted:.4g} rad/s, the fastest that was fitted"
    notes = np.empty(grid.shape, dtype=object)
    substituted = np.zeros(grid.shape, dtype=bool)
    for k, support in enumerate(grid.support_stiffness):
        for i, fit in enumerate(grid.interference):
            stand_in = [_fit_note(rig, fit), _support_note(rig, fit, support)]
            substituted[:, k, i] = any(stand_in)
            for v, speed in enumerate(grid.speed):
                beyond = [fast] if speed > rig.fastest_fitted * (1.0 + 1e-9) else []
                notes[:, k, i, v] = "; ".join(filter(None, [*stand_in, *beyond]))
    return notes, substituted


def rows_of(rig: Rig, interference: Sequence[float]) -> list[int]:
    """Return for each row of a map the row that has its results: itself, or that of a held fit.

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
    fits = np.array(interference)
    rows = np.arange(fits.size)
    rows[fits <= low] = rows[fits <= low].max(initial=-1)
    rows[fits >= high] = rows[fits >= high].min(initial=fits.size)
    return [int(row) for row in rows]


def within_fits(rig: Rig, interference: float) -> bool:
    """Return whether an interference [m] lies within the fits of a rig.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> [within_fits(load_material_rig("PDMS"), fit) for fit in (0.178e-3, 0.254e-3)]
    [False, True]
    """
    low, high = rig.interference_range
    return low * (1.0 - _SAME) <= interference <= high * (1.0 + _SAME)


def fits_remark(rig: Rig, interference: Sequence[float]) -> str:
    """Return a remark on interferences without a fit of their own; empty if there are none.

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
    given = [fit.interference for fit in rig.fits]
    texts = [f"fits are given for {_millimetres(given)} mm"]
    stand_in = {fit: len(_stand_in(given, fit)) for fit in interference}
    of = {n: _millimetres([fit for fit in interference if stand_in[fit] == n]) for n in (1, 2)}
    parts = [f"for {of[1]} mm the nearest is held"] if of[1] else []
    parts += [f"for {of[2]} mm they are interpolated"] if of[2] else []
    return "; ".join([*texts, ", ".join(parts)]) if parts else ""


def _millimetres(values: Sequence[float]) -> str:
    return axis_words([1e3 * value for value in values]) if values else ""


def _stand_in(given: Iterable[float], value: float) -> list[float]:
    """Return the substitutes of a value: the two around it or the nearest; none if it is given."""
    if any(math.isclose(each, value, rel_tol=_SAME) for each in given):
        return []
    below, above = [g for g in given if g < value], [g for g in given if g > value]
    return [below[-1], above[0]] if below and above else below[-1:] or above[:1]


def _fit_note(rig: Rig, interference: float) -> str:
    around = [
        f"{1e3 * fit:g}" for fit in _stand_in([f.interference for f in rig.fits], interference)
    ]
    if len(around) == 2:
        return f"interpolated between fits of {' and '.join(around)} mm"
    return f"properties of the fit of {around[0]} mm held" if around else ""


def _support_note(rig: Rig, interference: float, support: float) -> str:
    around = _stand_in([fit.interference for fit in rig.fits], interference)
    fits = [
        fit for fit in rig.fits
        if fit.interference in around
        or (not around and math.isclose(fit.interference, interference, rel_tol=_SAME))
    ]  # fmt: skip
    # One damping alone, without a support of its own, is of every support.
    given = [set(fit.damping) for fit in fits if set(fit.damping) != {FIXED}]
    if not given:
        return ""
    own = sorted(set.intersection(*given)) or sorted(set.union(*given))
    words = [
        "the bolted clamp" if math.isinf(each) else f"{each:g} Nm/rad"
        for each in _stand_in(own, support)
    ]
    if len(words) == 2:
        return f"damping interpolated between {' and '.join(words)}"
    return f"damping of {words[0]} held" if words else ""
