"""The journal of a table: what has been done so far, on disk after each recording.

It is kept as `noise.batch.lines` keeps results, and outlives the table. A line is one recording
with its rows; many rows of one recording are several lines, which count together or not at all. It
counts as long as the recording is the same file as then, and the same program does the same work;
otherwise the recording is done again, and the later line stands.

Refused recordings are not in it. They cost little, and what was at fault may have been put right
since without the file changing: a share that was away, a library that was not installed.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from noise.batch.identity import file_identity, work_identity
from noise.batch.lines import header_of, journal_path, open_lines, parsed
from noise.batch.rows import StoredRows, part_count, parts_of
from noise.batch.work import Done

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from noise.batch.lines import Lines
    from noise.batch.rows import Cell
    from noise.batch.work import Job, Work

    Entries = dict[str, tuple[list[int], Done]]

__all__ = ["Journal", "JournalReader", "open_journal"]


class Journal:
    """What is done of a table; see `open_journal`."""

    def __init__(self, lines: Lines, entries: Entries) -> None:
        self._lines = lines
        self._entries = entries

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
        n_parts = part_count(done.rows)
        self._lines.add(
            *(
                [_key(job), identity, done.calibrated, part]
                + ([] if n_parts == 1 else [number, n_parts])
                for number, part in enumerate(parts_of(done.rows), start=1)
            )
        )


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
        self._begin()

    def _begin(self) -> None:
        self._read = 0
        self._reading = _Reading(self._n_columns)

    def news(self, jobs: Sequence[Job]) -> dict[int, Done]:
        """Return what came of recordings since the last call, by their index."""
        try:
            with self._path.open("rb") as file:
                if file.readline() != self._header:
                    self._begin()
                    return {}
                if os.fstat(file.fileno()).st_size < self._read:  # begun again
                    self._begin()
                file.seek(max(self._read, len(self._header)))
                content = file.read()
        except OSError:
            return {}
        whole = content[: content.rfind(b"\n") + 1]
        self._read = max(self._read, len(self._header)) + len(whole)
        found: Entries = {}
        for line in whole.splitlines():
            found.update(self._reading.entries(parsed(line)))
        return _known(found, jobs)


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
    entries: Entries = {}
    reading = _Reading(len(work.columns))

    def take(found: list[Any]) -> None:
        entries.update(reading.entries(found))

    with open_lines(table, work_identity(work), take=take, fresh=fresh) as lines:
        yield Journal(lines, entries)


def _find(entries: Entries, job: Job) -> Done | None:
    entry = entries.get(_key(job))
    return entry[1] if entry is not None and entry[0] == file_identity(job.path) else None


def _known(entries: Entries, jobs: Sequence[Job]) -> dict[int, Done]:
    found = {job.index: _find(entries, job) for job in jobs}
    return {index: done for index, done in found.items() if done is not None}


class _Reading:
    """Recordings from the lines of a journal, as they come."""

    def __init__(self, n_columns: int) -> None:
        self._n_columns = n_columns
        self._begun: tuple[list[object], StoredRows] = ([], StoredRows())
        self._number = 0

    def entries(self, line: list[Any]) -> Entries:
        """Return the recording that a line completes, by its key."""
        try:
            key, identity, calibrated, rows, *place = line
            if not (
                {len(row) for row in rows} <= {self._n_columns} and calibrated in (True, False)
            ):
                return {}
            if not place:
                return {key: (identity, Done(rows, calibrated))}
            return self._part([key, identity, calibrated], rows, *place)
        except (ValueError, TypeError):  # no line of ours
            return {}

    def _part(self, of: list[Any], rows: list[list[Cell]], number: int, n_parts: int) -> Entries:
        if number == 1:
            self._begun = of, StoredRows()
        elif (of, number) != (self._begun[0], self._number + 1):  # one before it is damaged
            return {}
        self._number = number
        kept = self._begun[1]
        kept.add(rows)
        key, identity, calibrated = of
        return {key: (identity, Done(kept, calibrated))} if number == n_parts else {}


def _key(job: Job) -> str:
    return f"{job.name}\n{job.path.absolute()}"
