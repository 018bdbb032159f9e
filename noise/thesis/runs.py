"""Runs of the three models at a condition, reduced to the numbers that the thesis reports.

Slips and stick-slip are those that the torque shows, of all three models (`sim.analysis.slips`):
the calibrated contact never sticks truly, and of true stick the count is that of its ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache

import numpy as np

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from noise.base.remarks import constant_remark
from noise.thesis.listing import STEP, ListingRun, run_listing
from noise.thesis.repetition import repetition_rate
from sim.analysis.critical_damping import with_damping
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import Slips, find_slips, motion_slips
from sim.motion import Motion, simulate_motion
from sim.rig_effects import constant_version
from sim.run import simulate
from sim.shaft import ConstantSpeed

THESIS, CALIBRATED = "fluorocarbon-thesis", "fluorocarbon"
"""Materials of the columns `exact` and `calibrated`."""

LONG, SHORT = 2214.0, 3745.0
"""Support stiffness with beams of 12.3 and 9.2 cm (Table 3.2) [Nm/rad]."""

RATE = 30e3
"""Of the output [Hz], that of the rig's data acquisition."""

_LINES = (20.0, 8e3)
"""Where lines of the torque are sought [Hz]."""

_NEAR = 8.0
"""How far a peak may lie from a harmonic of the mean slip frequency [Hz]."""

_SECONDS = {THESIS: 4.0}
_OTHER_SECONDS = 1.5
"""Length of a run, of which the last three quarters are looked at [s]. Slips of the thesis's model
can be chaotic, so that their mean rate needs many; it is cheap to run."""


@dataclass(frozen=True)
class Case:
    """One operating condition.

    Parameters
    ----------
    speed : float
        [rad/s]
    interference_mm : float
        [mm]
    support_stiffness : float
        [Nm/rad]
    damping : float, optional
        c_E of the thesis's models, where it is not that of Table 5.5 [Nm s/rad].
    """

    speed: float
    interference_mm: float = 0.279
    support_stiffness: float = LONG
    damping: float | None = None

    @property
    def interference(self) -> float:
        """Of the fit [m]."""
        return 1e-3 * self.interference_mm

    @property
    def fixed(self) -> bool:
        """Whether the clamp is bolted down."""
        return self.support_stiffness == FIXED

    def at(self, speed: float) -> Case:
        """Return the case at another speed [rad/s]."""
        return replace(self, speed=speed)

    def place(self) -> str:
        """Interference and support as the table names them.

        Examples
        --------
        >>> Case(1.0, 0.381, FIXED).place()
        '0.381 mm, fixed clamp'
        """
        support = "fixed clamp" if self.fixed else f"{self.support_stiffness:g} Nm/rad"
        damped = "" if self.damping is None else f", c_E {self.damping:g}"
        return f"{self.interference_mm:g} mm, {support}{damped}"

    def __str__(self) -> str:
        return f"{self.place()}, {self.speed:g} rad/s"


def both(found: Callable[[str, Case], float], case: Case) -> dict[str, float]:
    """Compute a number of a case with the thesis's equations and with the calibrated material.

    Examples
    --------
    >>> both(lambda material, case: float(len(material)), Case(1.0))
    {'exact': 19.0, 'calibrated': 12.0}
    """
    return {"exact": found(THESIS, case), "calibrated": found(CALIBRATED, case)}


@cache
def rig_of(material: str) -> Rig:
    """Return the bench with a bushing of a material, its constant version."""
    return constant_version(load_material_rig(material))


def constant_note() -> str:
    """Say of what version of the shipped materials the numbers are.

    Examples
    --------
    >>> constant_note()
    'numbers of the calibrated materials are of the constant version, without ...'
    """
    materials = map(load_material_rig, material_names())
    return constant_remark(materials, "numbers of the calibrated materials")


@lru_cache(maxsize=4)
def motion(material: str, case: Case, seconds: float | None = None, rate: float = RATE) -> Motion:
    """Simulate a case from rest; another damping is for the thesis's material alone.

    Parameters
    ----------
    material : str
    case : Case
    seconds : float, optional
        Length of the run [s]; by default what mean slip rates need.
    rate : float
        Of the output [Hz].
    """
    rig = rig_of(material)
    if case.damping is not None and material == THESIS:
        rig = with_damping(rig, case.damping)
    return simulate_motion(
        rig,
        ConstantSpeed(case.speed),
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        seconds=seconds or _SECONDS.get(material, _OTHER_SECONDS),
        rate=rate,
    )


def _settled(run: Motion) -> Motion:
    return run.since(run.torque.size // 4)


def oscillation(material: str, case: Case) -> float:
    """Return the standard deviation of the torque over its mean [-], once the run has settled."""
    torque = _settled(motion(material, case)).torque
    return float(torque.std() / abs(torque.mean()))


def mean_torque(material: str, case: Case) -> float:
    """Mean torque [Nm]."""
    return float(_settled(motion(material, case)).torque.mean())


def torque_swing(material: str, case: Case) -> float:
    """Largest less smallest torque [Nm], once the run has settled.

    The thesis compares amplitudes by "analyses of the torque time traces" (5.2.1). A root mean
    square is not read from a trace: of one amplitude, it follows the waveform, which the support
    changes.
    """
    return float(np.ptp(_settled(motion(material, case)).torque))


def sudden_share(material: str, case: Case) -> float:
    """Share of the torque's falls that is sudden, once it has settled; 0 where it is steady."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return 0.0
    return _slips(material, case).sudden_share


def _slips(material: str, case: Case) -> Slips:
    return motion_slips(_settled(motion(material, case)))


def peak_speed(material: str, case: Case) -> float:
    """Largest sliding speed of a run from rest [rad/s]."""
    return float(motion(material, case).sliding_speed.max())


def strongest_line(material: str, case: Case) -> float:
    """Frequency of the strongest line of the torque [Hz]; NaN where there is none."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return math.nan
    torque = _settled(motion(material, case)).torque
    lines = find_lines(autospectrum(torque, RATE), low=_LINES[0], high=_LINES[1])
    return float(lines.frequency[0]) if lines.frequency.size else math.nan


def strongest_share(material: str, case: Case) -> float:
    """Share of the torque's power that lies in its strongest line."""
    torque = _settled(motion(material, case)).torque
    lines = find_lines(autospectrum(torque, RATE), low=_LINES[0], high=_LINES[1])
    return lines.strongest_share


def acceleration(material: str, case: Case) -> float:
    """Root mean square of the beam's acceleration [m/s^2]."""
    run = simulate(
        rig_of(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
    )  # fmt: skip
    return float(np.std(run.recording["acceleration"]))


def peak_pressure(material: str, case: Case) -> float:
    """Largest sound pressure [Pa]."""
    run = simulate(
        rig_of(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
    )  # fmt: skip
    return float(np.abs(run.pressure).max())


def slip_frequency(material: str, case: Case) -> float:
    """Slips a second [Hz]; NaN where nothing slips."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return math.nan
    return _slips(material, case).rate


def slip_pattern(material: str, case: Case) -> float:
    """After how many slips they repeat [-], 2 for a doubled period; NaN where they do not."""
    return float(_slips(material, case).pattern) or math.nan


def cycle_frequency(material: str, case: Case) -> float:
    """Slips a second, or periods of the torque where nothing slips [Hz]; NaN where it is steady."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return math.nan
    run = _settled(motion(material, case))
    return repetition_rate(motion_slips(run), run.torque, run.rate)


def third_over_second(material: str, case: Case) -> float:
    """Amplitude of the third harmonic of the slip frequency over that of the second [-]."""
    slips = slip_frequency(material, case)
    if math.isnan(slips):
        return math.nan
    found = autospectrum(_settled(motion(material, case)).torque, RATE)
    second, third = (
        float(found.density[np.abs(found.frequency - k * slips) < _NEAR].max()) for k in (2, 3)
    )
    return math.sqrt(third / second)


def listing_run(case: Case, seconds: float = _SECONDS[THESIS]) -> ListingRun:
    """Run the thesis's listing; the clamp must not be fixed, which it cannot compute.

    Parameters
    ----------
    case : Case
    seconds : float
        Length of the run [s].
    """
    fit = rig_of(THESIS).fit(case.interference)
    damping = fit.damping[case.support_stiffness] if case.damping is None else case.damping
    return run_listing(
        case.speed,
        support_stiffness=case.support_stiffness,
        damping=damping,
        elastomer_stiffness=fit.elastomer_stiffness,
        critical_torque=fit.critical_torque,
        kinetic_torque=fit.kinetic_torque,
        seconds=seconds,
    )


def listing_slip_frequency(case: Case) -> float:
    """Slips a second of the listing [Hz]; NaN where nothing slips, and for a fixed clamp."""
    if case.fixed:
        return math.nan
    return _listing_slips(case, listing_run(case).torque, 0.25).rate


def listing_sudden_share(case: Case, seconds: float = _SECONDS[THESIS]) -> float:
    """Share of the falls of the listing's torque that is sudden, in the last half of a run."""
    torque = listing_run(case, seconds).torque
    last = torque[torque.size // 2 :]
    if last.std() <= LEAST_OSCILLATION * abs(last.mean()):
        return 0.0
    return _listing_slips(case, torque, 0.5).sudden_share


def _listing_slips(
    case: Case, torque: np.ndarray[tuple[int], np.dtype[np.float64]], settling: float
) -> Slips:
    rig = rig_of(THESIS)
    stiffness = rig.fit(case.interference).elastomer_stiffness
    return find_slips(
        torque[round(settling * torque.size) :] / stiffness, case.speed, 1.0 / STEP,
        own_period=2.0 * math.pi * math.sqrt(rig.elastomer_inertia / stiffness),
    )  # fmt: skip


def listing_peak_speed(case: Case) -> float:
    """Largest sliding speed of a run of the listing [rad/s]."""
    return float(-listing_run(case).relative_speed.min())
