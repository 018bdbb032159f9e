"""Opened files of the app: recordings by number, label table, rig files.

The browser never names a path.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from models.errors import ParameterError
from models.foreign_file import check_plain_file
from noise.base.files import check_target
from noise.base.tables import TABLE_ENDINGS, check_table_path
from noise.batch.journal import journal_path
from noise.batch.work import Job, find_jobs

_TABLE = "labels.csv"
"""Beside the folder of recordings with the folder's name before it; in it where it is there."""


@dataclass(frozen=True)
class Opened:
    """Files that the app may read and write.

    Parameters
    ----------
    jobs : tuple of Job
        Recordings; `Job.index` is what the browser calls each.
    table : Path or None
        Label table, which need not exist; None without recordings.
    rigs : tuple of Path
        Rig files.
    folder : Path
        Where designs are saved: beside the rig file, else beside the folder of recordings, never in
        it.
    votes : Path
        Table of votes in `folder`, with the name of the folder of recordings.
    sources : tuple of Path
        Recordings and folders that the recordings were found in.
    seed : int
        Seed of random orders.
    leaving : ExitStack
        Cleanup at the end of the app.
    """

    jobs: tuple[Job, ...]
    table: Path | None
    rigs: tuple[Path, ...]
    folder: Path
    votes: Path
    sources: tuple[Path, ...] = ()
    seed: int = 0
    leaving: ExitStack = field(default_factory=ExitStack)

    def job(self, index: int) -> Job:
        """Return the recording of a number.

        Raises
        ------
        ParameterError
            The number does not exist.
        """
        if not 0 <= index < len(self.jobs):
            raise ParameterError(f"there is no recording {index}")
        return self.jobs[index]


def open_paths(
    paths: Sequence[Path],
    table: Path | None = None,
    seed: int = 0,
    save: Path | None = None,
) -> Opened:
    """Find recordings, label table and rig files.

    Parameters
    ----------
    paths : sequence of Path
        Recordings, folders that are searched for them at any depth, one label table, rig files.
    table : Path, optional
        Label table to write, which may be there; by default the one that was named, ``labels.csv``
        where it is already in the folder of recordings, or else ``FOLDER-labels.csv`` beside it.
    seed : int
        Seed of random orders.
    save : Path, optional
        `Opened.folder`, where that is to be another one.

    Raises
    ------
    ParameterError
        A path does not exist, or is a pipe or a device; several label tables are named, or no table
        can be written there.

    Examples
    --------
    >>> open_paths([]).jobs
    ()
    """
    for path in paths:
        if not path.exists():
            raise ParameterError(f"{path} does not exist")
        if not path.is_dir():
            check_plain_file(path)
    rigs = [path for path in paths if path.suffix.lower() == ".toml"]
    tables = [p for p in paths if p.is_file() and p.suffix.lower() in TABLE_ENDINGS]
    sounds = [path for path in paths if path not in rigs and path not in tables]
    if len(tables) > 1:
        raise ParameterError(f"{tables[1]} is a second label table; one is corrected at a time")
    if tables and table is not None and table.absolute() != tables[0].absolute():
        raise ParameterError(
            f"--out {table}: corrections go into the label table that is named, {tables[0]}"
        )
    if tables and not sounds:
        sounds = [tables[0].absolute().parent]
    if table is not None:  # the one beside the recordings is written where there is a correction
        check_table_path(table)
        check_target(table)
    jobs = find_jobs(sounds) if sounds else []
    first = (sounds or rigs or [Path.cwd()])[0].absolute()
    folder = first if first.is_dir() else first.parent
    if table is None and jobs:
        table = tables[0] if tables else _table_of(folder)
    if save is None and rigs:
        save = rigs[0].absolute().parent
    elif save is None and sounds:
        save = folder.parent
    save = save or folder
    votes = save / f"{folder.name}-votes.csv"
    return Opened(tuple(jobs), table, tuple(rigs), save, votes, tuple(sounds), seed)


def _table_of(folder: Path) -> Path:
    """Return the label table of a folder of recordings; a new one lies beside the folder.

    A table of which only the journal is there yet is being written, or was when it was interrupted.
    """
    inside = folder / _TABLE
    if inside.exists() or journal_path(inside).exists():
        return inside
    return folder.parent / f"{folder.name}-{_TABLE}"
