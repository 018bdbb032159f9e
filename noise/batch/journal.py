"""The journal of a call: its results so far, kept one by one, for a call that goes on after it.

It is an SQLite database, hidden beside the table or folder that the call is to write. Each result
is a row of its own and in the file before the next is begun, so a process may be killed at any
moment, and the same call again goes on where it was; where the power fails, the last few may have
to be done again. Results of other options, or of a program that gives other results, are not used;
a line says so.

The journal of a table outlives it. A recording in it counts as long as it is the same file as then.
Refused recordings are not kept: what was at fault may have been put right since without the file
changing, such as a share that was away or a library that was not installed.
"""

from __future__ import annotations

import json
import sqlite3
import uuid
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from noise.base.files import locked
from noise.base.progress import note
from noise.batch.work import Done, Job, Work, file_identity

RESULTS_VERSION = 1
"""Of all that a journal holds. To be raised by hand whenever labels, features or screened points
come out differently for another reason than a model: a change of code or of a library."""

_PATIENCE = 30.0
"""How long who writes waits for who reads [s]."""

_TABLES = """
    create table if not exists call (version integer, identity text, begun text);
    create table if not exists result (key text primary key, value text);
"""


_TABLE = "table"
"""Key by which it is known that the table has been written."""


class Journal:
    """Results by their keys; see `open_journal` and `kept_results`.

    Parameters
    ----------
    path : Path or None
        None is a file that goes with the journal.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        self._database = sqlite3.connect("" if path is None else path, timeout=_PATIENCE)
        # The system has each result at once, so who is killed loses none; the disk a little later.
        self._database.executescript(
            f"pragma journal_mode = wal; pragma synchronous = normal; {_TABLES}"
        )

    def begin(self, identity: str, *, fresh: bool = False) -> None:
        """Forget what is of another call, or all of it."""
        call = (RESULTS_VERSION, identity)
        found = self._database.execute("select version, identity from call").fetchone()
        if found == call and not fresh:
            return
        if found is not None and not fresh and self._path is not None and len(self):
            why = "with other options" if found[0] == RESULTS_VERSION else "by another version"
            note(f"{self._path}: holds results that were made {why}; all is done again")
        with self._database:
            self._database.execute("delete from call")
            self._database.execute("delete from result")
            self._database.execute("insert into call values (?, ?, ?)", (*call, uuid.uuid4().hex))

    def get(self, key: str) -> list[Any] | None:
        """Return the values that are kept by a key; None where there are none."""
        found = self._database.execute("select value from result where key = ?", (key,)).fetchone()
        return None if found is None else json.loads(found[0])

    def add(self, key: str, *values: object) -> None:
        """Keep values as JSON knows them."""
        try:
            with self._database:
                self._database.execute(
                    "insert or replace into result values (?, ?)", (_ascii(key), json.dumps(values))
                )
        except sqlite3.Error as error:
            raise ParameterError(f"{self._path}: cannot be written ({error})") from None

    def find(self, job: Job) -> Done | None:
        """Return what came of a recording, None where it is still to be done."""
        found = self.get(_key(job))
        return None if found is None else _done(found, job)

    def rows(self, job: Job) -> list[list[Any]]:
        """Return the rows of a recording that was done, whatever has become of its file since."""
        found = self.get(_key(job))
        return [] if found is None else found[2]

    def keep(self, job: Job, identity: list[int] | None, done: Done) -> None:
        """Keep what came of a recording; `identity` is the file's from before it was read."""
        if done.error is None:
            self.add(_key(job), identity, done.calibrated, done.rows)

    def note_table(self) -> None:
        """Keep that the table is written."""
        self.add(_TABLE)

    def __len__(self) -> int:
        return int(self._database.execute("select count(*) from result").fetchone()[0])

    def close(self) -> None:
        """Let the file go."""
        self._database.close()


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
        self._identity = _work_identity(work)
        self._begun, self._last = "", 0

    def news(self, jobs: Sequence[Job]) -> dict[int, Done]:
        """Return what came of recordings since the last call, by their index."""
        by_key = {_key(job): job for job in jobs}
        found: dict[int, Done] = {}
        with suppress(sqlite3.Error), closing(self._opened()) as database:
            call = database.execute("select version, identity, begun from call").fetchone()
            if call is None or call[:2] != (RESULTS_VERSION, self._identity):
                return {}
            if call[2] != self._begun:
                self._begun, self._last = call[2], 0
            rows = "select rowid, key, value from result where rowid > ? order by rowid"
            for place, key, value in database.execute(rows, (self._last,)):
                self._last = place
                if key in by_key and (done := _done(json.loads(value), by_key[key])):
                    found[by_key[key].index] = done
        return found

    def _opened(self) -> sqlite3.Connection:
        return sqlite3.connect(f"{self._path.absolute().as_uri()}?mode=rw", uri=True)


def written_rows(table: Path) -> list[list[Any]]:
    """Return the rows that a table had when it was last written, by whatever options.

    Parameters
    ----------
    table : Path

    Returns
    -------
    list of list
        Empty where the journal does not know them.

    Examples
    --------
    >>> written_rows(Path("none-of-it.csv"))
    []
    """
    path = journal_path(table)
    if not path.exists():
        return []
    with suppress(sqlite3.Error), closing(sqlite3.connect(path, timeout=_PATIENCE)) as database:
        version = database.execute("select version from call").fetchone()
        results = dict(database.execute("select key, value from result"))
        if version == (RESULTS_VERSION,) and results.pop(_TABLE, None) is not None:
            return [row for value in results.values() for row in json.loads(value)[2]]
    return []


@contextmanager
def open_journal(table: Path | None, work: Work, *, fresh: bool = False) -> Iterator[Journal]:
    """Open the journal of a table, with what of this work is in it.

    Parameters
    ----------
    table : Path or None
        Parent folders are made; None is a table that is not written, of which nothing stays.
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
    >>> from noise.commands.features import Featuring
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Path(folder) / "run07.wav"
    ...     run.touch()
    ...     job, work = Job(0, run, "run07.wav"), Featuring()
    ...     done = Done([["run07.wav", *[1.5] * (len(work.columns) - 1)]], True)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.keep(job, file_identity(run), done)
    ...     with open_journal(Path(folder) / "t.csv", work) as journal:
    ...         journal.find(job) == done
    True
    """
    if table is None:
        with closing(Journal()) as journal:
            yield journal
        return
    with _opened(table, _work_identity(work), fresh=fresh) as journal:
        yield journal


@contextmanager
def kept_results(target: Path | None, identity: str) -> Iterator[Journal | None]:
    """Keep results until the block ends well and has no more need of them.

    Parameters
    ----------
    target : Path, optional
        The file that the call is to write. Without it nothing is kept.
    identity : str
        Of `call_identity`.

    Raises
    ------
    ParameterError
        As of `open_journal`.
    """
    if target is None:
        yield None
        return
    ended_well, made = False, not target.parent.exists()
    try:
        with _opened(target, identity) as journal:
            try:
                yield journal
                ended_well = True
            finally:
                ended_well |= not len(journal)
    finally:
        if ended_well:
            journal_path(target).unlink(missing_ok=True)
            with suppress(OSError):  # there is something in it
                if made:
                    target.parent.rmdir()


@contextmanager
def _opened(target: Path, identity: str, *, fresh: bool = False) -> Iterator[Journal]:
    path = journal_path(target)
    with locked(path, wait=False):
        try:
            try:
                journal = Journal(path)
                journal.begin(identity, fresh=fresh)
            except sqlite3.DatabaseError as error:
                if isinstance(error, sqlite3.OperationalError):
                    raise
                path.unlink()
                note(f"{path}: is damaged or of an earlier program; all is done again")
                journal = Journal(path)
                journal.begin(identity)
        except sqlite3.Error as error:
            raise ParameterError(f"{path}: cannot be written ({error})") from None
        with closing(journal):
            yield journal


def journal_path(target: Path) -> Path:
    """Where the results lie that are kept for a file to be written.

    Examples
    --------
    >>> journal_path(Path("runs") / "labels.csv").name
    '.labels.csv.journal'
    """
    return target.with_name(f".{target.name}.journal")


def call_identity(*decisive: object) -> str:
    """Return what decides the results of a call, as JSON can hold it.

    Examples
    --------
    >>> call_identity("rendering", 48000.0)
    '["rendering", 48000.0]'
    """
    return json.dumps(decisive)


def _work_identity(work: Work) -> str:
    return call_identity(work.doing, list(work.columns), dict(work.identity()))


def _key(job: Job) -> str:
    return _ascii(f"{job.name}\n{job.path.absolute()}")


def _ascii(text: str) -> str:
    """Return a key that SQLite can hold: names of files may be no text."""
    return text.encode("utf-8", "backslashreplace").decode()


def _done(values: list[Any], job: Job) -> Done | None:
    identity, calibrated, rows = values
    return Done(rows, calibrated) if identity and identity == file_identity(job.path) else None
