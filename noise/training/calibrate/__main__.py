"""Fit of the fluorocarbon to the thesis's tables: ``python -m noise.training.calibrate``.

A use of `noise.identification`: the thesis's numbers (`thesis_table`) are a table of measurements,
what no source gives (`unknowns`) is searched. Without options it judges the shipped material.
``--rounds N`` searches; ``--leave-out N`` searches again with each of the six critical speeds at
0.279 mm left out, from round numbers. A point that is tried takes 134 runs, about a second on one
core, and a round 36 to 90 of them: ``--leave-out 4`` is a quarter to two thirds of an hour's work.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from joblib import Parallel, delayed

from models.errors import BushingNoiseError
from models.rig_file import load_material_rig
from noise.base.files import atomic
from noise.identification.table_fit import TableFit, TableNumber, TableScore, fit_table
from noise.training.calibrate.report import (
    material_toml,
    measured_speeds,
    noises_page,
    speeds_page,
    values_page,
)
from noise.training.calibrate.thesis_table import CELLS, THESIS_TABLE
from noise.training.calibrate.unknowns import rig_of, start, values_at

_STEP, _WIDE_STEP = 0.05, 0.35
"""First step of the logarithms, about the start and about the round start."""


def main() -> int:
    """Run the command; exit codes as those of ``bushing-noise``."""
    options = _parser().parse_args()
    try:
        _run(options)
    except BushingNoiseError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m noise.training.calibrate", description=__doc__)
    parser.add_argument(
        "--rounds", type=int, default=0, metavar="N", help="of the search, with ever finer steps"
    )
    parser.add_argument(
        "--leave-out", type=int, default=0, metavar="N",
        help="rounds of each of the six searches with a cell left out",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help="write what was found")
    return parser


def _run(options: argparse.Namespace) -> None:
    rig = load_material_rig("fluorocarbon")
    if options.rounds:
        found = _fitted(options, THESIS_TABLE, "all cells")
        print(values_page(values_at(found.vector)))
        rig = found.rig
        if options.out:
            with atomic(options.out) as path:
                path.write_text(material_toml(rig), encoding="utf-8")
    speeds = measured_speeds(rig)
    fitted = {cell: speed for cell, speed in speeds.items() if cell in CELLS}
    print(speeds_page("Fitted, at 0.279 mm", fitted))
    hints = {cell: speed for cell, speed in speeds.items() if cell not in CELLS}
    print(speeds_page("Fitted with less weight, at 0.178 mm", hints))
    print(noises_page(rig))
    if options.leave_out:
        predicted = dict(Parallel(n_jobs=-1)(delayed(_predicted)(options, cell) for cell in CELLS))
        print(speeds_page("Held out, each predicted by a search without it", predicted))


def _predicted(options: argparse.Namespace, cell: TableNumber) -> tuple[TableNumber, float]:
    """Critical speed of a rig that is fitted to all numbers but this."""
    others = [other for other in THESIS_TABLE if other != cell]
    found = _fitted(options, others, f"without {cell}", rounded=True)
    return cell, measured_speeds(found.rig, (cell,))[cell]


def _fitted(
    options: argparse.Namespace, table: Sequence[TableNumber], what: str, *, rounded: bool = False
) -> TableFit:
    def show(score: TableScore) -> None:
        rms = score.rms(cell for cell in CELLS if cell in score.found) if score.found else math.nan
        print(f"{what}: cost {score.cost:.3f}, log-rms {rms:.3f}", file=sys.stderr)

    return fit_table(
        lambda point: rig_of(values_at(point)), table, start(rounded=rounded),
        step=_WIDE_STEP if rounded else _STEP,
        rounds=options.leave_out if rounded else options.rounds,
        workers=1 if rounded else -1, progress=show,
    )  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(main())
