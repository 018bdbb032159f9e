"""Batch processing of recordings into one table, shared by ``features`` and ``label``.

A file that cannot be read becomes a row with an error. With ``--out`` a journal beside the table
stores the results, so that an interrupted call can be resumed by repeating it.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.files import check_target, locked
from noise.base.progress import counted, note, report, say, track
from noise.base.tables import check_table_path, write_table
from noise.commands.options import MOST_WORKERS, Option, refuse, whole_number

if TYPE_CHECKING:
    from noise.batch.work import Job, JobResult, Work

    Rows = list[dict[str, object]]


_INTERRUPTED = 130  # 128 + SIGINT


BATCH = (
    Option("paths PATH", Path, count="+"),
    Option("--out TABLE", Path),
    Option("--fresh"),
    Option("--workers N", whole_number(1, most=MOST_WORKERS), 1),
)


def run_batch(
    options: Namespace,
    work: Work,
    jobs: Sequence[Job],
    merge: Callable[[Path | None, Rows], Rows] = lambda _, rows: rows,
    export: Callable[[Rows], Sequence[Path]] = lambda _: (),
    summary: Callable[[Rows], Iterable[str]] | None = None,
) -> int:
    """Process recordings, write the table and return the exit code.

    After an interrupt the table holds the recordings processed so far.

    Parameters
    ----------
    options : Namespace
        Options of `BATCH`.
    work : Work
    jobs : sequence of Job
    merge : callable
        ``merge(out, rows)`` returns the rows to write: the new ones, merged with rows of the
        existing table that must stay.
    export : callable
        ``export(rows)`` writes further files and returns their paths.
    summary : callable
        ``summary(rows)`` returns a line per recording for standard output; a terminal gets these
        lines in place of the table.

    Raises
    ------
    ParameterError
        The table cannot be written.
    """
    from noise.batch.journal import open_journal
    from noise.batch.work import perform_all, table_rows

    out = options.out
    # A table of forty columns is not readable on a terminal.
    on_terminal = out is None and sys.stdout is not None and sys.stdout.isatty()
    show_summary = summary is not None and on_terminal
    check_table_path(out, work.columns)
    check_target(out)
    work.prepare()
    results: dict[int, JobResult] = {}
    exit_code = 0
    with open_journal(out, work, fresh=options.fresh) as journal:
        try:
            performed = perform_all(work, jobs, journal, workers=options.workers)
            for job, result in track(performed, work.doing, total=len(jobs)):
                results[job.index] = result
                if result.error is not None:
                    refuse(result.error, job.path)
        except KeyboardInterrupt:
            exit_code = _INTERRUPTED
        _note_uncalibrated(results.values())
        # The lock covers reading the existing table and writing the new one.
        with nullcontext() if out is None else locked(out):
            rows = merge(out, table_rows(work.columns, jobs, results))
            if not show_summary:
                names = (name for row in rows for name in row)
                write_table(out, tuple(dict.fromkeys((*work.columns, *names))), rows)
        written = [*([] if out is None else [out]), *export(rows)]
        journal.mark_written()
    interrupted = exit_code == _INTERRUPTED
    refused = sum(result.error is not None for result in results.values())
    number = f"{len(results)} of " * interrupted + counted(len(jobs), "recording")
    say(f"{'interrupted: ' * interrupted}{number}, {refused} refused")
    if summary is not None and out is not None:
        report(*summary(rows))
    if summary is not None and show_summary:
        print(*summary(rows), sep="\n")
        say("--out labels.csv, or a pipe, takes the whole table")
    for path in written:  # standard output may be the table
        report(path) if out is not None else say(str(path))
    return exit_code or int(refused > 0)


def _note_uncalibrated(results: Iterable[JobResult]) -> None:
    """Print a note if recordings are not calibrated."""
    number = sum(not result.calibrated for result in results)
    if number:
        note(
            f"{counted(number, 'recording')} without calibration: levels in dBFS only "
            "(--calibrator or --full-scale gives one)"
        )
