"""Traces of one condition in three models: the thesis's listing, its equations, the calibrated one.

Slips are compared by laying them over each other, so each trace knows when its slips begin: where
stick ends, or, in a contact that creeps, where the torque starts to drop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.thesis.runs import CALIBRATED, THESIS, Case, listing_run, motion
from sim.analysis.slips import motion_slips
from sim.analysis.thesis_listing import STEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SHOWN", "Trace", "exact_trace", "listing_trace", "model_traces"]

SHOWN = 0.08
"""How much of a settled run is shown over time [s]."""

_RATE = 100e3
"""Of the exact and the calibrated traces [Hz]: a slip lasts half a millisecond."""


@dataclass(frozen=True, eq=False)
class Trace:
    """A run from rest of one model; arrays have shape (n,).

    Parameters
    ----------
    name : str
    time : ndarray, shape (n,)
        [s]
    torque, displacement, sliding_speed : ndarray, shape (n,)
        In the elastomer [Nm], of its surface [rad], of the shaft over it [rad/s].
    clamp_speed : ndarray or None, shape (n,)
        [rad/s]; the listing does not write it.
    slips : ndarray, shape (n_slips,)
        When slips begin [s].
    """

    name: str
    time: NDArray[np.float64]
    torque: NDArray[np.float64]
    displacement: NDArray[np.float64]
    sliding_speed: NDArray[np.float64]
    clamp_speed: NDArray[np.float64] | None
    slips: NDArray[np.float64]

    def during(self, start: float, end: float) -> Trace:
        """Return the part between two times [s], time counted from `start` on."""
        part = slice(*np.searchsorted(self.time, (start, end)))
        return Trace(
            name=self.name,
            time=self.time[part] - start,
            torque=self.torque[part],
            displacement=self.displacement[part],
            sliding_speed=self.sliding_speed[part],
            clamp_speed=None if self.clamp_speed is None else self.clamp_speed[part],
            slips=self.slips[(self.slips >= start) & (self.slips < end)] - start,
        )

    def middle(self, seconds: float) -> Trace:
        """Return so many seconds of the settled run [s], from its middle on."""
        start = 0.5 * float(self.time[-1])
        return self.during(start, start + seconds)

    @property
    def clamp_acceleration(self) -> NDArray[np.float64]:
        """Acceleration of the clamp [rad/s^2].

        Returns
        -------
        ndarray, shape (n,)
            [rad/s^2]

        Raises
        ------
        ParameterError
            The model does not write the clamp's speed.
        """
        if self.clamp_speed is None:
            raise ParameterError(f"{self.name}: does not tell the clamp's speed")
        return np.asarray(np.gradient(self.clamp_speed, self.time))

    def settled_slip(self) -> float:
        """When the first slip of the last half begins [s]; the middle of the run if none does."""
        middle = 0.5 * float(self.time[-1])
        late = self.slips[self.slips >= middle]
        return float(late[0]) if late.size else middle


def model_traces(case: Case, seconds: float = 0.5) -> tuple[Trace, ...]:
    """Run a case in all three models, in two where the clamp is fixed.

    Examples
    --------
    >>> [trace.name for trace in model_traces(Case(1.0), 0.1)]
    ['listing', 'equations, exact', 'calibrated']
    """
    simulated = (exact_trace(case, seconds), _simulated(CALIBRATED, case, seconds, "calibrated"))
    return simulated if case.fixed else (listing_trace(case, seconds), *simulated)


def listing_trace(case: Case, seconds: float = 0.5) -> Trace:
    """Run the thesis's program.

    Parameters
    ----------
    case : Case
    seconds : float
        Length of the run [s].

    Examples
    --------
    >>> trace = listing_trace(Case(1.0, 0.279, 3745.0), 0.05)
    >>> round(float(trace.torque.max()), 1)
    10.8
    """
    run = listing_run(case, seconds)
    time = STEP * np.arange(run.stuck.size, dtype=np.float64)
    return Trace(
        name="listing",
        time=time,
        torque=run.torque,
        displacement=run.interface_angle,
        sliding_speed=-run.relative_speed,
        clamp_speed=None,
        slips=time[1:][run.stuck[:-1] & ~run.stuck[1:]],
    )


def exact_trace(case: Case, seconds: float = 0.5) -> Trace:
    """Run the thesis's equations, solved exactly.

    Parameters
    ----------
    case : Case
    seconds : float
        Length of the run [s].

    Examples
    --------
    >>> trace = exact_trace(Case(7.5, 0.279, 3745.0, damping=0.05), 0.1)
    >>> trace.slips.size > 50
    True
    """
    return _simulated(THESIS, case, seconds, "equations, exact")


def _simulated(material: str, case: Case, seconds: float, name: str) -> Trace:
    run = motion(material, case, seconds, _RATE)
    time = np.arange(run.torque.size, dtype=np.float64) / _RATE
    if material == THESIS:
        slips = time[1:][run.stuck[:-1] & ~run.stuck[1:]]
    else:
        slips = motion_slips(run).times
    return Trace(
        name=name,
        time=time,
        torque=run.torque,
        displacement=run.interface_angle,
        sliding_speed=run.sliding_speed,
        clamp_speed=run.clamp_speed,
        slips=slips,
    )
