"""Quantities that a rig is measured by, each as a function of the rig and of runs of it.

They have the names of the thesis's table. Critical speeds are where the sudden share, or the
oscillation, crosses its limit (`sim.analysis.regime`) for the last time on a grid of speeds,
interpolated between its points, so that a small change of a parameter shows.

They are read off a run from rest once it has settled, as off a torque record.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.rig import Rig, damping_at
from noise.thesis.repetition import repetition_rate
from sim.analysis.critical_speeds import falls_below, motion_from_rest
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import LEAST_SUDDEN, Slips, motion_slips

if TYPE_CHECKING:
    from noise.identification.table_fit import TableNumber

    Found = Callable[[Rig, TableNumber, Sequence["SettledRun"]], float]


_SECONDS = 0.8
_HIGHEST_LINE = 2500.0
"""Up to which the strongest line is sought [Hz]; assumed."""


@dataclass(frozen=True, eq=False)
class SettledRun:
    """The last half of a run.

    Parameters
    ----------
    slips : Slips
        Those that the torque shows.
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        [Hz]
    """

    slips: Slips
    torque: NDArray[np.float64]
    rate: float

    @property
    def oscillation(self) -> float:
        """Standard deviation of the torque over its mean [-]; infinite where that is zero."""
        deviation, mean = float(np.std(self.torque)), abs(self.mean_torque)
        return deviation / mean if mean > 0.0 else math.inf if deviation > 0.0 else 0.0

    @property
    def mean_torque(self) -> float:
        """Mean of the torque [Nm]."""
        return float(np.mean(self.torque))

    @property
    def repetition_rate(self) -> float:
        """Slips or periods a second [Hz]; NaN where nothing repeats."""
        if self.oscillation <= LEAST_OSCILLATION:
            return math.nan
        return repetition_rate(self.slips, self.torque, self.rate)

    @cached_property
    def _lines(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        torque = self.torque - self.mean_torque
        amplitude = np.asarray(np.abs(np.fft.rfft(torque * np.hanning(torque.size))))
        frequency = np.asarray(np.fft.rfftfreq(torque.size, 1.0 / self.rate))
        return frequency.astype(np.float64), amplitude.astype(np.float64)

    @property
    def strongest_line(self) -> float:
        """Frequency of the strongest line of the torque [Hz]."""
        frequency, amplitude = self._lines
        return float(frequency[np.argmax(amplitude[frequency < _HIGHEST_LINE])])

    def line_in(self, low: float, high: float) -> float:
        """Highest amplitude between two frequencies [Hz] over that of the strongest line [-]."""
        frequency, amplitude = self._lines
        strongest = max(float(amplitude[frequency < _HIGHEST_LINE].max()), 1e-12)
        return float(amplitude[(frequency >= low) & (frequency < high)].max()) / strongest


def settled_run(
    rig: Rig, interference: float, support_stiffness: float, speed: float
) -> SettledRun:
    """Run a rig from rest and keep the last half.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    speed : float
        Of the shaft [rad/s].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = settled_run(load_material_rig("fluorocarbon-thesis"), 0.279e-3, 2214.0, 1.0)
    >>> run.slips.sudden_share > 0.5, 100.0 < run.repetition_rate < 200.0
    (True, True)
    """
    motion = motion_from_rest(rig, speed, interference, support_stiffness, seconds=_SECONDS)
    last = motion.since(motion.torque.size // 2)
    return SettledRun(motion_slips(last), last.torque, motion.rate)


MOST = 3.0
"""No misfit of a single run counts more; assumed."""

_LINE_SHARE = 10.0 ** (-18.0 / 20.0)
"""Amplitude of a line that counts, over the strongest: `noise.noise_definition`."""

_RISES = 3.0 / 7.0
"""Half the spread of the slip rate's rises over their middle, "10 to 25 Hz" for a step (5.2.1)."""

_SLIP_BAND, _MIDDLE_BAND, _ELASTOMER_BAND = (120.0, 420.0), (420.0, 760.0), (850.0, 1150.0)


def _log_error(found: float, measured: float) -> float:
    if math.isnan(found):
        return MOST
    return math.log(found / measured) if found > 0.0 else -math.inf


def _above(value: float, limit: float) -> float:
    return min(MOST, max(0.0, math.log(1.2 * limit / max(value, 1e-5))))


def _below(value: float, limit: float) -> float:
    return min(MOST, max(0.0, math.log(1.2 * max(value, 1e-5) / limit)))


@dataclass(frozen=True)
class Quantity:
    """A quantity.

    Parameters
    ----------
    found : callable
        Of a rig, the number asked for, and the runs at its speeds: its value.
    misfit : callable
        Of found and measured value [-].
    """

    found: Found
    misfit: Callable[[float, float], float] = _log_error


def _v_crit2(rig: Rig, number: TableNumber, runs: Sequence[SettledRun]) -> float:  # noqa: ARG001
    return _last_crossing(number.speeds, [run.oscillation for run in runs], LEAST_OSCILLATION)


def _v_crit1(rig: Rig, number: TableNumber, runs: Sequence[SettledRun]) -> float:
    vibrating = [
        run.slips.sudden_share if run.oscillation > LEAST_OSCILLATION else 0.0 for run in runs
    ]
    return min(
        _v_crit2(rig, number, runs), _last_crossing(number.speeds, vibrating, LEAST_SUDDEN)
    )  # fmt: skip


def _last_crossing(speed: Sequence[float], values: list[float], limit: float) -> float:
    """Last speed with a value above the limit, on logarithmic scales."""
    above = [i for i, value in enumerate(values) if value > limit]
    if not above:
        return 0.8 * speed[0]
    last = above[-1]
    if last == len(values) - 1:
        return 1.1 * speed[-1]
    return falls_below(limit, speed[last], values[last], speed[last + 1], values[last + 1])


def _of_run(read: Callable[[SettledRun], float]) -> Found:
    return lambda _rig, _number, runs: read(runs[0])


def _of_fit(name: str) -> Quantity:
    def found(rig: Rig, number: TableNumber, _runs: Sequence[SettledRun]) -> float:
        return float(getattr(rig.fit(number.interference), name))

    return Quantity(found)


def _damping(rig: Rig, number: TableNumber, _runs: Sequence[SettledRun]) -> float:
    return damping_at(rig.fit(number.interference), number.support_stiffness)


def _effective(rig: Rig, number: TableNumber, _runs: Sequence[SettledRun]) -> float:
    k_e = rig.fit(number.interference).elastomer_stiffness
    return 1.0 / (1.0 / k_e + 1.0 / number.support_stiffness)


def _torque_spread(_rig: Rig, _number: TableNumber, runs: Sequence[SettledRun]) -> float:
    means = [run.mean_torque for run in runs]
    return max(means) / min(means)


def _slip_rate_rise(_rig: Rig, number: TableNumber, runs: Sequence[SettledRun]) -> float:
    rise = runs[-1].slips.rate - runs[0].slips.rate
    return rise / (number.speeds[-1] - number.speeds[0])


def _rise_misfit(found: float, measured: float) -> float:
    """Nil where a rise is within the spread of those that were measured."""
    if math.isnan(found):
        return MOST
    return min(MOST, max(0.0, abs(found / measured - 1.0) / _RISES - 1.0))


def _squawk(run: SettledRun) -> float:
    """How far a run is from slips that ring at the first torsional mode."""
    return (
        _above(run.oscillation, LEAST_OSCILLATION)
        + 0.5 * _above(run.line_in(*_SLIP_BAND), _LINE_SHARE)
        + 0.25 * _above(run.line_in(*_MIDDLE_BAND), 0.5 * _LINE_SHARE)
    )


def _squeal(run: SettledRun) -> float:
    low, high = _ELASTOMER_BAND
    return (
        _above(run.oscillation, LEAST_OSCILLATION)
        + 0.5 * _below(run.line_in(*_SLIP_BAND), 0.5 * _LINE_SHARE)
        + 0.5 * _below(run.line_in(*_MIDDLE_BAND), 0.5 * _LINE_SHARE)
        + (0.0 if low < run.strongest_line < high else 0.5)
    )


def _silence(run: SettledRun) -> float:
    return _below(run.oscillation, LEAST_OSCILLATION)


def _noise(distance: Callable[[SettledRun], float]) -> Quantity:
    return Quantity(_of_run(distance), lambda found, _measured: found)


QUANTITIES: Mapping[str, Quantity] = {
    "elastomer_stiffness": _of_fit("elastomer_stiffness"),
    "effective_stiffness": Quantity(_effective),
    "damping": Quantity(_damping),
    "critical_torque": _of_fit("critical_torque"),
    "kinetic_torque": _of_fit("kinetic_torque"),
    "mean_torque": Quantity(_of_run(lambda run: run.mean_torque)),
    "highest_torque": Quantity(_of_run(lambda run: float(run.torque.max()))),
    "slip_frequency": Quantity(_of_run(lambda run: run.repetition_rate)),
    "strongest_line": Quantity(_of_run(lambda run: run.strongest_line)),
    "v_crit1": Quantity(_v_crit1),
    "v_crit2": Quantity(_v_crit2),
    "sudden_share": Quantity(_of_run(lambda run: run.slips.sudden_share), _above),
    "mean_torque_spread": Quantity(_torque_spread, lambda found, most: max(0.0, found - most)),
    "slip_rate_rise": Quantity(_slip_rate_rise, _rise_misfit),
    "squawk": _noise(_squawk),
    "squeal": _noise(_squeal),
    "none": _noise(_silence),
}
"""By the item's name. A ``sudden_share`` is a lower limit, a ``mean_torque_spread`` (highest over
lowest mean) an upper one; ``squawk``, ``squeal`` and ``none`` say what is heard there."""
