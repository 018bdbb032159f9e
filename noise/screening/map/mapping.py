"""Map of one design in one environment: regime, noise and level at each condition of a grid.

Where the friction law does not know the temperature the map of one temperature is that of all, and
its copies say so. Stability is asked at every point of constant speed; a swinging shaft has no
steady sliding, and its map is refined without.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from noise.screening.map.batches import LABELS, Batch
from noise.screening.map.interpolate import interpolate_levels
from noise.screening.map.point import REGIMES
from noise.screening.map.refine import HOW, STRIDE, refined_map
from sim.analysis.regime import Regime
from sim.analysis.stability import steady_sliding
from sim.friction import at_temperature, friction_law

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig
    from noise.screening.map.batches import Evaluator
    from noise.screening.map.grid import Grid

__all__ = ["UNCHANGED", "DesignMap", "map_design"]

UNCHANGED = "unchanged"
"""How a point is known whose temperature makes no difference."""

_SPEED_APART, _FIT_APART = 1.0, 0.05e-3
"""Largest distance of corners of coarse cells [rad/s] and [m]: a list of few speeds is simulated
wholly, since what lies that far apart tells nothing of what lies between."""

_NONE = LABELS.index("none")
_STEADY = REGIMES.index(Regime.STEADY_SLIDING)


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
    level : ndarray, shape of the grid
        L_AFmax [dB re 20 uPa]; NaN where the contact slides steadily.
    loudness : ndarray, shape of the grid
        N10 [sone]; NaN where it was not asked for.
    how : ndarray of str, shape of the grid
        ``simulated``, ``stability``, ``refined`` or ``unchanged``.
    growth : ndarray, shape of the grid
        Of a small vibration about steady sliding [1/s]; NaN where the shaft swings.
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
    loudness: NDArray[np.float64]
    how: NDArray[np.str_]
    growth: NDArray[np.float64]
    open: int

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
    law = friction_law(rig.friction.name)
    warm = "temperature" in law.parameters and "temperature" not in rig.friction.parameters
    temperature = np.array(grid.temperature if warm else grid.temperature[:1])
    shape = (temperature.size, *grid.shape[1:])
    planes = (shape[0] * shape[1], *shape[2:])
    axes = (temperature, *(np.array(axis) for axis in (grid.support_stiffness, grid.interference)))
    level = np.full(planes, np.nan)
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
        level[plane, row, column] = rows[:, 2]
        return (rows[:, 0] * len(LABELS) + rows[:, 1]).astype(np.int64)

    growth = np.full(planes, np.nan) if swings else _growth(rig, axes, speed).reshape(planes)
    found = refined_map(
        planes,
        simulate,
        quiet=[_STEADY * len(LABELS) + _NONE],
        stable=None if swings else growth <= 0.0,
        label_of=np.arange(len(REGIMES) * len(LABELS)) % len(LABELS),
        most=most,
        stride=stride or (_stride(axes[2], _FIT_APART), _stride(speed, _SPEED_APART)),
    )
    level = interpolate_levels(level, found.codes, found.how)
    how = np.array(HOW)[found.how].reshape(shape)
    result = DesignMap(
        design=design,
        environment=environment,
        motion="swinging" if swings else "steady",
        grid=grid,
        regime=np.array([str(r.value) for r in REGIMES])[found.codes // len(LABELS)].reshape(shape),
        label=np.array(LABELS)[found.codes % len(LABELS)].reshape(shape),
        level=level.reshape(shape),
        loudness=np.full(shape, np.nan),
        how=how.astype("U10"),
        growth=growth.reshape(shape),
        open=found.open,
    )
    return result if warm else _copied(result)


def _stride(values: NDArray[np.float64], apart: float) -> int:
    """Points from corner to corner of coarse cells that are no larger than `apart`."""
    if values.size < 2:
        return STRIDE
    return max(1, min(STRIDE, round(apart / float(np.diff(values).max()))))


def _growth(
    rig: Rig, axes: tuple[NDArray[np.float64], ...], speed: NDArray[np.float64]
) -> NDArray[np.float64]:
    temperature, support, fit = axes
    return np.stack(
        [
            steady_sliding(
                replace(rig, friction=at_temperature(rig.friction, float(t))),
                speed,
                fit[:, None],
                support[:, None, None],
            ).growth
            for t in temperature
        ]
    )


def _copied(found: DesignMap) -> DesignMap:
    """Repeat a map at all temperatures."""
    n = len(found.grid.temperature)
    how = np.repeat(found.how, n, axis=0)
    how[1:] = UNCHANGED
    alike = ("regime", "label", "level", "loudness", "growth")
    copies: dict[str, Any] = {name: np.repeat(getattr(found, name), n, axis=0) for name in alike}
    return replace(found, how=how, **copies)
