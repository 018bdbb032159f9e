"""Calibration of the shipped fluorocarbon: ``python -m noise.training.calibrate``.

The targets are numbers of the thesis, and the unknowns are parameters of contact and damping
without a source; both are in ``calibrate.toml``. The misfit of a target is mostly log(simulated /
measured), times its weight; the cost is the sum of the root mean squares of groups of misfits.
Critical speeds are the last crossings of the limits of the sudden share or of the oscillation
(`sim.analysis.regime`), interpolated on a grid of speeds.

Without options the shipped material is evaluated; ``--rounds N`` searches. An evaluation takes 134
runs, about a second on one core, and a round takes 36 to 90 evaluations.

The contact has memory (`sim.friction.contact_with_memory`). Its torque at 0.279 mm and 5 rad/s is
fixed at the 8 Nm of Appendix F. Torques at 0.178 mm are half those at 0.279 mm, like the mean
torques (5.2.1); those at 0.381 mm are unknown, and the drop there follows from one figure.
Stiffness, damping and renewal of the contact are proportional to its torques. The damping of the
bushing is unknown too: with the value printed for 0.279 mm there is no squawk at 2214 Nm/rad and
7.5 rad/s, and no stick in the simulation of the thesis.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from models.condition import FIXED
from models.errors import BushingNoiseError, ParameterError
from models.rig import LawSpec, Rig
from models.rig_file import load_material_rig, rig_text
from noise.base import packaged_toml
from noise.base.files import atomic
from noise.diagnosis.fit.fit import pattern_search
from noise.thesis.runs import LONG, SHORT
from sim.analysis.critical_speeds import falls_below, motion_from_rest
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import LEAST_SUDDEN, motion_slips

_DATA = packaged_toml("noise.training", "calibrate.toml")
UNKNOWNS: Mapping[str, Mapping[str, Any]] = _DATA["unknowns"]
_SUPPORTS = {"long": LONG, "short": SHORT, "fixed": FIXED}

_COARSE = np.geomspace(1.6, 14.4, 12)
_THIN_GRID = np.geomspace(1.0, 9.0, 10)
_FINE = {"v_crit1": 0.25, "v_crit2": 0.5}
"""Spacing of speeds near a measured critical speed [rad/s]."""

_WINDOW = 0.8, 1.35
"""Range of the fine speeds, relative to the measured critical speed."""

MEAN_TORQUE = 8.0
"""Mean torque at 0.279 mm and 5 rad/s [Nm], Appendix F."""

_THIN = 0.5
"""Ratio of torques at 0.178 mm to those at 0.279 mm."""

_SPEED = 5.0
_EXPONENT = 2.0
"""Exponent of the weakening. With 1, V_crit2 at 3745 Nm/rad was 15 % low at best."""

_STEP = 0.05
"""Initial step of the logarithms."""

_SECONDS = 0.8
_HIGHEST_LINE = 2500.0
"""Maximum frequency of the strongest line [Hz]; assumed."""

_UNUSABLE = 100.0
"""Cost of values that give no rig."""

_MOST = 3.0
"""Maximum misfit of a single run; assumed."""

_LINE_SHARE = 10.0 ** (-18.0 / 20.0)
"""Minimum amplitude of a line, relative to the strongest: `noise.noise_definition`."""

_RISES = 3.0 / 7.0
"""Relative half-range of the rise of the slip rate, "10 to 25 Hz" per step (5.2.1)."""

_SLIP_BAND, _MIDDLE_BAND, _ELASTOMER_BAND = (120.0, 420.0), (420.0, 760.0), (850.0, 1150.0)


@dataclass(frozen=True)
class Target:
    """Measured target of the calibration.

    Parameters
    ----------
    item : str
        Name in ``calibrate.toml``. A ``sudden_share`` is a lower limit, a ``mean_torque_spread``
        (ratio of highest to lowest mean) an upper one; ``squawk``, ``squeal`` and ``none`` are
        noises.
    value : float
        Measured value [unit of the item].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    speeds : tuple of float
        Simulated speeds [rad/s].
    weight : float
        Weight of the misfit [-].
    group : str
        Targets of a group count by the root mean square of their misfits.
    """

    item: str
    value: float
    interference: float
    support_stiffness: float
    speeds: tuple[float, ...]
    weight: float
    group: str = ""

    @property
    def runs(self) -> list[tuple[float, float, float]]:
        """Speed [rad/s], interference [m] and support stiffness [Nm/rad] of each run."""
        return [(speed, self.interference, self.support_stiffness) for speed in self.speeds]

    def misfit(self, simulated: float) -> float:
        """Return the misfit of a simulated value, in the unit of the item [-]."""
        if self.item in _NOISES:
            return simulated
        if self.item == "sudden_share":
            return _above(simulated, self.value)
        if self.item == "mean_torque_spread":
            return max(0.0, simulated - self.value)
        if math.isnan(simulated):
            return _MOST
        if self.item == "slip_rate_rise":  # zero within the measured range
            return min(_MOST, max(0.0, abs(simulated / self.value - 1.0) / _RISES - 1.0))
        return math.log(simulated / self.value) if simulated > 0.0 else -math.inf

    def __str__(self) -> str:
        fixed = self.support_stiffness == FIXED
        support = "fixed" if fixed else f"{self.support_stiffness:.0f} Nm/rad"
        return f"{self.item} at {1e3 * self.interference:.3f} mm, {support}"


def _targets(table: str) -> tuple[Target, ...]:
    rows = [dict(zip(_DATA[table]["columns"], row, strict=True)) for row in _DATA[table]["rows"]]
    return tuple(
        Target(
            row["item"],
            LEAST_SUDDEN if row["value"] == "LEAST_SUDDEN" else row["value"],
            1e-3 * row["interference_mm"],
            _SUPPORTS[row["support"]],
            tuple(row.get("speeds") or _grid(row["interference_mm"], row["support"])),
            row["weight"],
            row.get("group", ""),
        )
        for row in rows
    )


def _grid(interference_mm: float, support: str) -> list[float]:
    """Return the speeds to simulate, fine near the critical speeds measured at 0.279 mm."""
    if interference_mm == 0.178:
        return list(_THIN_GRID.tolist())
    fine = [
        np.arange(_WINDOW[0] * value, _WINDOW[1] * value, _FINE[item])
        for item, value, *place in (row[:4] for row in _DATA["critical_speeds"]["rows"])
        if place == [interference_mm, support]
    ]
    return list(np.unique(np.concatenate([_COARSE, *fine])).tolist())


_CRITICAL_SPEEDS = _targets("critical_speeds")
CELLS = tuple(one for one in _CRITICAL_SPEEDS if one.group != "thin")
"""Critical speeds at 0.279 mm, which are fitted."""

_OTHERS = _targets("numbers")
SPEEDS_ALONE = CELLS + tuple(one for one in _OTHERS if one.item == "mean_torque_spread")
"""Targets without the other interferences and the noises."""

THESIS_TABLE = _CRITICAL_SPEEDS + _OTHERS


def start() -> NDArray[np.float64]:
    """Return the logarithms of the start values of the search, shape (n_unknowns,)."""
    return np.log([unknown["start"] for unknown in UNKNOWNS.values()])


def values_at(point: ArrayLike) -> dict[str, float]:
    """Return the values of the unknowns at a point of the search.

    Parameters
    ----------
    point : array_like, shape (n_unknowns,)
        Logarithms; they are limited to the ranges of the unknowns.

    Examples
    --------
    >>> round(values_at(start())["torque_drop"], 2)
    4.36
    """
    values = np.exp(np.asarray(point, dtype=np.float64)).tolist()
    return {
        name: min(max(value, unknown["low"]), unknown["high"])
        for (name, unknown), value in zip(UNKNOWNS.items(), values, strict=True)
    }


def rig_of(values: Mapping[str, float]) -> Rig | None:
    """Return the rig with given values; None if the kinetic torque vanishes.

    Examples
    --------
    >>> round(rig_of(values_at(start())).fit(0.279e-3).kinetic_torque, 2)
    7.43
    """
    base = load_material_rig("fluorocarbon")
    drop, age = values["torque_drop"], values["renewal_angle"] / _SPEED
    fading = math.exp(-((_SPEED / values["weakening_speed"]) ** _EXPONENT))
    kinetic = MEAN_TORQUE - drop * age / (age + values["ageing_time"])
    kinetic -= values["weakening"] * fading
    if kinetic <= 0.1 * MEAN_TORQUE:
        return None
    long, short, fixed = (values[f"{of}_damping"] for of in ("long", "short", "fixed"))
    thin = values["thin_damping_ratio"]
    thin_damping = thin * long, thin * short, values["thin_fixed_ratio"] * fixed
    tight_damping = tuple(values[f"tight_{of}damping"] for of in ("", "short_", "fixed_"))
    made = {
        0.178e-3: (_THIN * kinetic, _THIN * drop, thin_damping),
        0.279e-3: (kinetic, drop, (long, short, fixed)),
        0.381e-3: (values["tight_kinetic"], values["tight_drop"], tight_damping),
    }
    fits = []
    for fit in base.fits:
        torque, drop, damping = made[round(fit.interference, 6)]
        by_support = dict(zip(_SUPPORTS.values(), damping, strict=True))
        fits.append(
            replace(fit, kinetic_torque=torque, critical_torque=torque + drop, damping=by_support)
        )
    law = {
        "contact_stiffness_per_torque": values["contact_stiffness"] / kinetic,
        "contact_damping_per_torque": values["contact_damping"] / kinetic,
        "renewal_angle": 0.0,
        "ageing_time": values["ageing_time"],
        "weakening_share": values["weakening"] / kinetic,
        "weakening_speed": values["weakening_speed"],
        "weakening_exponent": _EXPONENT,
        "renewal_angle_per_torque": values["renewal_angle"] / kinetic,
    }
    return replace(
        base, fits=tuple(fits), friction=LawSpec("contact_with_memory", law),
        elastomer_damping_share=values["elastomer_damping_share"], effects=(),
    )  # fmt: skip


class SettledRun:
    """Settled half of a run from rest: torque, slips and spectrum.

    Parameters
    ----------
    rig : Rig
    speed : float
        Speed of the shaft [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    """

    def __init__(
        self, rig: Rig, speed: float, interference: float, support_stiffness: float
    ) -> None:
        motion = motion_from_rest(rig, speed, interference, support_stiffness, seconds=_SECONDS)
        last = motion.part(motion.torque.size // 2)
        self.slips = motion_slips(last)
        self.mean_torque = float(np.mean(last.torque))
        deviation = float(np.std(last.torque))
        self.oscillation = deviation / abs(self.mean_torque) if self.mean_torque else math.inf
        torque = (last.torque - self.mean_torque) * np.hanning(last.torque.size)
        self._amplitude = np.abs(np.fft.rfft(torque))
        self._frequency = np.fft.rfftfreq(torque.size, 1.0 / motion.rate)
        low = self._amplitude[self._frequency < _HIGHEST_LINE]
        self.strongest_line = float(self._frequency[np.argmax(low)])
        self._strongest = max(float(low.max()), 1e-12)

    def line_in(self, low: float, high: float) -> float:
        """Return the highest amplitude in a band [Hz], relative to the strongest line [-]."""
        inside = (self._frequency >= low) & (self._frequency < high)
        return float(self._amplitude[inside].max()) / self._strongest


def _above(value: float, limit: float) -> float:
    return min(_MOST, max(0.0, math.log(1.2 * limit / max(value, 1e-5))))


def _below(value: float, limit: float) -> float:
    return min(_MOST, max(0.0, math.log(1.2 * max(value, 1e-5) / limit)))


def _squawk(run: SettledRun) -> float:
    """Return the misfit of a run from a squawk [-]."""
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


_NOISES: Mapping[str, Callable[[SettledRun], float]] = {
    "squawk": _squawk,
    "squeal": _squeal,
    "none": lambda run: _below(run.oscillation, LEAST_OSCILLATION),
}
"""Misfits from the noises by name."""


def _simulated(target: Target, runs: Sequence[SettledRun]) -> float:
    """Return the simulated value of a target, in its unit."""
    first, last, means = runs[0], runs[-1], [run.mean_torque for run in runs]
    if target.item in _NOISES:
        return _NOISES[target.item](first)
    if target.item == "mean_torque":
        return first.mean_torque
    if target.item == "sudden_share":
        return first.slips.sudden_share
    if target.item == "mean_torque_spread":
        return max(means) / min(means)
    if target.item == "slip_rate_rise":
        return (last.slips.rate - first.slips.rate) / (target.speeds[-1] - target.speeds[0])
    oscillation = [run.oscillation for run in runs]
    v_crit2 = _last_crossing(target.speeds, oscillation, LEAST_OSCILLATION)
    if target.item == "v_crit2":
        return v_crit2
    sudden = [
        run.slips.sudden_share if run.oscillation > LEAST_OSCILLATION else 0.0 for run in runs
    ]
    return min(v_crit2, _last_crossing(target.speeds, sudden, LEAST_SUDDEN))


def _last_crossing(speed: Sequence[float], values: list[float], limit: float) -> float:
    above = [i for i, value in enumerate(values) if value > limit]
    if not above:
        return 0.8 * speed[0]
    last = above[-1]
    if last == len(values) - 1:
        return 1.1 * speed[-1]
    return falls_below(limit, speed[last], values[last], speed[last + 1], values[last + 1])


@dataclass(frozen=True)
class Score:
    """Score of a rig: cost [-] and simulated values of the targets [unit of each item]."""

    cost: float
    simulated: Mapping[Target, float]


def score(rig: Rig | None, targets: Sequence[Target]) -> Score:
    """Return the score of a rig by targets.

    Parameters
    ----------
    rig : Rig or None
        None has the highest cost.
    targets : sequence of Target

    Returns
    -------
    Score
    """
    if rig is None:
        return Score(_UNUSABLE, {})
    places = list(dict.fromkeys(place for target in targets for place in target.runs))
    try:
        made = Parallel(n_jobs=-1, prefer="threads")(
            delayed(SettledRun)(rig, *place) for place in places
        )
        runs = dict(zip(places, made, strict=True))
        simulated = {
            target: _simulated(target, [runs[place] for place in target.runs]) for target in targets
        }
    except ParameterError:
        return Score(_UNUSABLE, {})
    squares: dict[object, list[float]] = {}
    for target, value in simulated.items():
        weighted = target.weight * target.misfit(value)
        squares.setdefault(target.group or target, []).append(weighted * weighted)
    return Score(sum(math.sqrt(sum(s) / len(s)) for s in squares.values()), simulated)


def fit(
    targets: Sequence[Target], begin: NDArray[np.float64], *, rounds: int, step: float = _STEP
) -> NDArray[np.float64]:
    """Return the unknowns that minimise the cost, by a pattern search, which needs no gradient.

    Parameters
    ----------
    targets : sequence of Target
    begin : ndarray, shape (n_unknowns,)
        Logarithms [-].
    rounds : int
        Number of rounds, each with half the steps of the one before.
    step : float
        Step of the first round [-].

    Returns
    -------
    ndarray, shape (n_unknowns,)
        Logarithms [-].
    """
    best = math.inf

    def cost(point: NDArray[np.float64]) -> float:
        nonlocal best
        judged = score(rig_of(values_at(point)), targets)
        if judged.cost < best:
            best = judged.cost
            print(f"cost {best:.3f}, log-rms {_rms(judged.simulated):.3f}", file=sys.stderr)
        return judged.cost

    steps = np.full(begin.size, step)
    return pattern_search(cost, begin, steps, [0.5**i for i in range(rounds)])[0]


def _rms(simulated: Mapping[Target, float]) -> float:
    """Return the root mean square of the misfits of the fitted critical speeds [-]."""
    misfits = [one.misfit(value) for one, value in simulated.items() if one in CELLS]
    return float(np.sqrt(np.mean(np.square(misfits)))) if misfits else math.nan


def _print(rig: Rig) -> None:
    """Print the targets and the simulated values of a rig."""
    judged = score(rig, THESIS_TABLE)
    print(f"cost {judged.cost:.3f}; log-rms error at 0.279 mm {_rms(judged.simulated):.3f}")
    for one, simulated in judged.simulated.items():
        at = ", ".join(f"{speed:g}" for speed in one.speeds[:3]) + ", ..." * (len(one.speeds) > 3)
        print(
            f"  {one!s:<45} at {at + ' rad/s':<30} measured {one.value:6.2f}  "
            f"simulated {simulated:6.2f}  misfit {one.misfit(simulated):+.3f}"
        )


def main() -> int:
    """Run the command; return an exit code as of ``bushing-noise``."""
    parser = argparse.ArgumentParser(prog="python -m noise.training.calibrate", description=__doc__)
    about = "of the search, with ever finer steps"
    parser.add_argument("--rounds", type=int, default=0, metavar="N", help=about)
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help="write what was found")
    options = parser.parse_args()
    try:
        rig = load_material_rig("fluorocarbon")
        if options.rounds:
            values = values_at(fit(THESIS_TABLE, start(), rounds=options.rounds))
            rig = rig_of(values) or rig
            for name, value in values.items():
                print(f"  {name:<25}{value:12.4g} {UNKNOWNS[name]['about']}")
            if options.out:
                with atomic(options.out) as path:
                    path.write_text(rig_text(rig), encoding="utf-8")
        _print(rig)
    except BushingNoiseError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
