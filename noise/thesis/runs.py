"""Runs of two models at a condition, reduced to the numbers that the thesis reports.

Slips and stick-slip are those that the torque shows, of both models (`sim.analysis.regime`): the
calibrated contact never sticks truly, and of true stick the count is that of its ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache, partial

import numpy as np

from features.kernels.harmonics import analyse_harmonics
from features.kernels.lines import Lines, find_lines
from features.kernels.spectra import autospectrum
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from models.structure.beams import beam_structure
from sim.analysis.critical_speeds import (
    CriticalSpeeds,
    critical_damping,
    critical_speeds,
    with_damping,
)
from sim.analysis.regime import LEAST_OSCILLATION, motion_slips
from sim.bushing import lumped_bushing
from sim.effects import constant_version, irregular_effects
from sim.motion import Motion, simulate_motion
from sim.run import Run, simulate
from sim.shaft import ConstantSpeed

THESIS, CALIBRATED = "fluorocarbon-thesis", "fluorocarbon"
"""Materials of the columns `exact` and `calibrated`."""

LONG = 2214.0
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


@cache
def rig_of(material: str) -> Rig:
    """Return the bench with a bushing of a material, its constant version."""
    return constant_version(load_material_rig(material))


def constant_note() -> str:
    """Return a remark on the version of the shipped materials.

    Examples
    --------
    >>> constant_note()
    'numbers of the calibrated materials are computed without critical_torque_scatter, which ...'
    """
    rigs = map(load_material_rig, material_names())
    left_out = dict.fromkeys(spec.name for rig in rigs for spec in irregular_effects(rig))
    names = " and ".join(left_out)
    return (
        f"numbers of the calibrated materials are computed without {names}, which varies slips at "
        "random"
    )


@lru_cache(maxsize=4)
def motion(material: str, case: Case) -> Motion:
    """Simulate a case from rest; another damping is for the thesis's material alone."""
    return simulate_motion(
        _damped(material, case),
        ConstantSpeed(case.speed),
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        seconds=_SECONDS.get(material, _OTHER_SECONDS),
        rate=RATE,
    )


def _damped(material: str, case: Case) -> Rig:
    if case.damping is None or material != THESIS:
        return rig_of(material)
    return with_damping(rig_of(material), case.damping)


Quantity = Callable[[str, Case], float]
"""Number of a material at a case, in the unit of its row."""


def _of_motion(measure: Callable[[Motion], float], *, steady: float | None = None) -> Quantity:
    """Return a quantity of the settled motion, which is `steady` where the torque is."""

    def quantity(material: str, case: Case) -> float:
        run = motion(material, case)
        run = run.part(run.torque.size // 4)
        if steady is not None and _oscillation(run) <= LEAST_OSCILLATION:
            return steady
        return float(measure(run))

    return quantity


def _oscillation(run: Motion) -> float:
    """Return the standard deviation of the torque over its mean [-]."""
    return float(run.torque.std() / abs(run.torque.mean()))


def _lines(run: Motion) -> Lines:
    return find_lines(autospectrum(run.torque, RATE), low=_LINES[0], high=_LINES[1])


def _strongest_line(run: Motion) -> float:
    """Return the frequency of the strongest line of the torque [Hz]; NaN where there is none."""
    frequency = _lines(run).frequency
    return float(frequency[0]) if frequency.size else math.nan


def _cycle_frequency(run: Motion) -> float:
    """Return slips a second, or periods of the torque where nothing slips [Hz]."""
    slips = motion_slips(run).rate
    return analyse_harmonics(run.torque, run.rate).fundamental if math.isnan(slips) else slips


def _third_over_second(run: Motion) -> float:
    """Return the third harmonic's amplitude of the slip frequency over the second's [-]."""
    slips = motion_slips(run).rate
    if math.isnan(slips):
        return math.nan
    spectrum = autospectrum(run.torque, RATE)
    second, third = (
        float(spectrum.density[np.abs(spectrum.frequency - k * slips) < _NEAR].max())
        for k in (2, 3)
    )
    return math.sqrt(third / second)


def _recorded(measure: Callable[[Run], float]) -> Quantity:
    """Return a quantity of a recording."""

    def quantity(material: str, case: Case) -> float:
        run = simulate(
            rig_of(material), case.speed,
            interference=case.interference, support_stiffness=case.support_stiffness,
        )  # fmt: skip
        return float(measure(run))

    return quantity


def _first_peak_speed(material: str, case: Case) -> float:
    """Return the largest sliding speed of the first slip (Figure 6.7) [rad/s]."""
    run = motion(material, case)
    start = int(run.stuck.argmin())
    length = int(run.stuck[start:].argmax()) or run.stuck.size
    return float(run.sliding_speed[start : start + length].max())


@cache
def _speeds(material: str, case: Case) -> CriticalSpeeds:
    return critical_speeds(_damped(material, case), case.interference, case.support_stiffness)


@cache
def _critical_damping(material: str, case: Case) -> float:
    """Return the damping that ends stick-slip [Nm s/rad]."""
    return critical_damping(
        rig_of(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
    )  # fmt: skip


def _torsional_mode(material: str, case: Case, *, stuck: bool) -> float:
    """Return the first torsional mode of the lumped model (5.2.2) [Hz]."""
    lumped = lumped_bushing(rig_of(material), case.interference, case.support_stiffness)
    return float(lumped.natural_frequencies(stuck=stuck)[0])


def _effective_stiffness(material: str, case: Case) -> float:
    """Return the stiffness of a bushing and its support in series (5.2) [Nm/rad]."""
    stiffness = rig_of(material).fit(case.interference).elastomer_stiffness
    return 1.0 / (1.0 / case.support_stiffness + 1.0 / stiffness)


_BEAM_MODES = (250, 310, 900, 1375, 4500, 6000)
"""Measured with beams (5.2.2) [Hz]."""


def _beam_mode(material: str, case: Case, *, measured: float) -> float:
    """Return the mode of clamp and beams that is nearest to a measured one [Hz]."""
    rig = rig_of(material)
    modes = beam_structure(
        rig.beams, case.support_stiffness, rig.clamp_inertia, 0.01, 1.3 * measured
    ).frequencies
    return float(modes[np.abs(np.log(modes / measured)).argmin()])


QUANTITIES: dict[str, Quantity] = {
    "acceleration": _recorded(lambda run: float(np.std(run.recording["acceleration"]))),
    "critical_damping": _critical_damping,
    **{f"beam_mode_{mode}": partial(_beam_mode, measured=mode) for mode in _BEAM_MODES},
    "cycle_frequency": _of_motion(_cycle_frequency, steady=math.nan),
    "effective_stiffness": _effective_stiffness,
    "first_peak_speed": _first_peak_speed,
    "mean_torque": _of_motion(lambda run: run.torque.mean()),
    "oscillation": _of_motion(_oscillation),
    "peak_pressure": _recorded(lambda run: np.abs(run.pressure).max()),
    "peak_speed": lambda material, case: float(motion(material, case).sliding_speed.max()),
    "quasi_harmonic_range": lambda *at: _speeds(*at).v_crit2 - _speeds(*at).v_crit1,
    "slip_frequency": _of_motion(lambda run: motion_slips(run).rate, steady=math.nan),
    "slip_pattern": _of_motion(lambda run: motion_slips(run).pattern or math.nan),
    "strongest_harmonic": _of_motion(
        lambda run: _strongest_line(run) / _cycle_frequency(run), steady=math.nan
    ),
    "strongest_line": _of_motion(_strongest_line, steady=math.nan),
    "strongest_share": _of_motion(lambda run: _lines(run).strongest_share, steady=math.nan),
    "sudden_share": _of_motion(lambda run: motion_slips(run).sudden_share, steady=0.0),
    "third_over_second": _of_motion(_third_over_second, steady=math.nan),
    # The thesis reads amplitudes from time traces (5.2.1). A root mean square is not read from
    # one: of one amplitude it follows the waveform, which the support changes.
    "torque_swing": _of_motion(lambda run: np.ptp(run.torque)),
    "torsional_mode_sliding": partial(_torsional_mode, stuck=False),
    "torsional_mode_stuck": partial(_torsional_mode, stuck=True),
    "v_crit1": lambda material, case: _speeds(material, case).v_crit1,
    "v_crit2": lambda material, case: _speeds(material, case).v_crit2,
}
"""Numbers of a material at a case, by the name that ``rows.csv`` gives them."""
