"""Map of one design in one environment: regime, noise and level at each condition of a grid.

Where the material does not say how temperature acts the map of one temperature is that of all, and
where the properties of the nearest fit are held so is the row of that fit; the copies say so.
Stability is asked at every point of constant speed; a swinging shaft has no
steady sliding, and its map is refined without.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from models.rig import Rig
from models.show import short_repr
from noise.screening.map.batches import LABELS, Batch, Evaluator
from noise.screening.map.interpolate import interpolate_levels
from noise.screening.map.point import REGIMES
from noise.screening.map.provenance import is_substituted, point_notes, rows_of
from noise.screening.map.refine import HOW, STRIDE, refined_map
from sim.analysis.regime import Regime
from sim.analysis.stability import steady_sliding
from sim.temperature import at_temperature

if TYPE_CHECKING:
    from noise.screening.map.grid import Grid


UNCHANGED = "unchanged"
"""How a point is known whose temperature, or interference, makes no difference."""

_SPEED_APART, _FIT_APART = 1.0, 0.05e-3
"""Largest distance of corners of coarse cells [rad/s] and [m]: a list of few speeds is simulated
wholly, since what lies that far apart tells nothing of what lies between."""

_NONE = LABELS.index("none")
_STEADY = REGIMES.index(Regime.STEADY_SLIDING)


@short_repr
@dataclass(frozen=True, eq=False)
class DesignMap:
    """What a design does over a grid; all arrays but the axes have the grid's shape.

    Parameters
    ----------
    design, environment : str
    motion : str
        ``steady`` or ``swinging``.
    grid : Grid
        Shape (n_temperatures, n_supports, n_fits, n_speeds).
    regime, label : ndarray of str, shape of the grid
    level, level_max : ndarray, shape of the grid
        L_Aeq and L_AFmax [dB re 20 uPa]; NaN where the contact slides steadily.
    loudness : ndarray, shape of the grid
        N5 [sone]; NaN where it was not asked for.
    how : ndarray of str, shape of the grid
        ``simulated``, ``stability``, ``refined`` or ``unchanged``.
    growth : ndarray, shape of the grid
        Of a small vibration about steady sliding [1/s]; NaN where the shaft swings.
    note : ndarray of str, shape of the grid
        What is not the design's own there, by `noise.screening.map.provenance.point_notes`: data
        interpolated or held, a speed beyond those fitted; empty where nothing is.
    open : int
        Points beside a boundary that were left to their nearest neighbour.
    """

    design: str
    environment: str
    motion: str
    grid: Grid
    regime: NDArray[np.str_]
    label: NDArray[np.str_]
    level: NDArray[np.float64]
    level_max: NDArray[np.float64]
    loudness: NDArray[np.float64]
    how: NDArray[np.str_]
    growth: NDArray[np.float64]
    note: NDArray[np.object_]
    open: int

    @property
    def substituted(self) -> NDArray[np.bool_]:
        """At which points data interpolated or held stand in for the design's own."""
        return np.array([is_substituted(str(note)) for note in self.note.flat]).reshape(
            self.note.shape
        )

    def count(self, how: str) -> int:
        """How many points are known in a way."""
        return int(np.sum(self.how == how))


def map_design(
    rig: Rig,
    grid: Grid,
    evaluate: Evaluator,
    *,
    design: str,
    environment: str = "dry",
    most: int | None = None,
    stride: int | None = None,
) -> DesignMap:
    """Map a design over a grid.

    Parameters
    ----------
    rig : Rig
        In its environment.
    grid : Grid
    evaluate : callable
        Of `noise.screening.map.batches.batch_evaluator`.
    design, environment : str
        Names.
    most : int, optional
        Simulations, more or less.
    stride : int, optional
        Points from corner to corner of the coarse cells; 1 simulates all.

    Returns
    -------
    DesignMap

    Raises
    ------
    ParameterError
        If a condition cannot be simulated.
    """
    known_by = (
        np.arange(grid.shape[0]) if rig.temperature else np.zeros(grid.shape[0], dtype=int),
        np.array(rows_of(rig, grid.interference)),
    )
    temperature, interference = (
        np.array(axis)[np.unique(known)]
        for axis, known in zip((grid.temperature, grid.interference), known_by, strict=True)
    )
    axes = (temperature, np.array(grid.support_stiffness), interference)
    shape = (temperature.size, len(grid.support_stiffness), interference.size, len(grid.speed))
    planes = (shape[0] * shape[1], shape[2], shape[3])
    levels = np.full((2, *planes), np.nan)
    swings = bool(grid.frequency)
    frequency = np.array(grid.frequency) if swings else np.full(shape[3], np.nan)
    speed = np.array(grid.speed)

    def simulate(points: NDArray[np.int64]) -> NDArray[np.int64]:
        plane, row, column = points.T
        rows = evaluate(
            Batch(
                rig,
                speed[column],
                frequency[column],
                axes[2][row],
                axes[1][plane % shape[1]],
                axes[0][plane // shape[1]],
            )
        )
        levels[:, plane, row, column] = rows[:, 2:].T
        return (rows[:, 0] * len(LABELS) + rows[:, 1]).astype(np.int64)

    growth = np.full(planes, np.nan) if swings else growth_rates(rig, axes, speed).reshape(planes)
    found = refined_map(
        planes,
        simulate,
        quiet=[_STEADY * len(LABELS) + _NONE],
        stable=None if swings else growth <= 0.0,
        label_of=np.arange(len(REGIMES) * len(LABELS)) % len(LABELS),
        most=most,
        stride=stride or (_stride(axes[2], _FIT_APART), _stride(speed, _SPEED_APART)),
    )
    level, level_max = (
        interpolate_levels(one, found.codes, found.how).reshape(shape) for one in levels
    )
    how = np.array(HOW)[found.how].reshape(shape)
    mapped = DesignMap(
        design=design,
        environment=environment,
        motion="swinging" if swings else "steady",
        grid=grid,
        regime=np.array([str(r.value) for r in REGIMES])[found.codes // len(LABELS)].reshape(shape),
        label=np.array(LABELS)[found.codes % len(LABELS)].reshape(shape),
        level=level,
        level_max=level_max,
        loudness=np.full(shape, np.nan),
        how=how.astype("U10"),
        growth=growth.reshape(shape),
        note=point_notes(rig, grid),
        open=found.open,
    )
    return _copied(mapped, *known_by)


def _stride(values: NDArray[np.float64], apart: float) -> int:
    """Points from corner to corner of coarse cells that are no larger than `apart`."""
    if values.size < 2:
        return STRIDE
    return max(1, min(STRIDE, round(apart / float(np.diff(values).max()))))


def growth_rates(
    rig: Rig, axes: tuple[NDArray[np.float64], ...], speed: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Growth of a small vibration about steady sliding over a grid.

    Parameters
    ----------
    rig : Rig
    axes : tuple of ndarray, shapes (n_temperatures,), (n_supports,) and (n_fits,)
        Temperatures [degree Celsius], supports [Nm/rad] and interferences [m].
    speed : ndarray, shape (n_speeds,)
        [rad/s]

    Returns
    -------
    ndarray, shape (n_temperatures, n_supports, n_fits, n_speeds)
        [1/s]
    """
    temperature, support, fit = axes
    return np.stack(
        [
            steady_sliding(
                at_temperature(rig, float(t)),
                speed,
                fit[:, None],
                support[:, None, None],
            ).growth
            for t in temperature
        ]
    )


def _copied(found: DesignMap, *known_by: NDArray[np.int64]) -> DesignMap:
    """Repeat a map at all temperatures and fits, by those that each is known by."""
    at = [np.unique(known, return_inverse=True)[1] for known in known_by]
    own = [known == np.arange(known.size) for known in known_by]
    names = ("regime", "label", "level", "level_max", "loudness", "how", "growth")
    copies: dict[str, Any] = {name: getattr(found, name)[at[0]][:, :, at[1]] for name in names}
    copied = ~(own[0][:, None, None, None] & own[1][:, None])
    copies["how"] = np.where(copied, UNCHANGED, copies["how"])
    return replace(found, **copies)
