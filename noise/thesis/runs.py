"""Runs of the three models at a condition, reduced to the numbers that the thesis reports.

Slips and stick-slip are those that the torque shows, of all three models (`sim.analysis.slips`):
the calibrated contact never sticks truly, and of true stick the count is that of its ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from features.kernels.lines import Lines, find_lines
from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from noise.base.remarks import constant_remark
from noise.thesis.listing import STEP, ListingRun, run_listing
from noise.thesis.repetition import repetition_rate
from sim.analysis.critical_damping import critical_damping, largest_sticking, with_damping
from sim.analysis.critical_speeds import SPEEDS, CriticalSpeeds, critical_speeds
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import LEAST_SUDDEN, Slips, find_slips, motion_slips
from sim.bushing import lumped_bushing
from sim.motion import Motion, simulate_motion
from sim.rig_effects import constant_version
from sim.run import Run, simulate
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

_HIGHEST_DAMPING, _DAMPING_TOLERANCE = 0.3, 1e-5
"""Where searches for the damping that ends stick-slip start, and how well they end [Nm s/rad]."""

_SEARCHED = 1.0
"""Length of a run of a search [s]."""


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

    def __str__(self) -> str:
        support = "fixed clamp" if self.fixed else f"{self.support_stiffness:g} Nm/rad"
        damped = "" if self.damping is None else f", c_E {self.damping:g}"
        return f"{self.interference_mm:g} mm, {support}{damped}, {self.speed:g} rad/s"


@cache
def rig_of(material: str) -> Rig:
    """Return the bench with a bushing of a material, its constant version."""
    return constant_version(load_material_rig(material))


def constant_note() -> str:
    """Say of what version of the shipped materials the numbers are.

    Examples
    --------
    >>> constant_note()
    'numbers of the calibrated materials are computed without critical_torque_scatter, which ...'
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
    return simulate_motion(
        _damped(material, case),
        ConstantSpeed(case.speed),
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        seconds=seconds or _SECONDS.get(material, _OTHER_SECONDS),
        rate=rate,
    )


def _damped(material: str, case: Case) -> Rig:
    if case.damping is None or material != THESIS:
        return rig_of(material)
    return with_damping(rig_of(material), case.damping)


def _settled(run: Motion) -> Motion:
    return run.part(run.torque.size // 4)


def oscillation(material: str, case: Case) -> float:
    """Return the standard deviation of the torque over its mean [-], once the run has settled."""
    torque = _settled(motion(material, case)).torque
    return float(torque.std() / abs(torque.mean()))


def _mean_torque(material: str, case: Case) -> float:
    """Mean torque [Nm]."""
    return float(_settled(motion(material, case)).torque.mean())


def _torque_swing(material: str, case: Case) -> float:
    """Largest less smallest torque [Nm], once the run has settled.

    The thesis compares amplitudes by "analyses of the torque time traces" (5.2.1). A root mean
    square is not read from a trace: of one amplitude, it follows the waveform, which the support
    changes.
    """
    return float(np.ptp(_settled(motion(material, case)).torque))


def _sudden_share(material: str, case: Case) -> float:
    """Share of the torque's falls that is sudden, once it has settled; 0 where it is steady."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return 0.0
    return _slips(material, case).sudden_share


def _slips(material: str, case: Case) -> Slips:
    return motion_slips(_settled(motion(material, case)))


def _lines(material: str, case: Case) -> Lines | None:
    """Lines of the torque, where it oscillates."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return None
    torque = _settled(motion(material, case)).torque
    return find_lines(autospectrum(torque, RATE), low=_LINES[0], high=_LINES[1])


def _strongest_line(material: str, case: Case) -> float:
    """Frequency of the strongest line of the torque [Hz]; NaN where there is none."""
    lines = _lines(material, case)
    return math.nan if lines is None or not lines.frequency.size else float(lines.frequency[0])


def _strongest_share(material: str, case: Case) -> float:
    """Share of the torque's power that lies in its strongest line; NaN where it is steady."""
    lines = _lines(material, case)
    return math.nan if lines is None else lines.strongest_share


def _recorded(material: str, case: Case) -> Run:
    return simulate(
        rig_of(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
    )  # fmt: skip


def _acceleration(material: str, case: Case) -> float:
    """Root mean square of the beam's acceleration [m/s^2]."""
    return float(np.std(_recorded(material, case).recording["acceleration"]))


def _peak_pressure(material: str, case: Case) -> float:
    """Largest sound pressure [Pa]."""
    return float(np.abs(_recorded(material, case).pressure).max())


def _slip_frequency(material: str, case: Case) -> float:
    """Slips a second [Hz]; NaN where nothing slips."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return math.nan
    return _slips(material, case).rate


def _cycle_frequency(material: str, case: Case) -> float:
    """Slips a second, or periods of the torque where nothing slips [Hz]; NaN where it is steady."""
    if oscillation(material, case) <= LEAST_OSCILLATION:
        return math.nan
    run = _settled(motion(material, case))
    return repetition_rate(motion_slips(run), run.torque, run.rate)


def _third_over_second(material: str, case: Case) -> float:
    """Amplitude of the third harmonic of the slip frequency over that of the second [-]."""
    slips = _slip_frequency(material, case)
    if math.isnan(slips):
        return math.nan
    found = autospectrum(_settled(motion(material, case)).torque, RATE)
    second, third = (
        float(found.density[np.abs(found.frequency - k * slips) < _NEAR].max()) for k in (2, 3)
    )
    return math.sqrt(third / second)


def _first_peak_speed(material: str, case: Case) -> float:
    """Largest sliding speed of the first slip (Figure 6.7) [rad/s]."""
    run = motion(material, case)
    return _first_peak(run.stuck, run.sliding_speed)


def _first_peak(stuck: NDArray[np.bool_], sliding: NDArray[np.float64]) -> float:
    start = int(stuck.argmin())
    length = int(stuck[start:].argmax()) or sliding.size
    return float(sliding[start : start + length].max())


@cache
def _speeds(material: str, case: Case) -> CriticalSpeeds:
    return critical_speeds(_damped(material, case), case.interference, case.support_stiffness)


def _quasi_harmonic_range(material: str, case: Case) -> float:
    """Range of speeds at which the torque oscillates and nothing slips [rad/s]."""
    found = _speeds(material, case)
    return found.v_crit2 - found.v_crit1


@cache
def _critical_damping(material: str, case: Case) -> float:
    """Damping that ends stick-slip [Nm s/rad]."""
    return critical_damping(
        rig_of(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
        highest=_HIGHEST_DAMPING, tolerance=_DAMPING_TOLERANCE, seconds=_SEARCHED,
    )  # fmt: skip


def _torsional_mode(material: str, case: Case, *, stuck: bool) -> float:
    """First torsional mode of the lumped model (5.2.2) [Hz]."""
    lumped = lumped_bushing(rig_of(material), case.interference, case.support_stiffness)
    return float(lumped.natural_frequencies(stuck=stuck)[0])


def _strongest_harmonic(material: str, case: Case) -> float:
    return _strongest_line(material, case) / _cycle_frequency(material, case)


QUANTITIES: dict[str, Callable[[str, Case], float]] = {
    "acceleration": _acceleration,
    "critical_damping": _critical_damping,
    "cycle_frequency": _cycle_frequency,
    "first_peak_speed": _first_peak_speed,
    "mean_torque": _mean_torque,
    "oscillation": oscillation,
    "peak_pressure": _peak_pressure,
    "peak_speed": lambda material, case: float(motion(material, case).sliding_speed.max()),
    "quasi_harmonic_range": _quasi_harmonic_range,
    "slip_frequency": _slip_frequency,
    "slip_pattern": lambda material, case: float(_slips(material, case).pattern) or math.nan,
    "strongest_harmonic": _strongest_harmonic,
    "strongest_line": _strongest_line,
    "strongest_share": _strongest_share,
    "sudden_share": _sudden_share,
    "third_over_second": _third_over_second,
    "torque_swing": _torque_swing,
    "torsional_mode_sliding": partial(_torsional_mode, stuck=False),
    "torsional_mode_stuck": partial(_torsional_mode, stuck=True),
    "v_crit1": lambda material, case: _speeds(material, case).v_crit1,
    "v_crit2": lambda material, case: _speeds(material, case).v_crit2,
}
"""Numbers of a material at a case, by the name that ``rows.csv`` gives them."""


# --- the same of the thesis's listing ------------------------------------------------------------


def _listing_run(case: Case, seconds: float = _SECONDS[THESIS]) -> ListingRun:
    """Run the thesis's listing; the clamp must not be fixed, which it cannot compute."""
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


def _listing_slip_frequency(case: Case) -> float:
    """Slips a second of the listing [Hz]; NaN where nothing slips."""
    return _listing_slips(case, _listing_run(case).torque, 0.25).rate


def _listing_sudden_share(case: Case, seconds: float = _SECONDS[THESIS]) -> float:
    """Share of the falls of the listing's torque that is sudden, in the last half of a run."""
    torque = _listing_run(case, seconds).torque
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


def _listing_first_peak(case: Case) -> float:
    run = _listing_run(case)
    return _first_peak(run.stuck, -run.relative_speed)


@cache
def _listing_damping(case: Case) -> float:
    def sticks(damping: float) -> bool:
        # Below any damping that matters; the listing takes none of zero.
        at = replace(case, damping=max(damping, 1e-9))
        return _listing_sudden_share(at, _SEARCHED) > LEAST_SUDDEN

    return largest_sticking(sticks, _HIGHEST_DAMPING, _DAMPING_TOLERANCE)


@cache
def _listing_v_crit1(case: Case) -> float:
    """Last speed at which the listing sticks and slips [rad/s]."""
    at_speeds = {speed: replace(case, speed=speed) for speed in SPEEDS}
    sticking = [
        speed
        for speed, at in at_speeds.items()
        if _listing_sudden_share(at, _SEARCHED) > LEAST_SUDDEN
    ]
    last = max(sticking, default=0.0)
    return math.inf if last == SPEEDS[-1] else last


LISTED: dict[str, Callable[[Case], float]] = {
    "critical_damping": _listing_damping,
    "first_peak_speed": _listing_first_peak,
    "peak_speed": lambda case: float(-_listing_run(case).relative_speed.min()),
    "slip_frequency": _listing_slip_frequency,
    "sudden_share": _listing_sudden_share,
    "v_crit1": _listing_v_crit1,
}
"""Numbers of `QUANTITIES` that the listing gives; it knows no fixed clamp."""
