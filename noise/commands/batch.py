"""Many recordings into one table: a bad file is a row that says so, and nothing done is lost."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from models.errors import BushingNoiseError, ParameterError
from noise.commands.targets import check_target
from noise.progress import counted, note, say, track
from noise.tables import check_table_path, write_table

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Sequence

__all__ = ["Task", "add_batch", "check_batch_out", "run_batch"]

_INTERRUPTED = 130  # 128 + SIGINT


class Task(NamedTuple):
    """What is done with each recording.

    Parameters
    ----------
    doing : str
        Such as ``"labelling"``.
    columns : sequence of str
        Of the table.
    rows : callable
        From path and name to the rows of a recording, and whether it is calibrated.
    error_row : callable
        From name and message to the row of a file that is refused.
    """

    doing: str
    columns: Sequence[str]
    rows: Callable[[Path, str], tuple[list[dict[str, object]], bool]]
    error_row: Callable[[str, str], dict[str, object]]


def add_batch(parser: ArgumentParser) -> None:
    """Add the recordings and the table."""
    parser.add_argument(
        "paths",
        nargs="+",
        type=Path,
        metavar="PATH",
        help="recording, or folder that is searched for recordings at any depth",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="TABLE",
        help="file for the table: .csv, .jsonl or .parquet (default: CSV on standard output)",
    )


def check_batch_out(out: Path | None) -> None:
    """Refuse a table that could not be written, before anything is read."""
    check_table_path(out)
    if out is not None:
        check_target(out)


def run_batch(options: Namespace, task: Task) -> int:
    """Go through the recordings, write the table, return the exit code.

    On an interrupt the table holds the recordings that were done until then.

    Raises
    ------
    ParameterError
        A path does not exist, there are no recordings, or the table cannot be written.
    """
    from noise.recordings import find_recordings

    found = find_recordings(options.paths)
    if not found:
        named = ", ".join(map(str, options.paths))
        raise ParameterError(f"{named}: there are no recordings in it")
    rows: list[dict[str, object]] = []
    done = refused = uncalibrated = 0
    interrupted = False
    try:
        for path, name in track(found, task.doing):
            try:
                of_file, calibrated = task.rows(path, name)
                rows += of_file
                uncalibrated += not calibrated
            except Exception as error:  # whatever it is, the next file may be fine
                message = _message(error)
                rows.append(task.error_row(name, message))
                refused += 1
                say(f"bushing-noise: refused: {_naming(path, message)}")
            done += 1
    except KeyboardInterrupt:
        interrupted = True
    if uncalibrated:
        note(
            f"{counted(uncalibrated, 'recording')} without calibration: levels in dBFS only "
            "(--full-scale gives one)"
        )
    try:
        write_table(options.out, task.columns, rows)
    except KeyboardInterrupt:
        interrupted = True
        if options.out is not None:
            write_table(options.out, task.columns, rows)
    read = (
        f"{done} of {counted(len(found), 'recording')}"
        if interrupted
        else counted(done, "recording")
    )
    say(f"{'interrupted: ' * interrupted}{read}, {refused} refused")
    if options.out is not None:
        print(options.out)
    if interrupted:
        return _INTERRUPTED
    return 1 if refused else 0


def _message(error: Exception) -> str:
    if isinstance(error, BushingNoiseError):
        return " ".join(str(error).split("\n"))
    return f"unexpected, please report: {type(error).__name__}: {error}"


def _naming(path: Path, message: str) -> str:
    return message if path.name in message else f"{path}: {message}"
