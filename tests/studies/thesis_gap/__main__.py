"""``python -m tests.studies.thesis_gap``: which effect closes how much of the thesis's own gap.

Prints the page; ``--out`` writes it (.md), or the table (.csv, .jsonl, .parquet). All candidates
take some five minutes on one core.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from models.rig_files.rig_file import load_material_rig
from noise.base.atomic import atomic
from noise.base.progress import say
from noise.base.tables import check_table_path, write_table
from tests.studies.thesis_gap.candidates import PAIRS, Candidate, nominal_rig, singles
from tests.studies.thesis_gap.fit import Effort, Trials
from tests.studies.thesis_gap.holdout import errors_of, examine
from tests.studies.thesis_gap.page import COLUMNS, gap_page, gap_rows

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["candidates", "main", "rows_of"]

_PAGE_ENDING = ".md"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; exit codes as those of ``bushing-noise``."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.thesis_gap", description=__doc__)
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", help="of these candidates alone, e.g. partial_slip"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="page (.md) or table (.csv)")
    options = parser.parse_args(arguments)
    as_page = options.out is None or options.out.suffix == _PAGE_ENDING
    try:
        if not as_page:
            check_table_path(options.out)
        rows = rows_of(candidates(options.only))
        if not as_page:
            write_table(options.out, COLUMNS, rows)
        elif options.out is None:
            sys.stdout.write(gap_page(rows))
        else:
            with atomic(options.out) as path:
                path.write_text(gap_page(rows), encoding="utf-8")
    except BushingNoiseError as error:
        say(f"error: {error}")
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def candidates(names: Sequence[str] | None = None) -> list[Candidate]:
    """Return the candidates of these names, or all.

    Raises
    ------
    ParameterError
        A name that is none.

    Examples
    --------
    >>> [candidate.name for candidate in candidates(["parameters"])]
    ['parameters']
    """
    known = {one.name: one for one in (*singles(), *map(Candidate, PAIRS))}
    for name in names or ():
        if name not in known:
            raise ParameterError(f"candidate {name!r} is unknown; there are {', '.join(known)}")
    return [one for name, one in known.items() if names is None or name in names]


def rows_of(chosen: Sequence[Candidate]) -> list[dict[str, object]]:
    """Examine candidates and return the rows of the table, `page.COLUMNS`."""
    findings = []
    known: dict[str, Trials] = {}
    for candidate in chosen:
        say(f"fitting {candidate.name} ...")
        findings.append(examine(candidate, Effort(), known))
    before, shipped = errors_of(nominal_rig()), errors_of(load_material_rig("fluorocarbon"))
    return gap_rows(before, shipped, findings)


if __name__ == "__main__":
    raise SystemExit(main())
