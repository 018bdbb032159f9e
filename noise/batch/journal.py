"""The journal of a table: what has been done so far, on disk after each recording.

It is kept as `noise.batch.lines` keeps results, and outlives the table. A line is one recording
with its rows. It counts as long as the recording is the same file as then, and the same program
does the same work; otherwise the recording is done again, and the later line stands.

Refused recordings are not in it. They cost little, and what was at fault may have been put right
since without the file changing: a share that was away, a library that was not installed.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from noise.batch.identity import file_identity, work_identity
from noise.batch.lines import header_of, journal_path, open_lines, parsed
from noise.batch.work import Done

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from noise.batch.lines import Lines
    from noise.batch.work import Job, Work

    Entries = dict[str, tuple[list[int], Done]]

__all__ = ["Journal", "JournalReader", "open_journal"]


class Journal:
    """What is done of a table; see `open_journal`."""

    def __init__(self, lines: Lines, n_columns: int) -> None:
        self._lines = lines
        self._entries = _entries(([key, *found] for key, found in lines.found.items()), n_columns)

    def find(self, job: Job) -> Done | None:
        """Return what came of a recording, None where it is still to be done."""
        return _find(self._entries, job)

    def known(self, jobs: Sequence[Job]) -> dict[int, Done]:
        """Return what came of those recordings that are done, by their index."""
        return _known(self._entries, jobs)

    def add(self, job: Job, identity: list[int] | None, done: Done) -> None:
        """Keep what came of a recording; `identity` is the file's from before it was read."""
        if identity is None or done.error is not None:
            return
        self._lines.add(_key(job), identity, done.calibrated, done.rows)


class JournalReader:
    """What comes into the journal of a table while another process writes it.

    Parameters
    ----------
    table : Path
    work : Work
        Whose journal it is to be; another's tells nothing.
    """

    def __init__(self, table: Path, work: Work) -> None:
        self._path = journal_path(table)
        self._header = header_of(work_identity(work))
        self._n_columns = len(work.columns)
        self._read = 0

    def news(self, jobs: Sequence[Job]) -> dict[int, Done]:
        """Return what came of recordings since the last call, by their index."""
        try:
            with self._path.open("rb") as file:
                if file.readline() != self._header:
                    self._read = 0
                    return {}
                if os.fstat(file.fileno()).st_size < self._read:  # begun again
                    self._read = 0
                file.seek(max(self._read, len(self._header)))
                content = file.read()
        except OSError:
            return {}
        whole = content[: content.rfind(b"\n") + 1]
        self._read = max(self._read, len(self._header)) + len(whole)
        return _known(_entries(parsed(whole), self._n_columns), jobs) if whole else {}


@contextmanager
def open_journal(table: Path, work: Work, *, fresh: bool = False) -> Iterator[Journal]:
    """Open the journal of a table, with what of this work is in it.

    Parameters
    ----------
    table : Path
        Parent folders are made.
    work : Work
    fresh : bool
        Whether to forget what is in it.

    Raises
    ------
    ParameterError
        The journal cannot be written, or another process is writing it.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.batch.work import Job
    >>> from noise.commands.features import Featuring
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Path(folder) / "run07.wav"
    ...     run.touch()
    ...     job, work = Job(0, run, "run07.wav"), Featuring()
    ...     done = Done([["run07.wav", *[1.5] * (len(work.columns) - 1)]], True)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.add(job, file_identity(run), done)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.find(job) == done
    True
    """
    with open_lines(table, work_identity(work), fresh=fresh) as lines:
        yield Journal(lines, len(work.columns))


def _find(entries: Entries, job: Job) -> Done | None:
    entry = entries.get(_key(job))
    return entry[1] if entry is not None and entry[0] == file_identity(job.path) else None


def _known(entries: Entries, jobs: Sequence[Job]) -> dict[int, Done]:
    found = {job.index: _find(entries, job) for job in jobs}
    return {index: done for index, done in found.items() if done is not None}


def _entries(lines: Iterable[list[Any]], n_columns: int) -> Entries:
    entries = {}
    for line in lines:
        try:
            key, identity, calibrated, rows = line
            if {len(row) for row in rows} <= {n_columns} and isinstance(calibrated, bool):
                entries[key] = identity, Done(rows, calibrated)
        except (ValueError, TypeError):  # no line of ours
            continue
    return entries


def _key(job: Job) -> str:
    return f"{job.name}\n{job.path.absolute()}"
