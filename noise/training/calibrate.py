"""Calibration of the shipped fluorocarbon: ``python -m noise.training.calibrate``.

A use of `noise.identification.table_fit`: the thesis's numbers are a table of measurements, and
what no source gives of contact and damping is searched; both stand in ``calibrate.toml``. Without
options the shipped material is judged. ``--rounds N`` searches; ``--leave-out N`` searches again
with each of the six critical speeds at 0.279 mm left out, from round numbers, and tells what is
predicted of it. A point that is tried takes 134 runs, about a second on one core, and a round 36 to
90 of them: ``--leave-out 4`` is a quarter to two thirds of an hour's work.

The contact has memory (`sim.friction.contact_with_memory`). Its torque at 0.279 mm and 5 rad/s is
held at the 8 Nm of Appendix F, so the level is no unknown. Torques at 0.178 mm are half those at
0.279 mm, as the mean torques are (5.2.1); those at 0.381 mm are unknown, where the drop follows
from one figure. Stiffness, damping and renewal of the contact go with its torques. Damping of the
bushing is unknown too: with that printed for 0.279 mm there is no squawk at 2214 Nm/rad and
7.5 rad/s, nor does the thesis's own simulation stick there.
"""

from __future__ import annotations

import argparse
import math
import sys
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from models.condition import FIXED
from models.errors import BushingNoiseError
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig, rig_text
from noise.base.files import atomic
from noise.identification.table_fit import TableFit, TableNumber, TableScore, fit_table
from noise.noise_definition import label_by_physics
from noise.thesis.runs import LONG, SHORT
from sim.analysis.critical_speeds import critical_speeds
from sim.analysis.slips import LEAST_SUDDEN
from sim.run import simulate

_DATA: dict[str, Any] = tomllib.loads(
    (resources.files("noise.training") / "calibrate.toml").read_text("utf-8")
)
UNKNOWNS: Mapping[str, Mapping[str, Any]] = _DATA["unknowns"]
_SUPPORTS = {"long": LONG, "short": SHORT, "fixed": FIXED}

_COARSE = np.geomspace(1.6, 14.4, 12)
_THIN_GRID = tuple(np.geomspace(1.0, 9.0, 10).tolist())
_FINE = {"v_crit1": 0.25, "v_crit2": 0.5}
"""Spacing of speeds about a measured critical one [rad/s]."""

_WINDOW = 0.8, 1.35
"""Over what was measured: where the speeds are fine."""

_REPORTED = tuple(0.25 * i for i in range(1, 65))
"""To 16 rad/s, so that an end beyond the measured 12.5 is found."""

MEAN_TORQUE = 8.0
"""At 0.279 mm and 5 rad/s [Nm], Appendix F."""

_THIN = 0.5
"""Torques at 0.178 mm over those at 0.279 mm."""

_SPEED = 5.0
_EXPONENT = 2.0
"""Of the weakening. With 1 the best searches left V_crit2 at 3745 Nm/rad 15 % low."""

_STEP, _WIDE_STEP = 0.05, 0.35
"""First step of the logarithms, about the start and about the round start."""


def _rows(table: str) -> list[dict[str, Any]]:
    columns = _DATA[table]["columns"]
    return [dict(zip(columns, row, strict=True)) for row in _DATA[table]["rows"]]


def _grid(support: str) -> tuple[float, ...]:
    """Speeds to try at 0.279 mm, coarse but about what was measured."""
    fine = [
        np.arange(_WINDOW[0] * row["value"], _WINDOW[1] * row["value"], _FINE[row["item"]])
        for row in _rows("critical_speeds")
        if (row["interference_mm"], row["support"]) == (0.279, support)
    ]
    return tuple(np.unique(np.concatenate([_COARSE, *fine])).tolist())


def _number(row: Mapping[str, Any]) -> TableNumber:
    value = LEAST_SUDDEN if row["value"] == "LEAST_SUDDEN" else row["value"]
    thin = row["interference_mm"] == 0.178
    speeds = row.get("speeds") or (_THIN_GRID if thin else _grid(row["support"]))
    return TableNumber(
        row["item"], value, 1e-3 * row["interference_mm"], _SUPPORTS[row["support"]],
        tuple(speeds), row["weight"], row.get("group", ""),
    )  # fmt: skip


_CRITICAL_SPEEDS = tuple(map(_number, _rows("critical_speeds")))
CELLS = tuple(one for one in _CRITICAL_SPEEDS if one.group != "thin")
"""At 0.279 mm: what is fitted."""

_OTHERS = tuple(map(_number, _rows("numbers")))
SPEEDS_ALONE = CELLS + tuple(one for one in _OTHERS if one.item == "mean_torque_spread")
"""Without the other interferences and the noises."""

THESIS_TABLE = _CRITICAL_SPEEDS + _OTHERS


def start(*, rounded: bool = False) -> NDArray[np.float64]:
    """Logarithms of where a search begins, or begins with a cell left out, shape (n_unknowns,)."""
    return np.log([u["round_start" if rounded else "start"] for u in UNKNOWNS.values()])


def values_at(point: ArrayLike) -> dict[str, float]:
    """Values of the unknowns at a point of the search.

    Parameters
    ----------
    point : array_like, shape (n_unknowns,)
        Logarithms; beyond the limits the nearest limit counts.

    Examples
    --------
    >>> round(values_at(start(rounded=True))["torque_drop"], 2)
    4.0
    """
    values = np.exp(np.asarray(point, dtype=np.float64)).tolist()
    return {
        name: min(max(value, unknown["low"]), unknown["high"])
        for (name, unknown), value in zip(UNKNOWNS.items(), values, strict=True)
    }


def rig_of(values: Mapping[str, float]) -> Rig | None:
    """Return the rig that the values make; None where they leave no kinetic torque.

    Examples
    --------
    >>> round(rig_of(values_at(start(rounded=True))).fit(0.279e-3).kinetic_torque, 2)
    7.52
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

    def fitted(fit: Fit) -> Fit:
        torque, drop, damping = made[round(fit.interference, 6)]
        return replace(
            fit, kinetic_torque=torque, critical_torque=torque + drop,
            damping=dict(zip(_SUPPORTS.values(), damping, strict=True)),
        )  # fmt: skip

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
        base, fits=tuple(map(fitted, base.fits)), friction=LawSpec("contact_with_memory", law),
        elastomer_damping_share=values["elastomer_damping_share"], effects=(),
    )  # fmt: skip


def measured_speeds(
    rig: Rig, cells: Sequence[TableNumber] = _CRITICAL_SPEEDS
) -> dict[TableNumber, float]:
    """Critical speeds of a rig as `sim.analysis.critical_speeds` defines them [rad/s]."""
    found = {
        place: critical_speeds(rig, *place, _REPORTED)
        for place in dict.fromkeys((cell.interference, cell.support_stiffness) for cell in cells)
    }
    return {
        cell: getattr(found[cell.interference, cell.support_stiffness], cell.item) for cell in cells
    }


def _print_speeds(title: str, speeds: Mapping[TableNumber, float]) -> None:
    print(f"{title}: log-rms error {TableScore(0.0, speeds).rms(speeds):.3f}")
    for cell, speed in speeds.items():
        print(
            f"  {cell!s:<37} measured {cell.value:6.2f}  simulated {speed:6.2f}  "
            f"log {cell.misfit(speed):+.3f}"
        )


def _print_noises(rig: Rig) -> None:
    print("Noises, not fitted as such (5.2.3)")
    for cell in (one for one in THESIS_TABLE if one.item in ("squawk", "squeal", "none")):
        run = simulate(
            rig, *cell.speeds,
            interference=cell.interference, support_stiffness=cell.support_stiffness,
        )  # fmt: skip
        at = f"{1e3 * cell.interference:.3f} mm, {cell.support_stiffness:.0f} Nm/rad"
        named = f"named {cell.item:<7} simulated {label_by_physics(run)}"
        print(f"  {at}, {cell.speeds[0]:g} rad/s  {named}")


def _fitted(
    table: Iterable[TableNumber], what: str, rounds: int, *, rounded: bool = False
) -> TableFit:
    def show(score: TableScore) -> None:
        rms = score.rms(cell for cell in CELLS if cell in score.found) if score.found else math.nan
        print(f"{what}: cost {score.cost:.3f}, log-rms {rms:.3f}", file=sys.stderr)

    return fit_table(
        lambda point: rig_of(values_at(point)), tuple(table), start(rounded=rounded),
        step=_WIDE_STEP if rounded else _STEP, rounds=rounds, workers=1 if rounded else -1,
        progress=show,
    )  # fmt: skip


def _predicted(cell: TableNumber, rounds: int) -> tuple[TableNumber, float]:
    """Critical speed of a rig that is fitted to all numbers but this."""
    others = (other for other in THESIS_TABLE if other != cell)
    found = _fitted(others, f"without {cell}", rounds, rounded=True)
    return cell, measured_speeds(found.rig, (cell,))[cell]


def main() -> int:
    """Run the command; exit codes as those of ``bushing-noise``."""
    parser = argparse.ArgumentParser(prog="python -m noise.training.calibrate", description=__doc__)
    about = "of the search, with ever finer steps"
    parser.add_argument("--rounds", type=int, default=0, metavar="N", help=about)
    about = "rounds of each of the six searches with a cell left out"
    parser.add_argument("--leave-out", type=int, default=0, metavar="N", help=about)
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help="write what was found")
    options = parser.parse_args()
    try:
        rig = load_material_rig("fluorocarbon")
        if options.rounds:
            found = _fitted(THESIS_TABLE, "all cells", options.rounds)
            rig = found.rig
            for name, value in values_at(found.vector).items():
                print(f"  {name:<25}{value:12.4g} {UNKNOWNS[name]['about']}")
            if options.out:
                with atomic(options.out) as path:
                    path.write_text(rig_text(rig), encoding="utf-8")
        speeds = measured_speeds(rig)
        _print_speeds("Fitted, at 0.279 mm", {c: speeds[c] for c in CELLS})
        thin = {cell: speed for cell, speed in speeds.items() if cell not in CELLS}
        _print_speeds("Fitted with less weight, at 0.178 mm", thin)
        _print_noises(rig)
        if options.leave_out:
            each = Parallel(n_jobs=-1)(delayed(_predicted)(c, options.leave_out) for c in CELLS)
            _print_speeds("Held out, each predicted by a search without it", dict(each))
    except BushingNoiseError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
