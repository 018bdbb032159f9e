"""Fit of the fluorocarbon to the thesis's tables: ``python -m noise.training.calibrate``.

Without options it judges the shipped material. ``--generations N`` searches; ``--leave-out``
searches again with each of the six critical speeds at 0.279 mm left out, from round numbers.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from joblib import Parallel, delayed

from models.errors import BushingNoiseError
from models.rig_files.rig_file import load_material_rig
from noise.base.atomic import atomic
from noise.training.calibrate.cells import CELLS
from noise.training.calibrate.report import (
    material_toml,
    measured_speeds,
    noises_page,
    speeds_page,
    values_page,
)
from noise.training.calibrate.search import search
from noise.training.calibrate.unknowns import rig_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from noise.training.calibrate.cells import Cell
    from noise.training.calibrate.search import Found


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
    parser.add_argument("--generations", type=int, default=0, metavar="N", help="of the search")
    parser.add_argument(
        "--leave-out", type=int, default=0, metavar="N",
        help="generations of each of the six searches with a cell left out",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help="write what was found")
    return parser


def _run(options: argparse.Namespace) -> None:
    rig = load_material_rig("fluorocarbon")
    if options.generations:
        found = search(options.generations, options.seed, progress=_progress("all cells"))
        print(values_page(found))
        searched = rig_of(found.values)
        if searched is not None:
            if options.out:
                with atomic(options.out) as path:
                    path.write_text(material_toml(searched), encoding="utf-8")
            rig = searched
    speeds = measured_speeds(rig)
    fitted = {cell: speed for cell, speed in speeds.items() if cell in CELLS}
    print(speeds_page("Fitted, at 0.279 mm", fitted))
    hints = {cell: speed for cell, speed in speeds.items() if cell not in CELLS}
    print(speeds_page("A hint to the search, at 0.178 mm", hints))
    print(noises_page(rig))
    if options.leave_out:
        refitted = Parallel(n_jobs=-1)(
            delayed(_predicted)(cell, options.leave_out, options.seed) for cell in CELLS
        )
        predicted = {cell: speed for cell, speed in refitted if speed is not None}
        print(speeds_page("Held out, each predicted by a search without it", predicted))


def _predicted(cell: Cell, generations: int, seed: int) -> tuple[Cell, float | None]:
    """Critical speed of a rig that is fitted to all cells but this."""
    found = search(
        generations, seed, tuple(other for other in CELLS if other != cell),
        critical_speeds_alone=True, rounded=True, workers=1,
        progress=_progress(f"without {cell}"),
    )  # fmt: skip
    rig = rig_of(found.values)
    return cell, None if rig is None else measured_speeds(rig, (cell,))[cell]


def _progress(what: str) -> Callable[[int, Found], None]:
    def show(generation: int, best: Found) -> None:
        rms = best.score.log_error(CELLS) if best.score.speeds else float("nan")
        print(
            f"{what}: generation {generation}, cost {best.score.cost:.3f}, log-rms {rms:.3f}",
            file=sys.stderr,
        )

    return show


if __name__ == "__main__":
    raise SystemExit(main())
