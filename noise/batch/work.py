"""Work on recordings: which they are, what is done with each, where, and what comes of it.

A piece of work is a small object that can be sent to another process. What comes back is plain
numbers and texts in the order of the table's columns, so that it is the same value whether it was
computed here, in another process, on a cluster, or read back from a journal.

Linear algebra runs on one thread: on several, sums are split elsewhere and round differently.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import one_line
from noise.base.csv_table import Cell
from noise.base.processes import spread_over_processes
from noise.base.progress import readable
from noise.base.tables import plain_cell
from noise.recordings import find_recordings
from noise.recordings.sidecar import find_sidecar

if TYPE_CHECKING:  # which keeps what comes of work
    from noise.batch.journal import Journal

DIED = "the processes that worked on it died; is there enough memory?"
"""Why a recording is refused that no process survives."""


@dataclass(frozen=True, slots=True)
class Job:
    """One recording of a batch.

    Parameters
    ----------
    index : int
        Its place in the table.
    path : Path
    name : str
        What the table calls it.
    """

    index: int
    path: Path
    name: str


class Done(NamedTuple):
    """What came of one recording.

    Parameters
    ----------
    rows : list of list
        One a row of the table, in the order of its columns.
    calibrated : bool
    error : str, optional
        Why it was refused; its one row then says so, too.
    """

    rows: list[list[Cell]]
    calibrated: bool
    error: str | None = None


class Work(Protocol):
    """What is done with each recording; it can be pickled."""

    @property
    def doing(self) -> str:
        """Such as ``labelling``."""
        ...

    @property
    def columns(self) -> Sequence[str]:
        """Of the table; ``file`` and ``error`` are among them."""
        ...

    def prepare(self) -> None:
        """Load what all recordings need; an error here is one of the call."""
        ...

    def identity(self) -> Mapping[str, object]:
        """Return what decides the rows beside the recording and the program."""
        ...

    def rows(self, path: Path, name: str) -> tuple[Iterable[dict[str, object]], bool]:
        """Return the rows of a recording, once, and whether it is calibrated."""
        ...


def find_jobs(paths: Sequence[Path]) -> list[Job]:
    """Find the recordings, each once however often it is named.

    Parameters
    ----------
    paths : sequence of Path
        Recordings, or folders that are searched at any depth.

    Returns
    -------
    list of Job

    Raises
    ------
    ParameterError
        A path does not exist, or there are no recordings.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (Path(folder) / "run07.wav").touch()
    ...     [job.name for job in find_jobs([Path(folder)])]
    ['run07.wav']
    """
    found = {(path.absolute(), name): path for path, name in find_recordings(paths)}
    if not found:
        raise ParameterError(f"{', '.join(map(str, paths))}: there are no recordings in it")
    return [Job(index, path, name) for index, ((_, name), path) in enumerate(found.items())]


def one_thread() -> AbstractContextManager[object]:
    """Keep linear algebra to one thread; to be called once its libraries are loaded."""
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits


def perform(work: Work, path: Path, name: str) -> Done:
    """Do the work on one recording; a recording that cannot be used is a row that says so."""
    try:
        rows, calibrated = work.rows(path, name)
        cells = [[plain_cell(row.get(column)) for column in work.columns] for row in rows]
    except Exception as error:  # whatever it is, the next file may be fine
        return refusal(work, name, _message(error))
    return Done(cells, calibrated)


def refusal(work: Work, name: str, message: str) -> Done:
    """Return what comes of a recording that is refused."""
    said = {"file": name, "error": readable(message)}
    return Done([[said.get(column) for column in work.columns]], calibrated=True, error=message)


def _message(error: Exception) -> str:
    if isinstance(error, BushingNoiseError):
        return " ".join(str(error).split("\n"))
    if isinstance(error, MemoryError):
        return "needs more memory than there is"
    return one_line(f"unexpected, please report: {type(error).__name__}: {error}")


def file_identity(path: Path) -> list[int] | None:
    """Size [byte] and time of the last change [ns] of a recording, then those of its sidecar.

    None where the file cannot be looked at.

    Examples
    --------
    >>> file_identity(Path("nowhere.wav")) is None
    True
    """
    try:
        parts = [path, *filter(None, [find_sidecar(path)])]
        return [value for part in parts for value in (part.stat().st_size, part.stat().st_mtime_ns)]
    except OSError:
        return None


def perform_all(
    work: Work,
    jobs: Sequence[Job],
    journal: Journal,
    *,
    workers: int = 1,
    scheduler: str | None = None,
) -> Generator[tuple[Job, Done]]:
    """Do the work on all recordings, and keep what comes of each in the journal.

    Parameters
    ----------
    work : Work
        Prepared.
    jobs : sequence of Job
    journal : Journal
    workers : int
        Number of processes; with 1 it is this one.
    scheduler : str, optional
        Address of a Dask cluster that does the work instead.

    Yields
    ------
    Job, Done
        In the order in which they are done.

    Raises
    ------
    ParameterError
        The cluster cannot be used, or the journal not be written.
    """
    if not jobs:
        return
    # What a file is counts from before it was read: it may change meanwhile.
    identities = [file_identity(job.path) for job in jobs]
    with closing(_results(work, jobs, workers, scheduler)) as results:
        for place, result in results:
            job = jobs[place]
            done = refusal(work, job.name, DIED) if result is None else result
            journal.keep(job, identities[place], done)
            yield job, done


def _results(
    work: Work, jobs: Sequence[Job], workers: int, scheduler: str | None
) -> Generator[tuple[int, Done | None]]:
    calls = [(work, str(job.path), str(job.path.absolute()), job.name) for job in jobs]
    if scheduler is not None:
        from noise.batch.cluster import cluster

        with cluster(scheduler) as spread:
            yield from spread(_perform_elsewhere, calls)
    elif workers > 1:
        yield from spread_over_processes(_perform_elsewhere, calls, workers)
    else:
        with one_thread():
            for place, job in enumerate(jobs):
                yield place, perform(work, job.path, job.name)


_READY: dict[object, Work] = {}


def _perform_elsewhere(work: Work, as_given: str, absolute: str, name: str) -> Done:
    """Do the work in another process, on a machine whose working folder may be another."""
    # Prepared once a process, which may live longer than a classifier's file.
    key = work, *map(str, work.identity().values())
    if key not in _READY:
        work.prepare()
        _READY[key] = work
    with one_thread():
        done = perform(_READY[key], Path(absolute), name)
    if done.error is None:
        return done
    # Messages name files as the caller named them; that of a sidecar differs in the ending only.
    stem, stem_as_given = (str(Path(path).with_suffix("")) for path in (absolute, as_given))
    return refusal(work, name, done.error.replace(stem, stem_as_given))


class BatchRows:
    """Rows of a table, each read from the journal when it is its turn.

    Parameters
    ----------
    columns : sequence of str
    journal : Journal
    jobs : iterable of Job
        In the order of the table, those that are done.
    refused : mapping of int to Done
        By the index of the recording; these are not in the journal.
    """

    def __init__(
        self,
        columns: Sequence[str],
        journal: Journal,
        jobs: Iterable[Job],
        refused: dict[int, Done],
    ) -> None:
        self._columns, self._journal = columns, journal
        self._jobs, self._refused = list(jobs), refused

    def __iter__(self) -> Iterator[dict[str, Any]]:
        for job in self._jobs:
            refused = self._refused.get(job.index)
            for row in self._journal.rows(job) if refused is None else refused.rows:
                yield dict(zip(self._columns, row, strict=True))
