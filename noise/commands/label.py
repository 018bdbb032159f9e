"""``bushing-noise label``: recordings into a table of labelled segments, and a map.

Label tables in place of recordings are joined, for a map without new labelling.
"""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from noise.base.files import check_target, locked
from noise.base.labels import SENSITIVITY, SURROUNDINGS
from noise.base.progress import counted, note, report
from noise.base.tables import TABLE_ENDINGS, check_table_path, write_table
from noise.commands.batch import BATCH, run_batch
from noise.commands.options import CALIBRATION, Option, full_scale_of, number, one_of

OPTIONS = (
    *BATCH,
    Option("--map PICTURE", Path),
    Option("--classifier FILE.npz", Path),
    Option("--surroundings rig|car|any", one_of(*SURROUNDINGS)),
    Option("--sensitivity RATIO", number(least=SENSITIVITY[0], most=SENSITIVITY[1]), 1.0),
    *CALIBRATION,
)


def run(options: Namespace) -> int:
    """Label the recordings and write the table."""
    check_table_path(options.out)
    check_target(options.out)
    _check_exports(options)
    if all(path.suffix.lower() in TABLE_ENDINGS for path in options.paths):
        return _from_tables(options)
    from noise.batch.work import find_jobs

    jobs = find_jobs(options.paths)
    from noise.labels.corrections import sign_corrections, with_corrections
    from noise.labels.labelling import Labelling
    from noise.labels.summary import ASSUMED, assumes_material, result_lines

    if options.out is not None:
        sign_corrections(options.out, [job.name for job in jobs])

    def export(rows: list[dict[str, object]]) -> list[Path]:
        if number := len({row["file"] for row in rows if assumes_material(row)}):
            note(
                f"conditions of {counted(number, 'recording')} are inferred {ASSUMED}: no material "
                "is logged"
            )
        return _export(options, rows)

    work = Labelling(
        options.classifier,
        full_scale=full_scale_of(options),
        sensitivity=options.sensitivity,
        surroundings=options.surroundings,
    )
    if work.surroundings is not None or work.sensitivity != 1.0:
        _note_false_names(work.false_names(), work.sensitivity)
    return run_batch(options, work, jobs, with_corrections, export, result_lines)


def _note_false_names(counts: Mapping[str, Any], sensitivity: float) -> None:
    """Print the rate of false names at a sensitivity, as far as the classifier's card states it."""
    if counts:
        nearest = min(counts, key=lambda stated: abs(math.log(float(stated) / sensitivity)))
        rate = counts[nearest]
        other = "" if float(nearest) == sensitivity else ", the nearest that was counted"
        note(
            f"without logged conditions and at a sensitivity of {nearest}{other}, real background "
            f"sounds of these surroundings got {rate['an_hour']:.0f} false names per hour "
            f"({rate['low']:.0f} to {rate['high']:.0f} at 95 %: {rate['names']} in "
            f"{rate['hours']:g} h)"
        )


def _check_exports(options: Namespace) -> None:
    """Refuse exports that cannot be written."""
    if options.map is not None:
        from noise.pictures.figure import check_picture_path

        check_picture_path(options.map)
        check_target(options.map, "--map")
        table = options.map.with_suffix(".csv")
        if options.out is not None and table.absolute() == options.out.absolute():
            raise ParameterError(
                f"--map {options.map}: its numbers would go into {table}, which --out names for "
                "the labels; give one of them another name"
            )


def _from_tables(options: Namespace) -> int:
    """Join label tables and write the exports."""
    from noise.labels.corrections import with_corrections
    from noise.labels.table import COLUMNS, own_columns, read_label_table

    if options.out is None and options.map is None:
        raise ParameterError(f"{options.paths[0]}: is a table; draw it with --map")
    rows = [row for path in options.paths for row in read_label_table(path)]
    if options.out is not None:
        with locked(options.out):
            if options.out.absolute() not in [path.absolute() for path in options.paths]:
                rows = with_corrections(options.out, rows)
            write_table(options.out, (*COLUMNS, *own_columns(rows)), rows)
        report(options.out)
    report(*_export(options, rows))
    return 0


def _export(options: Namespace, rows: list[dict[str, object]]) -> list[Path]:
    """Write the map and its table; return their paths."""
    written: list[Path] = []
    if options.map is not None:
        from noise.labels.conditions import MAP_COLUMNS, conditions_map, map_rows
        from noise.pictures.conditions import plot_conditions
        from noise.pictures.figure import write_picture

        places = conditions_map(rows)
        if not places:
            note("no segment is labelled, so there is no map")
            return written
        if all(one.speed is one.interference is one.support_stiffness is None for one in places):
            note(
                "no speed, interference or support stiffness is logged, so the map has one place, "
                '"?"; sidecars or columns of a label table state them (noise/recordings/README.md)'
            )
        number = len({row["file"] for row in rows if row["label"] is not None})
        title = f"Labels by condition: {counted(number, 'recording')}"
        write_picture(options.map, plot_conditions(places, title=title))
        table = options.map.with_suffix(".csv")
        write_table(table, MAP_COLUMNS, map_rows(places))
        written += [options.map, table]
    return written
