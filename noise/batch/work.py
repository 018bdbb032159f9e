"""Work on many recordings: which they are, what is done with each, where, and what comes of it.

A piece of work is a small object that can be sent to another process. What comes back is plain
numbers and texts in the order of the table's columns, so that it is the same value whether it was
computed here, in another process, or read back from a journal.

Linear algebra runs on one thread: on several, sums are split elsewhere and round differently.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import one_line
from noise.base.readable import readable
from noise.base.tables import plain_cell
from noise.batch.identity import file_identity
from noise.batch.rows import stored
from noise.recordings import find_recordings

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from noise.batch.journal import Journal
    from noise.batch.rows import Rows

__all__ = ["Done", "Job", "Work", "find_jobs", "one_thread", "perform", "perform_all", "refusal"]


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
    rows : list of list, or StoredRows
        One a row of the table, in the order of its columns.
    calibrated : bool
    error : str, optional
        Why it was refused; its one row then says so, too.
    """

    rows: Rows
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


def perform_all(
    work: Work,
    jobs: Sequence[Job],
    *,
    workers: int = 1,
    scheduler: str | None = None,
    journal: Journal | None = None,
) -> Generator[tuple[Job, Done]]:
    """Do the work on all recordings: in this process, in several, or on a cluster.

    Parameters
    ----------
    work : Work
        Prepared.
    jobs : sequence of Job
    workers : int
        Number of processes; with 1 it is this one.
    scheduler : str, optional
        Address of a Dask cluster that does the work instead.
    journal : Journal, optional
        Where to keep what is done.

    Yields
    ------
    Job, Done
        In the order in which they are done.

    Raises
    ------
    ParameterError
        The cluster cannot be used.
    """
    if not jobs:
        return
    # What a file is counts from before it was read: it may change meanwhile.
    identities = {job.index: None if journal is None else file_identity(job.path) for job in jobs}
    with closing(_performed(work, jobs, workers, scheduler)) as performed:
        for job, done in performed:
            yield job, done
            if journal is not None:
                journal.add(job, identities[job.index], done)


def _performed(
    work: Work, jobs: Sequence[Job], workers: int, scheduler: str | None
) -> Generator[tuple[Job, Done]]:
    if scheduler is not None:
        from noise.batch.cluster import perform_on_cluster

        return perform_on_cluster(work, jobs, scheduler)
    if workers > 1:
        from noise.batch.processes import perform_on_processes

        return perform_on_processes(work, jobs, workers)
    return _perform_here(work, jobs)


def _perform_here(work: Work, jobs: Sequence[Job]) -> Generator[tuple[Job, Done]]:
    with one_thread():
        for job in jobs:
            yield job, perform(work, job.path, job.name)


def one_thread() -> AbstractContextManager[object]:
    """Keep linear algebra to one thread; to be called once its libraries are loaded."""
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits


def perform(work: Work, path: Path, name: str) -> Done:
    """Do the work on one recording; a recording that cannot be used is a row that says so."""
    try:
        rows, calibrated = work.rows(path, name)
        cells = stored([plain_cell(row.get(column)) for column in work.columns] for row in rows)
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
