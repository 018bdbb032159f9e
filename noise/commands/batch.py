"""Many recordings into one table: a bad file is a row that says so, and nothing done is lost.

With ``--out`` a journal beside the table keeps what is done, so that the same call again goes on
where the last one ended, however it ended; without, there is nowhere to keep it.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from noise.base.files import check_target, export_paths, locked
from noise.base.progress import counted, note, report, say, track
from noise.base.tables import check_table_path, write_table
from noise.commands.options import MOST_WORKERS, OneOf, Option, refuse, whole_number

if TYPE_CHECKING:
    from noise.batch.journal import Journal
    from noise.batch.work import BatchRows, Job, JobResult, Work
    from noise.recordings.meaning import PascalPerFullScale

    Rows = Iterable[dict[str, object]]


_INTERRUPTED = 130  # 128 + SIGINT


BATCH = (
    Option("paths PATH", Path, count="+"),
    Option("--out TABLE", Path),
    Option("--fresh"),
    OneOf(
        Option("--workers N", whole_number(1, most=MOST_WORKERS), 1),
        Option("--scheduler ADDRESS", str),
    ),
)


def check_batch(options: Namespace) -> None:
    """Refuse what could not be done, before anything is read."""
    check_table_path(options.out)
    if options.out is not None:
        check_target(options.out)
    if options.scheduler is not None:
        from noise.batch.cluster import check_cluster

        check_cluster()


def run_batch(
    options: Namespace,
    work: Work,
    jobs: Sequence[Job],
    also: Callable[[Rows], Sequence[Path]] = lambda _: (),
    keep: Callable[[Path | None, BatchRows], Rows] = lambda _, rows: rows,
    lines: Callable[[Rows], Iterable[str]] | None = None,
) -> int:
    """Go through the recordings, write the table, return the exit code.

    On an interrupt, or when told to end, the table holds the recordings done until then.

    Parameters
    ----------
    options : Namespace
        Of `add_batch`.
    work : Work
    jobs : sequence of Job
    also : callable
        Writes further files from the rows of the table, and returns their paths.
    keep : callable
        From the table's path and its new rows to those that are written: what must stay of the
        table that is there.
    lines : callable
        From the rows of the table to a line a recording for standard output, unless that is the
        table; a terminal gets them in place of a table.

    Raises
    ------
    ParameterError
        The table cannot be written, or the cluster not be used.
    """
    from noise.batch.journal import open_journal
    from noise.batch.work import BatchRows

    out = options.out
    # Nobody reads a table of forty columns on a terminal; whoever wants it pipes or names it.
    to_read = out is None and lines is not None and sys.stdout is not None and sys.stdout.isatty()
    check_table_path(out, work.columns)
    work.prepare()
    outcomes: dict[int, JobResult] = {}
    stopped = 0
    with open_journal(out, work, fresh=options.fresh) as journal:
        try:
            for job, done in _progress(options, work, jobs, journal):
                if done.error is not None:
                    refuse(done.error, job.path)
                    outcomes[job.index] = done
                else:  # rows are in the journal, of which there may be many
                    outcomes[job.index] = done._replace(rows=[])
        except KeyboardInterrupt:
            stopped = _INTERRUPTED
        _note_uncalibrated(outcomes.values())
        refused = {index: done for index, done in outcomes.items() if done.error is not None}
        there = [job for job in jobs if job.index in outcomes]
        made = BatchRows(work.columns, journal, there, refused)
        rows, written = _write(options, work, made, also, keep, table=not to_read)
        journal.mark_written()
    read = f"{len(outcomes)} of " * bool(stopped) + counted(len(jobs), "recording")
    say(f"{'interrupted: ' * bool(stopped)}{read}, {len(refused)} refused")
    if lines is not None and out is not None:
        report(*lines(rows))
    if lines is not None and to_read:
        print(*lines(rows), sep="\n")
        say("--out labels.csv, or a pipe, takes the whole table")
    if out is not None:
        report(*written)
    else:  # standard output is the table
        for path in written:
            say(str(path))
    return stopped or int(bool(refused))


def _progress(
    options: Namespace, work: Work, jobs: Sequence[Job], journal: Journal
) -> Iterator[tuple[Job, JobResult]]:
    """First what earlier calls did, then the rest as it is done."""
    from noise.batch.work import perform_all

    left = []
    for job in jobs:
        if (done := journal.find(job)) is None:
            left.append(job)
        else:
            yield job, done
    if len(left) < len(jobs):
        say(f"{len(jobs) - len(left)} of {counted(len(jobs), 'recording')} are done already")
    if not left:
        return
    advancing = perform_all(
        work, left, journal, workers=options.workers, scheduler=options.scheduler
    )
    with closing(advancing):
        yield from track(advancing, work.doing, total=len(left))


def _write(
    options: Namespace,
    work: Work,
    made: BatchRows,
    also: Callable[[Rows], Sequence[Path]],
    keep: Callable[[Path | None, BatchRows], Rows],
    *,
    table: bool,
) -> tuple[Rows, list[Path]]:
    columns, out = work.columns, options.out
    # Nobody may change the table between the look at what stays of it and the writing.
    with nullcontext() if out is None else locked(out):
        rows = keep(out, made)
        if table:
            kept = () if rows is made else (name for row in rows for name in row)
            columns = tuple(dict.fromkeys((*columns, *kept)))
            write_table(out, columns, rows)
    return rows, [*([] if out is None else [out]), *also(rows)]


def _note_uncalibrated(outcomes: Iterable[JobResult]) -> None:
    number = sum(not done.calibrated for done in outcomes)
    if number:
        note(
            f"{counted(number, 'recording')} without calibration: levels in dBFS only "
            "(--calibrator or --full-scale gives one)"
        )


_LONGEST = 600.0
"""Of a picture [s]; a longer recording is drawn as far as that."""


PLOT = Option("--plot FOLDER|PICTURE", Path)


def check_plots(target: Path | None, jobs: Sequence[Job]) -> None:
    """Refuse pictures that cannot be written, before the work; none are asked for without a target.

    Raises
    ------
    ParameterError
        There are several recordings for one picture, or two of one name, or the place cannot be
        written to.
    """
    if target is None:
        return
    from noise.pictures.figure import PICTURE_ENDINGS

    paths = export_paths(target, [job.name for job in jobs], PICTURE_ENDINGS, "--plot")
    if target.is_file() and target.suffix.lower() not in PICTURE_ENDINGS:
        raise ParameterError(f"--plot {target}: is a file; name a folder or a picture")
    check_target(next(iter(paths.values())), "--plot")


def draw_recordings(
    target: Path | None,
    jobs: Sequence[Job],
    rows: Sequence[Mapping[str, object]] = (),
    *,
    full_scale: PascalPerFullScale | None = None,
) -> list[Path]:
    """Draw recordings, with their labels where there are any; return the pictures.

    Parameters
    ----------
    target : Path or None
        As of `check_plots`.
    jobs : sequence of Job
    rows : sequence of mapping
        Of the label table.
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.
    """
    if target is None:
        return []
    from noise.pictures.figure import PICTURE_ENDINGS, write_picture
    from noise.pictures.recording import plot_recording
    from noise.recordings.files import open_blocks

    paths = export_paths(target, [job.name for job in jobs], PICTURE_ENDINGS, "--plot")
    refused = {row.get("file") for row in rows if row.get("error")}
    written = []
    for job in track(jobs, "drawing"):
        if job.name in refused:
            continue
        try:
            with open_blocks(job.path, full_scale=full_scale) as blocks:
                shown = blocks.part(0, round(_LONGEST * blocks.rate))
                of_it = [row for row in rows if row.get("file") == job.name]
                write_picture(paths[job.name], plot_recording(shown, of_it))
        except BushingNoiseError as error:
            note(f"{job.name} is not drawn: {error}")
            continue
        written.append(paths[job.name])
    return written
