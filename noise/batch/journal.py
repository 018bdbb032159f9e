"""Journal of a call: an SQLite database of its results so far, which lets the same call resume.

The journal is a hidden file beside the output. Each result is written before the next computation
starts, so a killed call resumes where it stopped; after a power failure the last few results may be
missing. Results of other options or of another `RESULTS_VERSION` are discarded, with a note.

The journal of a table remains beside it. Its result of a recording is valid as long as the file is
unchanged. Refusals are not stored, because their cause may go without a change of the file, such as
an unmounted network drive or a missing library.
"""

from __future__ import annotations

import errno
import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from noise.base.files import locked
from noise.base.progress import note
from noise.batch.work import Job, JobResult, Work, file_identity

RESULTS_VERSION = 1
"""Version of the results in journals. Raise it whenever a change of code or of a library changes
labels, features or screened points; changes of model files are detected."""

_TIMEOUT = 30.0
"""Time that a writer waits for readers [s]."""

_TABLES = """
    create table if not exists call (version integer, identity text);
    create table if not exists result (key text primary key, value text);
"""


_TABLE = "table"
"""Key of the entry that marks the table as written."""


class Journal:
    """Results by key; see `open_journal` and `temporary_journal`.

    Parameters
    ----------
    path : Path or None
        None is a temporary file.
    identity : str
        Result of `call_identity`; results of another call are deleted.
    fresh : bool
        Whether to delete all earlier results.
    """

    def __init__(
        self, path: Path | None = None, identity: str = "", *, fresh: bool = False
    ) -> None:
        self._path = path
        self._database = sqlite3.connect("" if path is None else path, timeout=_TIMEOUT)
        try:
            # Results reach the operating system at once, which survives a kill; the disk follows.
            self._database.executescript(
                f"pragma journal_mode = wal; pragma synchronous = normal; {_TABLES}"
            )
            self._begin(identity, fresh=fresh)
        except sqlite3.Error:
            self.close()  # Windows deletes no open file
            raise

    def _begin(self, identity: str, *, fresh: bool) -> None:
        """Start or resume a call; delete the results of another call, or with `fresh` all."""
        call = (RESULTS_VERSION, identity)
        previous = self._database.execute("select version, identity from call").fetchone()
        if previous == call and not fresh:
            return
        if previous is not None and not fresh and self._path is not None and len(self):
            why = "other options" if previous[0] == RESULTS_VERSION else "another program version"
            note(f"{self._path}: holds results of {why}; everything is computed again")
        with self._database:
            self._database.execute("delete from call")
            self._database.execute("delete from result")
            self._database.execute("insert into call (version, identity) values (?, ?)", call)

    def get(self, key: str) -> list[Any] | None:
        """Return the values under a key; None if there are none."""
        row = self._database.execute("select value from result where key = ?", (key,)).fetchone()
        return None if row is None else json.loads(row[0])

    def add(self, key: str, *values: object) -> None:
        """Store JSON values under a key."""
        try:
            with self._database:
                self._database.execute(
                    "insert or replace into result values (?, ?)",
                    (_encodable(key), json.dumps(values)),
                )
        except sqlite3.Error as error:
            raise _cannot_write(self._path, error) from None

    def find(self, job: Job) -> JobResult | None:
        """Return the result of a recording; None if it is missing or the file has changed."""
        identity, calibrated, rows = self.get(_key(job)) or (None, False, [])
        unchanged = identity is not None and identity == file_identity(job.path)
        return JobResult(rows, calibrated) if unchanged else None

    def add_result(self, job: Job, identity: list[int] | None, result: JobResult) -> None:
        """Store the result of a recording with the `file_identity` from before it was read."""
        if result.error is None:
            self.add(_key(job), identity, result.calibrated, result.rows)

    def mark_written(self) -> None:
        """Mark the table as written."""
        self.add(_TABLE)

    def __len__(self) -> int:
        return int(self._database.execute("select count(*) from result").fetchone()[0])

    def close(self) -> None:
        """Close the database."""
        self._database.close()


def written_rows(table: Path) -> list[list[Any]]:
    """Return the rows of a table as it was last written, with any options.

    Parameters
    ----------
    table : Path

    Returns
    -------
    list of list
        Empty if the journal does not contain them.

    Examples
    --------
    >>> written_rows(Path("none-of-it.csv"))
    []
    """
    path = journal_path(table)
    if not path.exists():
        return []
    with suppress(sqlite3.Error), closing(sqlite3.connect(path, timeout=_TIMEOUT)) as database:
        version = database.execute("select version from call").fetchone()
        results = dict(database.execute("select key, value from result"))
        if version == (RESULTS_VERSION,) and results.pop(_TABLE, None) is not None:
            return [row for value in results.values() for row in json.loads(value)[2]]
    return []


@contextmanager
def open_journal(table: Path | None, work: Work, *, fresh: bool = False) -> Iterator[Journal]:
    """Open the journal of a table.

    Parameters
    ----------
    table : Path or None
        Parent folders are made. None is a table that is not written; its journal is temporary.
    work : Work
    fresh : bool
        Whether to delete all earlier results.

    Yields
    ------
    Journal

    Raises
    ------
    ParameterError
        The journal cannot be written, or another process is writing it.
    OSError
        The disk is full.

    Examples
    --------
    >>> import tempfile
    >>> from noise.commands.features import FeatureExtraction
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Path(folder) / "run07.wav"
    ...     run.touch()
    ...     job, work = Job(0, run, "run07.wav"), FeatureExtraction()
    ...     result = JobResult([["run07.wav", *[1.5] * (len(work.columns) - 1)]], True)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.add_result(job, file_identity(run), result)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.find(job) == result
    True
    """
    if table is None:
        with closing(Journal()) as journal:
            yield journal
        return
    identity = call_identity(work.doing, list(work.columns), dict(work.identity()))
    with _opened(table, identity, fresh=fresh) as journal:
        yield journal


@contextmanager
def temporary_journal(target: Path | None, identity: str) -> Iterator[Journal | None]:
    """Store intermediate results in a journal until the call succeeds.

    Parameters
    ----------
    target : Path, optional
        Output file of the call. Without it there is no journal.
    identity : str
        Result of `call_identity`.

    Yields
    ------
    Journal or None
        It is deleted after success, or if it is still empty after an error.

    Raises
    ------
    ParameterError, OSError
        As for `open_journal`.
    """
    if target is None:
        yield None
        return
    unneeded, new_folder = False, not target.parent.exists()
    try:
        with _opened(target, identity) as journal:
            try:
                yield journal
                unneeded = True
            finally:
                unneeded |= not len(journal)
    finally:
        if unneeded:
            journal_path(target).unlink(missing_ok=True)
            with suppress(OSError):  # the folder holds the output
                if new_folder:
                    target.parent.rmdir()


@contextmanager
def _opened(target: Path, identity: str, *, fresh: bool = False) -> Iterator[Journal]:
    """Lock and open the journal of a target; replace a damaged one."""
    path = journal_path(target)
    with locked(path, wait=False):
        new = not path.exists()
        try:
            try:
                journal = Journal(path, identity, fresh=fresh)
            except sqlite3.DatabaseError as error:
                if isinstance(error, sqlite3.OperationalError):
                    raise
                path.unlink()
                note(f"{path}: is damaged or of an earlier program; everything is computed again")
                journal = Journal(path, identity)
        except sqlite3.Error as error:
            if new:
                for end in ("", "-wal", "-shm"):
                    path.with_name(path.name + end).unlink(missing_ok=True)
            raise _cannot_write(path, error) from None
        with closing(journal):
            yield journal


def _cannot_write(path: Path | None, error: sqlite3.Error) -> Exception:
    """Return the error of a journal that cannot be written: of the machine, or of its path."""
    reason = f"cannot be written ({error})"
    # Extended codes have the primary one in their last byte.
    code = getattr(error, "sqlite_errorcode", 0) & 0xFF
    if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
        return OSError(errno.ENOSPC, reason, str(path))
    return ParameterError(f"{path}: {reason}")


def journal_path(target: Path) -> Path:
    """Return the path of the journal of an output file.

    Examples
    --------
    >>> journal_path(Path("runs") / "labels.csv").name
    '.labels.csv.journal'
    """
    return target.with_name(f".{target.name}.journal")


def call_identity(*decisive: object) -> str:
    """Return a text that identifies all inputs on which the results of a call depend.

    Examples
    --------
    >>> call_identity("rendering", 48000.0)
    '["rendering", 48000.0]'
    """
    return json.dumps(decisive)


def _key(job: Job) -> str:
    """Return the key of a recording."""
    return _encodable(f"{job.name}\n{job.path.absolute()}")


def _encodable(text: str) -> str:
    """Return a key that SQLite can store: file names may be invalid UTF-8."""
    return text.encode("utf-8", "backslashreplace").decode()
