"""Objective of the calibration: the distance of a rig from what was measured, in one number.

The measure that is reported is the root mean square of log(simulated / measured) over the critical
speeds. It weighs most; the other terms are hinges, nil where the thesis's finding is met. Critical
speeds are where the sudden share, or the oscillation, crosses its limit (`sim.analysis.regime`)
for the last time on a grid of speeds, fine about what was measured and coarse elsewhere,
interpolated between its points, so that a small change of a parameter shows. The speeds reported
afterwards are those of `sim.analysis.critical_speeds`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed

from models.errors import ParameterError
from noise.training.calibrate.cells import CELLS, NOISES, STICKING, SUPPORTS, THIN_CELLS, Cell
from sim.analysis.critical_speeds import falls_below, motion_from_rest
from sim.analysis.regime import LEAST_OSCILLATION, regime_measures
from sim.analysis.slips import LEAST_SUDDEN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["Score", "score"]

_COARSE = np.geomspace(1.6, 14.4, 12)
_THIN_GRID = np.geomspace(1.0, 9.0, 10)

_FINE = {"v_crit1": 0.25, "v_crit2": 0.5}
"""Spacing about what was measured [rad/s]."""

_WINDOW = 0.8, 1.35
"""Over what was measured: where the grid is fine."""

_SECONDS = 0.8

_CRITICAL_SPEEDS, _THIN, _FLATNESS, _STICK, _NOISE = 20.0, 1.25, 2.0, 0.15, 0.25
"""Weights."""

_FLAT = 1.10
"""Mean torque may vary by a tenth over the speeds (5.1.1)."""

_LINE_SHARE = 10.0 ** (-18.0 / 20.0)
"""Amplitude of a line that counts, over the strongest: `noise.noise_definition`."""

_SLIP_BAND, _MIDDLE_BAND, _ELASTOMER_BAND = (120.0, 420.0), (420.0, 760.0), (850.0, 1150.0)

_MOST = 3.0
"""No hinge counts more."""

_UNUSABLE = 100.0

Task = tuple[float, float, float]
"""Interference, support stiffness and speed of a run."""


@dataclass(frozen=True)
class _Settled:
    """What is kept of a run: of its last half."""

    sudden: float
    oscillation: float
    mean: float
    slip_line: float
    middle_line: float
    strongest: float


@dataclass(frozen=True)
class Score:
    """What a rig comes to.

    Parameters
    ----------
    cost : float
        To be minimised [-].
    speeds : dict of Cell to float
        Critical speeds as the search sees them [rad/s].
    """

    cost: float
    speeds: Mapping[Cell, float]

    def log_error(self, cells: Iterable[Cell]) -> float:
        """Root mean square of log(simulated / measured) [-]."""
        errors = [cell.log_error(self.speeds[cell]) for cell in cells]
        return math.sqrt(sum(error * error for error in errors) / len(errors))


def score(
    rig: Rig | None,
    fitted: Sequence[Cell] = CELLS,
    *,
    critical_speeds_alone: bool = False,
    workers: int = -1,
) -> Score:
    """Judge a rig.

    Parameters
    ----------
    rig : Rig or None
        None is no rig at all, as bad as can be.
    fitted : sequence of Cell
        The critical speeds that count.
    critical_speeds_alone : bool
        Leave out the other interferences and the noises.
    workers : int
        Threads; the result does not depend on it.

    Returns
    -------
    Score
    """
    if rig is None:
        return Score(_UNUSABLE, {})
    tasks: list[Task] = [(0.279e-3, k, float(v)) for k in SUPPORTS for v in _grid(k)]
    if not critical_speeds_alone:
        tasks += [(0.178e-3, k, float(v)) for k in SUPPORTS for v in _THIN_GRID]
        tasks += list(STICKING)
        tasks += [(c.interference, c.support_stiffness, c.speed) for c in NOISES]
    try:
        found = Parallel(n_jobs=workers, prefer="threads")(
            delayed(_settled)(rig, task) for task in tasks
        )
    except ParameterError:
        return Score(_UNUSABLE, {})
    runs = dict(zip(tasks, found, strict=True))
    speeds = {cell: _critical_speed(cell, runs, _grid(cell.support_stiffness)) for cell in CELLS}
    cost = _CRITICAL_SPEEDS * Score(0.0, speeds).log_error(fitted)
    for support in SUPPORTS:
        means = [runs[0.279e-3, support, float(v)].mean for v in _grid(support)]
        cost += _FLATNESS * max(0.0, max(means) / min(means) - _FLAT)
    if not critical_speeds_alone:
        thin = {cell: _critical_speed(cell, runs, _THIN_GRID) for cell in THIN_CELLS}
        speeds |= thin
        cost += _THIN * Score(0.0, thin).log_error(THIN_CELLS)
        cost += _STICK * sum(_above(runs[task].sudden, LEAST_SUDDEN) for task in STICKING)
        cost += _NOISE * sum(
            _HINGES[c.noise](runs[c.interference, c.support_stiffness, c.speed]) for c in NOISES
        )
    return Score(cost, speeds)


@cache
def _grid(support_stiffness: float) -> NDArray[np.float64]:
    """Speeds to try at 0.279 mm."""
    low, high = _WINDOW
    fine = [
        np.arange(low * cell.speed, high * cell.speed, _FINE[cell.item])
        for cell in CELLS
        if cell.support_stiffness == support_stiffness
    ]
    return np.unique(np.concatenate([_COARSE, *fine]))


def _settled(rig: Rig, task: Task) -> _Settled:
    interference, support, speed = task
    motion = motion_from_rest(rig, speed, interference, support, seconds=_SECONDS)
    sudden, oscillation = regime_measures(motion)
    last = motion.since(motion.torque.size // 2)
    mean = float(np.mean(last.torque))
    torque = last.torque - mean
    amplitude = np.abs(np.fft.rfft(torque * np.hanning(torque.size)))
    frequency = np.fft.rfftfreq(torque.size, 1.0 / motion.rate)

    def highest(band: tuple[float, float]) -> float:
        return float(amplitude[(frequency >= band[0]) & (frequency < band[1])].max())

    top = int(np.argmax(amplitude[frequency < 2500.0]))
    strongest = max(float(amplitude[top]), 1e-12)
    return _Settled(
        sudden=sudden,
        oscillation=oscillation,
        mean=mean,
        slip_line=highest(_SLIP_BAND) / strongest,
        middle_line=highest(_MIDDLE_BAND) / strongest,
        strongest=float(frequency[top]),
    )


def _critical_speed(cell: Cell, runs: Mapping[Task, _Settled], grid: NDArray[np.float64]) -> float:
    row = [runs[cell.interference, cell.support_stiffness, float(v)] for v in grid]
    oscillation = _last_crossing(grid, [run.oscillation for run in row], LEAST_OSCILLATION)
    if cell.item == "v_crit2":
        return oscillation
    vibrating = [run.sudden if run.oscillation > LEAST_OSCILLATION else 0.0 for run in row]
    return min(oscillation, _last_crossing(grid, vibrating, LEAST_SUDDEN))


def _last_crossing(speed: NDArray[np.float64], values: list[float], limit: float) -> float:
    """Last speed with a value above the limit, on logarithmic scales."""
    above = [i for i, value in enumerate(values) if value > limit]
    if not above:
        return 0.8 * float(speed[0])
    last = above[-1]
    if last == len(values) - 1:
        return 1.1 * float(speed[-1])
    return falls_below(limit, speed[last], values[last], speed[last + 1], values[last + 1])


def _above(value: float, limit: float) -> float:
    return min(_MOST, max(0.0, math.log(1.2 * limit / max(value, 1e-5))))


def _below(value: float, limit: float) -> float:
    return min(_MOST, max(0.0, math.log(1.2 * max(value, 1e-5) / limit)))


def _squawk(run: _Settled) -> float:
    return (
        _above(run.oscillation, LEAST_OSCILLATION)
        + 0.5 * _above(run.slip_line, _LINE_SHARE)
        + 0.25 * _above(run.middle_line, 0.5 * _LINE_SHARE)
    )


def _squeal(run: _Settled) -> float:
    low, high = _ELASTOMER_BAND
    return (
        _above(run.oscillation, LEAST_OSCILLATION)
        + 0.5 * _below(run.slip_line, 0.5 * _LINE_SHARE)
        + 0.5 * _below(run.middle_line, 0.5 * _LINE_SHARE)
        + (0.0 if low < run.strongest < high else 0.5)
    )


def _silence(run: _Settled) -> float:
    return _below(run.oscillation, LEAST_OSCILLATION)


_HINGES: Mapping[str, Callable[[_Settled], float]] = {
    "squawk": _squawk,
    "squeal": _squeal,
    "none": _silence,
}
