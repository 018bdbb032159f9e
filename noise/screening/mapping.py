"""Map of one design in one environment: regime, noise and level at each condition of a grid.

The map is a stack of planes of interference and speed. Each plane begins as coarse cells whose
corners are simulated; a cell in which not all points simulated so far agree is cut in halves along
both axes, until all agree or nothing is left between the corners. What lies inside a cell that
agrees is taken to be alike, and its level is interpolated among simulated points of the same kind.
Boundaries of silence are followed first, then those between noises, then those of regimes.

Linear stability is asked of every point, which costs next to nothing. Where it says that steady
sliding cannot last while every point simulated about it was quiet, the cell is cut. Where sliding
is stable a vibration may persist (`noise.screening.vibration`), from where it is unstable up to
some speed; beyond a speed at which it has died there is nothing to simulate.

Where the material does not say how temperature acts the map of one temperature is that of all, and
where the properties of the nearest fit are held so is the row of that fit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from models.rig import Rig
from models.show import short_repr
from noise.base.labels import PERSISTS
from noise.screening.grid import Grid
from noise.screening.point import Evaluator
from noise.screening.vibration import Condition
from sim.analysis.regime import Regime
from sim.analysis.stability import sliding_growth
from sim.temperature import at_temperature

Cell = tuple[int, int, int, int, int]
"""Plane, first and last row, first and last column."""

REGIMES = (Regime.STEADY_SLIDING, Regime.QUASI_HARMONIC, Regime.STICK_SLIP)
LABELS = ("none", "creak", "squawk", "squeal")
"""Of a point, in the order of their codes."""

SIMULATED, REFINED, BEYOND = ("simulated", "refined", "beyond")
"""Origin of a point: simulated; as the simulated points around it, or at another temperature or fit
that changes nothing; skipped, since a running vibration dies between it and unstable sliding."""

STRIDE = 8
"""Points from corner to corner of the coarse cells."""

_FEW_ROWS = 8
"""Of a plane, up to which no row tells anything of the next."""

_POINTS_A_CUT = 3
"""Approximate simulations per cut cell: five points, of which neighbours share four."""

_SPEED_APART, _FIT_APART = 1.0, 0.05e-3
"""Largest distance of corners of coarse cells [rad/s] and [m]: a list of few speeds is simulated
wholly, since what lies that far apart tells nothing of what lies between."""

_NEAREST = 4
"""Simulated points that an interpolated level is made of."""


@short_repr
@dataclass(frozen=True, eq=False)
class DesignMap:
    """Results of a design over a grid; all arrays but the axes have the grid's shape.

    Parameters
    ----------
    design, environment : str
    motion : str
        ``steady`` or ``swinging``.
    grid : Grid
        Shape (n_temperatures, n_supports, n_fits, n_speeds).
    regime, label : ndarray of str, shape of the grid
        The label is ``none``, a noise that breaks out from rest, or ``persists``.
    sound, physics : ndarray of str, shape of the grid
        Label of the sound of the vibration, and its name by the physics of the motion.
    level, level_max : ndarray, shape of the grid
        L_Aeq and L_AFmax [dB re 20 uPa]; NaN where the contact slides steadily.
    how : ndarray of str, shape of the grid
        ``simulated``, ``refined`` or ``beyond``.
    growth : ndarray, shape of the grid
        Growth rate of a small vibration about steady sliding [1/s]; NaN for a swinging shaft.
    open : int
        Points beside a boundary that were left to their nearest neighbour.
    """

    design: str
    environment: str
    motion: str
    grid: Grid
    regime: NDArray[np.str_]
    label: NDArray[np.str_]
    sound: NDArray[np.str_]
    physics: NDArray[np.str_]
    level: NDArray[np.float64]
    level_max: NDArray[np.float64]
    how: NDArray[np.str_]
    growth: NDArray[np.float64]
    open: int

    def count(self, how: str) -> int:
        """Return the number of points with one value of `how`."""
        return int(np.sum(self.how == how))


def map_design(
    rig: Rig,
    grid: Grid,
    evaluate: Evaluator,
    *,
    design: str,
    environment: str = "dry",
    most: int | None = None,
) -> DesignMap:
    """Simulate the map of a design over a grid.

    Parameters
    ----------
    rig : Rig
        In its environment.
    grid : Grid
    evaluate : callable
        Of `noise.screening.point.batch_evaluator`.
    design, environment : str
        Names.
    most : int, optional
        Simulations, more or less.

    Returns
    -------
    DesignMap

    Raises
    ------
    ParameterError
        If a condition cannot be simulated.
    """
    # What has the same results is simulated once: temperatures that do not act, and held fits.
    acting = grid.temperature if rig.temperature else (grid.temperature[0],) * grid.shape[0]
    held = np.clip(grid.interference, *rig.interference_range)
    temperature, plane_of = np.unique(acting, return_inverse=True)
    interference, row_of = np.unique(held, return_inverse=True)
    support, speed = np.array(grid.support_stiffness), np.array(grid.speed)
    shape = (temperature.size, support.size, interference.size, speed.size)
    planes = (shape[0] * shape[1], shape[2], shape[3])
    values = np.full((3, *planes), np.nan)  # label by physics, levels
    ran = np.ones(planes, dtype=bool)
    swings = bool(grid.frequency)

    def condition(plane: int, row: int, column: int) -> Condition:
        return Condition(
            grid.speed[column], float(interference[row]), float(support[plane % shape[1]]),
            float(temperature[plane // shape[1]]), grid.frequency[column] if swings else None,
        )  # fmt: skip

    def simulate(points: NDArray[np.int64]) -> NDArray[np.int64]:
        codes = []
        results = evaluate(rig, [condition(*point) for point in points.tolist()])
        for at, one in zip(points.tolist(), results, strict=True):
            physics = LABELS.index(one.physics)
            values[:, *at] = physics, one.level, one.level_max
            ran[tuple(at)] = one.simulated
            kind = LABELS.index(one.label) + len(LABELS) * one.persists
            codes.append(kind * len(REGIMES) + REGIMES.index(one.regime))
        return np.array(codes)

    growth = np.full(shape, np.nan)
    if not swings:
        at = interference[:, None], support[:, None, None]
        hot = [at_temperature(rig, float(t)) for t in temperature]
        growth = np.stack([sliding_growth(one, speed, *at) for one in hot])
    refined = refined_map(
        planes,
        simulate,
        grows=growth.reshape(planes) > 0.0,
        most=most,
        stride=(_stride(interference, _FIT_APART), _stride(speed, _SPEED_APART)),
    )

    def on_grid(planes: NDArray[Any]) -> NDArray[Any]:
        return planes.reshape(shape)[plane_of][:, :, row_of]

    code = on_grid(refined.codes)
    kind = code // len(REGIMES)
    sound = np.array(LABELS)[kind % len(LABELS)]
    physics = on_grid(interpolated(values[0], refined, nearest=1)).astype(int)
    level, level_max = (on_grid(interpolated(one, refined)) for one in values[1:])
    # Of temperatures and fits with the same results the nearest to that which was simulated counts.
    own = np.zeros((grid.shape[0], grid.shape[2]), dtype=bool)
    own[
        np.ix_(_nearest(grid.temperature, temperature), _nearest(grid.interference, interference))
    ] = True
    beyond = on_grid(refined.beyond | ~ran)
    simulated = on_grid(refined.simulated) & own[:, None, :, None]
    return DesignMap(
        design=design,
        environment=environment,
        motion="swinging" if swings else "steady",
        grid=grid,
        regime=np.array([str(regime.value) for regime in REGIMES])[code % len(REGIMES)],
        label=np.where(kind >= len(LABELS), PERSISTS, sound),
        sound=sound,
        physics=np.array(LABELS)[physics],
        level=level,
        level_max=level_max,
        how=np.select([beyond, simulated], [BEYOND, SIMULATED], REFINED),
        growth=on_grid(growth),
        open=refined.open,
    )


def _nearest(axis: Sequence[float], values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the index on an axis of the nearest to each value."""
    return np.asarray(np.abs(np.array(axis)[:, None] - values).argmin(axis=0))


def _stride(values: NDArray[np.float64], apart: float) -> int:
    """Return the stride of coarse cells that are no larger than `apart`."""
    if values.size < 2:
        return STRIDE
    return max(1, min(STRIDE, round(apart / float(np.diff(values).max()))))


@dataclass(frozen=True, eq=False)
class Refined:
    """Codes of a map and their origin.

    Parameters
    ----------
    codes : ndarray of int, shape (n_planes, n_rows, n_columns)
        0 is silence; of noises the kind times the number of regimes, and the regime.
    simulated, beyond : ndarray of bool, same shape
        Simulated points, and points that were skipped since a vibration dies before them.
    open : int
        Points beside a boundary that were left to their nearest neighbour.
    """

    codes: NDArray[np.int64]
    simulated: NDArray[np.bool_]
    beyond: NDArray[np.bool_]
    open: int


def refined_map(
    shape: tuple[int, int, int],
    simulate: Callable[[NDArray[np.int64]], NDArray[np.int64]],
    *,
    grows: NDArray[np.bool_] | None = None,
    stride: tuple[int, int] = (STRIDE, STRIDE),
    most: int | None = None,
) -> Refined:
    """Fill a map by simulating its boundaries finely and the rest coarsely.

    Parameters
    ----------
    shape : tuple of int
        Planes, rows and columns.
    simulate : callable
        ``simulate(points)``: codes of the points, rows of (plane, row, column).
    grows : ndarray of bool, `shape`, optional
        Where steady sliding cannot last, so that a cell is not silent whatever its corners are.
    stride : tuple of int
        Points from corner to corner of the coarse cells; of rows and of columns.
    most : int, optional
        Simulations, more or less; what remains open then is left to its nearest neighbour.

    Returns
    -------
    Refined

    Examples
    --------
    >>> found = refined_map((1, 1, 100), lambda points: 3 * (points[:, 2] > 62))
    >>> int((found.codes > 0).sum()), int(found.simulated.sum())
    (37, 16)
    """
    planes, rows, columns = shape
    codes = np.full(shape, -1, dtype=np.int64)
    cells: list[Cell] = [
        (plane, top, bottom, left, right)
        for plane in range(planes)
        for top, bottom in _intervals(rows, stride[0], few=_FEW_ROWS)
        for left, right in _intervals(columns, stride[1], few=1)
    ]
    settled: list[Cell] = []
    beyond, spent = np.zeros(shape, dtype=bool), 0
    while cells:
        wanted = np.unique(np.concatenate([_corners(cell) for cell in cells]), axis=0)
        wanted = wanted[codes[tuple(wanted.T)] < 0]
        if grows is not None:
            silent = np.array([_dies_before(codes, grows, *point) for point in wanted], dtype=bool)
            codes[tuple(wanted[silent].T)] = 0
            beyond[tuple(wanted[silent].T)] = True
            wanted = wanted[~silent]
        if wanted.size:
            codes[tuple(wanted.T)] = simulate(wanted)
            spent += len(wanted)
        # A corner may stand in the side of a cell that agreed before it was there.
        ranked = [(_urgency(codes, grows, cell), cell) for cell in (*settled, *cells)]
        open_cells = [(urgency, cell) for urgency, cell in ranked if urgency and _halves(cell)]
        most_urgent = max((urgency for urgency, _ in open_cells), default=None)
        cut = [cell for urgency, cell in open_cells if urgency == most_urgent]
        if most is not None and len(cut) > (room := max(0, most - spent) // _POINTS_A_CUT):
            cut = [cut[i] for i in np.linspace(0, len(cut) - 1, room).astype(int)]
        taken = set(cut)
        settled = [cell for _, cell in ranked if cell not in taken]
        cells = [part for cell in cut for part in _halves(cell)]
    simulated = (codes >= 0) & ~beyond
    for cell in settled:
        if not _urgency(codes, grows, cell):
            inside = _inside(cell)
            known = codes[inside]
            codes[inside] = np.where(known < 0, known.max(), known)
    n_open = int((codes < 0).sum())
    for plane in codes:  # to the nearest point that is known
        holes, known = np.argwhere(plane < 0), np.argwhere(plane >= 0)
        if holes.size:
            plane[tuple(holes.T)] = plane[tuple(known[cKDTree(known).query(holes)[1]].T)]
    return Refined(codes, simulated, beyond, n_open)


def _dies_before(
    codes: NDArray[np.int64], grows: NDArray[np.bool_], plane: int, row: int, column: int
) -> bool:
    """Return whether a vibration has died between each speed of unstable sliding and a point."""
    code, unstable = codes[plane, row], np.flatnonzero(grows[plane, row])
    if not unstable.size or grows[plane, row, column]:
        return False
    below, above = unstable[unstable < column], unstable[unstable > column]
    between = [code[below[-1] + 1 : column]] if below.size else []
    between += [code[column + 1 : above[0]]] if above.size else []
    return all((one == 0).any() for one in between)


def _urgency(
    codes: NDArray[np.int64], grows: NDArray[np.bool_] | None, cell: Cell
) -> tuple[int, int] | None:
    """Return the priority of cutting a cell: what differs in it, and its size; None if nothing."""
    inside = _inside(cell)
    known = codes[inside]
    values = known[known >= 0]
    size = max(cell[2] - cell[1], cell[4] - cell[3])
    silent = values < len(REGIMES)
    if np.all(values == values[0]):
        unstable = grows is not None and bool(grows[inside][known < 0].any())
        return (3, size) if values[0] == 0 and unstable else None
    if np.any(silent != silent[0]):
        return 3, size
    kinds = values // len(REGIMES)
    return (2 if np.any(kinds != kinds[0]) else 1), size


def _intervals(n: int, stride: int, *, few: int) -> list[tuple[int, int]]:
    """Return 0 .. n - 1 split into intervals of about `stride` with common ends.

    Up to `few` numbers are intervals of their own, since rows of a map may lie far apart.
    """
    if n <= few:
        return [(i, i) for i in range(n)]
    pieces = max(1, round((n - 1) / stride))
    ends = np.unique(np.linspace(0, n - 1, pieces + 1).round().astype(int)).tolist()
    return list(pairwise(ends))


def _corners(cell: Cell) -> NDArray[np.int64]:
    plane, top, bottom, left, right = cell
    return np.array([(plane, row, column) for row in (top, bottom) for column in (left, right)])


def _inside(cell: Cell) -> tuple[int, slice, slice]:
    plane, top, bottom, left, right = cell
    return plane, slice(top, bottom + 1), slice(left, right + 1)


def _halves(cell: Cell) -> list[Cell]:
    """Return the parts of a cell halved along both axes; none if it has no inner point."""
    plane, top, bottom, left, right = cell
    if bottom - top < 2 and right - left < 2:
        return []
    rows, columns = (
        [(a, b)] if b - a < 2 else [(a, (a + b) // 2), ((a + b) // 2, b)]
        for a, b in ((top, bottom), (left, right))
    )
    return [(plane, *row, *column) for row in rows for column in columns]


def interpolated(
    values: NDArray[np.float64], refined: Refined, *, nearest: int = _NEAREST
) -> NDArray[np.float64]:
    """Interpolate values of simulated points to other points of the same code and plane.

    Parameters
    ----------
    values : ndarray, shape (n_planes, n_rows, n_columns)
        In any unit, such as [dB]; any at points that were not simulated.
    refined : Refined
    nearest : int
        Points that are averaged, weighted by the inverse square of their distance.

    Returns
    -------
    ndarray, same shape
        In the unit of the values, such as [dB].

    Examples
    --------
    >>> codes, simulated = np.zeros((1, 1, 5), dtype=int), np.array([[[1, 0, 0, 0, 1]]]) > 0
    >>> levels = np.array([[[60.0, 0.0, 0.0, 0.0, 80.0]]])
    >>> interpolated(levels, Refined(codes, simulated, ~simulated, 0)).round()
    array([[[60., 62., 70., 78., 80.]]])
    """
    filled = values.copy()
    for plane, codes in enumerate(refined.codes):
        known = np.argwhere(refined.simulated[plane])
        of_known = codes[tuple(known.T)]
        for code in np.unique(codes):
            holes = np.argwhere((codes == code) & ~refined.simulated[plane])
            near = known[of_known == code]
            if not (holes.size and near.size):
                continue
            distance, which = cKDTree(near).query(holes, k=min(nearest, len(near)))
            distance, which = distance.reshape(len(holes), -1), which.reshape(len(holes), -1)
            weight = distance**-2
            of_near = values[plane][tuple(near[which].transpose(2, 0, 1))]
            filled[plane][tuple(holes.T)] = (weight * of_near).sum(1) / weight.sum(1)
    return filled
