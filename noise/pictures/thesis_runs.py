"""Runs that the thesis's pictures show, in its models, and what it measured of the fluorocarbon.

The measured curves are lost. What tables and text say of them is what can be drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED
from models.drawing import BLUE, GREEN, VERMILION
from models.rig_file import load_material_rig
from noise.pictures.figure import KINDS
from noise.pictures.run import oscillates
from noise.thesis.listing import STEP
from noise.thesis.repetition import repetition_rate
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    RATE,
    SHORT,
    THESIS,
    Case,
    listing_run,
    motion,
)
from sim.analysis.slips import motion_slips
from sim.run import simulate

FITS = (0.178, 0.279, 0.381)
"""Interference [mm]."""

MEAN_TORQUE = {0.178: 4.0, 0.279: 8.0, 0.381: 30.0}
"""Level that hardly varies from 1 to 13 rad/s, by fit [Nm]: 5.2.1, Appendices F and G."""

V_CRIT1 = {(0.279, LONG): 4.5, (0.279, SHORT): 2.6, (0.279, FIXED): 2.5}
"""Last speed with stick-slip, by fit [mm] and support [rad/s]: Table 5.1, where it has numbers."""

V_CRIT2 = {
    (0.178, LONG): 4.6,
    (0.178, SHORT): 5.9,
    (0.178, FIXED): 2.7,
    (0.279, LONG): 7.9,
    (0.279, SHORT): 12.5,
    (0.279, FIXED): 8.3,
}
"""Last speed with any oscillation, likewise [rad/s]: Table 5.2."""

FIRST_MODE = {LONG: 250.0, SHORT: 310.0}
"""First torsional mode, which the slip frequency never exceeds [Hz]: 5.2.2, Conclusion 3."""

LINES = {
    Case(1.0, 0.178, FIXED): (1250.0,),  # 5.2.1, over all speeds that vibrate
    Case(2.5, 0.178, FIXED): (1250.0,),
    Case(1.0, 0.279, FIXED): (620.0, 930.0),  # 5.1.1, harmonics of the slip frequency
    Case(10.0, 0.279, SHORT): (6570.0 / math.tau,),  # 5.2.3, 6570 rad/s, printed as Hz
}
"""Lines that it names [Hz]."""

COLOURS = {
    "listing": GREEN,
    "equations, exact": BLUE,
    "constant torque": BLUE,
    "calibrated": VERMILION,
}
MODELS = {"constant torque": THESIS, "calibrated": CALIBRATED}
SUPPORTS = (LONG, SHORT, FIXED)
SWEPT = tuple(float(speed) for speed in np.arange(0.5, 13.01, 0.5))
"""Speeds of the sweeps [rad/s]."""

SHOWN = 0.08
"""How much of a settled run is shown over time [s]."""

_FINE = 100e3
"""Rate of the exact and the calibrated traces [Hz]: a slip lasts half a millisecond."""

TORQUE, DISPLACEMENT = "Torque [Nm]", "Displacement [mrad]"
SLIDING, CLAMP = "Sliding speed [rad/s]", "Acceleration [rad/s²]"


@dataclass(frozen=True, eq=False)
class Trace:
    """A run from rest of one model.

    Parameters
    ----------
    name : str
    time : ndarray, shape (n,)
        [s]
    values : mapping of str to ndarray, shape (n,)
        By the words of their axis, which name the unit.
    slips : ndarray, shape (n_slips,)
        When slips begin [s]: where stick ends, or, in a contact that creeps, where the torque
        starts to drop.
    """

    name: str
    time: NDArray[np.float64]
    values: Mapping[str, NDArray[np.float64]]
    slips: NDArray[np.float64]

    def during(self, start: float, end: float) -> Trace:
        """Return the part between two times [s], time counted from `start` on."""
        part = slice(*np.searchsorted(self.time, (start, end)))
        return Trace(
            self.name,
            self.time[part] - start,
            {name: values[part] for name, values in self.values.items()},
            self.slips[(self.slips >= start) & (self.slips < end)] - start,
        )

    def settled(self, seconds: float) -> Trace:
        """Return so many seconds [s] from the middle of the run on."""
        start = 0.5 * float(self.time[-1])
        return self.during(start, start + seconds)

    def about_a_slip(self, seconds: float) -> Trace:
        """Return so many seconds [s] of the settled run, which begin shortly before a slip."""
        middle = 0.5 * float(self.time[-1])
        late = self.slips[self.slips >= middle]
        start = (float(late[0]) if late.size else middle) - 0.1 * seconds
        return self.during(start, start + seconds)


@cache
def traces(case: Case, seconds: float = 0.5) -> tuple[Trace, ...]:
    """Run a case for some time [s] in all three models, in two where the clamp is fixed.

    Examples
    --------
    >>> [trace.name for trace in traces(Case(1.0), 0.1)]
    ['listing', 'equations, exact', 'calibrated']
    """
    simulated = (exact_trace(case, seconds), _trace(CALIBRATED, case, seconds, "calibrated"))
    return simulated if case.fixed else (listing_trace(case, seconds), *simulated)


def listing_trace(case: Case, seconds: float = 0.5) -> Trace:
    """Run the thesis's program for some time [s]; it does not write the clamp's speed."""
    run = listing_run(case, seconds)
    time = STEP * np.arange(run.stuck.size, dtype=np.float64)
    values = {
        TORQUE: run.torque,
        DISPLACEMENT: 1e3 * run.interface_angle,
        SLIDING: -run.relative_speed,
    }
    return Trace("listing", time, values, time[1:][run.stuck[:-1] & ~run.stuck[1:]])


def exact_trace(case: Case, seconds: float = 0.5) -> Trace:
    """Run the thesis's equations, solved exactly, for some time [s]."""
    return _trace(THESIS, case, seconds, "equations, exact")


def _trace(material: str, case: Case, seconds: float, name: str) -> Trace:
    run = motion(material, case, seconds, _FINE)
    time = np.arange(run.torque.size, dtype=np.float64) / _FINE
    ends = time[1:][run.stuck[:-1] & ~run.stuck[1:]]
    values = {
        TORQUE: run.torque,
        DISPLACEMENT: 1e3 * run.interface_angle,
        SLIDING: run.sliding_speed,
        CLAMP: np.gradient(run.clamp_speed, 1.0 / _FINE),
    }
    return Trace(name, time, values, ends if material == THESIS else motion_slips(run).times)


@lru_cache(maxsize=4)
def recorded_trace(material: str, case: Case) -> Trace:
    """Record a run of a material as it is shipped."""
    recording = simulate(
        load_material_rig(material),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
    ).recording
    time = np.arange(recording.samples.shape[1], dtype=np.float64) / recording.rate
    return Trace(material, time, {name: recording[name] for name in KINDS}, np.empty(0))


class SweptTorque(NamedTuple):
    """Torques over speed, arrays of the length of `speed`.

    Parameters
    ----------
    speed : ndarray, shape (n,)
        [rad/s]
    mean, low, high : ndarray, shape (n,)
        Mean torque, and the lowest and highest [Nm].
    cycles : ndarray, shape (n,)
        Slips, or periods of the torque, a second [Hz]; NaN where it does not oscillate.
    """

    speed: NDArray[np.float64]
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    cycles: NDArray[np.float64]


@cache
def swept_torque(
    material: str, fit: float, support: float, speeds: tuple[float, ...] = SWEPT
) -> SweptTorque:
    """Run a material at speeds [rad/s], at a fit [mm] on a support [Nm/rad], once it has settled.

    Examples
    --------
    >>> found = swept_torque(THESIS, 0.279, SHORT, (1.0, 2.5))
    >>> found.cycles.round(-1), found.mean.round(1)
    (array([150., 310.]), array([8.7, 8.6]))
    """
    found = []
    for speed in speeds:
        run = motion(material, Case(speed, fit, support), 1.5).since(round(0.5 * RATE))
        torque = run.torque
        slips = motion_slips(run) if oscillates(torque) else None
        cycles = math.nan if slips is None else repetition_rate(slips, torque, RATE)
        found.append((speed, torque.mean(), torque.min(), torque.max(), cycles))
    return SweptTorque(*np.array(found).T)
