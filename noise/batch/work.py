"""Batch work on recordings: find them, process them in parallel and collect the rows.

`Work` is a small object that can be pickled. Its results are plain numbers and texts in the order
of the columns, so they are identical whether they were computed in this process, in another one,
or read from a journal.

Linear algebra runs on one thread, because several threads sum in another order and round otherwise.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import one_line
from noise.base.processes import spread_over_processes
from noise.base.progress import counted, readable, say
from noise.base.tables import Cell, plain_cell
from noise.recordings import find_recordings
from noise.recordings.sidecar import find_sidecar

if TYPE_CHECKING:  # it imports this module
    from noise.batch.journal import Journal

DIED = "the processes that worked on it died; is there enough memory?"
"""Reason for refusing a recording at which the worker processes die."""


@dataclass(frozen=True, slots=True)
class Job:
    """Recording of a batch.

    Parameters
    ----------
    index : int
        Position in the batch.
    path : Path
    name : str
        Name in the table.
    """

    index: int
    path: Path
    name: str


class JobResult(NamedTuple):
    """Rows of one recording.

    Parameters
    ----------
    rows : list of list
        Cells of each row, in the order of the columns.
    calibrated : bool
    error : str, optional
        Reason for a refusal, which the single row contains as well.
    """

    rows: list[list[Cell]]
    calibrated: bool
    error: str | None = None


class Work(Protocol):
    """Interface of the processing of a recording; implementations can be pickled."""

    @property
    def doing(self) -> str:
        """Name of the work, such as ``labelling``."""
        ...

    @property
    def columns(self) -> Sequence[str]:
        """Columns of the table, including ``file`` and ``error``."""
        ...

    def prepare(self) -> None:
        """Load models and libraries; an error here ends the whole call."""
        ...

    def identity(self) -> Mapping[str, object]:
        """Return the options on which the rows depend."""
        ...

    def rows(self, path: Path, name: str) -> tuple[Iterable[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        ...


def find_jobs(paths: Sequence[Path]) -> list[Job]:
    """Find all recordings, without duplicates.

    Parameters
    ----------
    paths : sequence of Path
        Recordings, or folders that are searched recursively.

    Returns
    -------
    list of Job

    Raises
    ------
    ParameterError
        A path does not exist, or no recordings are found.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (Path(folder) / "run07.wav").touch()
    ...     [job.name for job in find_jobs([Path(folder)])]
    ['run07.wav']
    """
    paths_by_key = {(path.absolute(), name): path for path, name in find_recordings(paths)}
    if not paths_by_key:
        raise ParameterError(f"{', '.join(map(str, paths))}: there are no recordings in it")
    return [Job(index, path, name) for index, ((_, name), path) in enumerate(paths_by_key.items())]


def one_thread() -> AbstractContextManager[object]:
    """Limit linear algebra to one thread; call it after its libraries are imported."""
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits


def perform(work: Work, path: Path, name: str) -> JobResult:
    """Process one recording; any error becomes a refusal."""
    try:
        rows, calibrated = work.rows(path, name)
        cells = [[plain_cell(row.get(column)) for column in work.columns] for row in rows]
    except Exception as error:  # one bad file must not end the batch
        return refusal(work, name, _message(error))
    return JobResult(cells, calibrated)


def refusal(work: Work, name: str, message: str) -> JobResult:
    """Return the result of a refused recording."""
    row = {"file": name, "error": readable(message)}
    cells: list[Cell] = [row.get(column) for column in work.columns]
    return JobResult([cells], calibrated=True, error=message)


def _message(error: Exception) -> str:
    """Return the message for an error in one line."""
    if isinstance(error, BushingNoiseError):
        return " ".join(str(error).split("\n"))
    if isinstance(error, MemoryError):
        return "needs more memory than there is"
    return one_line(f"unexpected, please report: {type(error).__name__}: {error}")


def file_identity(path: Path) -> list[int] | None:
    """Return size [byte] and modification time [ns] of a recording and of its sidecar.

    The result is None if the file is not accessible.

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
    work: Work, jobs: Sequence[Job], journal: Journal, *, workers: int = 1
) -> Generator[tuple[Job, JobResult]]:
    """Process recordings, except for those in the journal, and store each result there.

    Parameters
    ----------
    work : Work
        Its `prepare` has been called.
    jobs : sequence of Job
    journal : Journal
    workers : int
        Number of processes; 1 is this process alone.

    Yields
    ------
    job : Job
        Those in the journal first, the others in the order of completion.
    result : JobResult

    Raises
    ------
    ParameterError
        The journal cannot be written.
    """
    remaining = []
    for job in jobs:
        if (earlier := journal.find(job)) is None:
            remaining.append(job)
        else:
            yield job, earlier
    if len(remaining) < len(jobs):
        say(f"{len(jobs) - len(remaining)} of {counted(len(jobs), 'recording')} are done already")
    # The identity is taken before the content is read, which may change in between.
    identities = [file_identity(job.path) for job in remaining]
    with closing(_results(work, remaining, workers)) as results:
        for index, result in results:
            job = remaining[index]
            result = refusal(work, job.name, DIED) if result is None else result
            journal.add_result(job, identities[index], result)
            yield job, result


def _results(
    work: Work, jobs: Sequence[Job], workers: int
) -> Generator[tuple[int, JobResult | None]]:
    """Yield index and result of each recording as it completes; None if the workers died."""
    if workers > 1:
        calls = [(work, job.path, job.name) for job in jobs]
        yield from spread_over_processes(_perform_elsewhere, calls, workers)
    else:
        with one_thread():
            for index, job in enumerate(jobs):
                yield index, perform(work, job.path, job.name)


_PREPARED: dict[object, Work] = {}


def _perform_elsewhere(work: Work, path: Path, name: str) -> JobResult:
    """Process a recording in another process."""
    # Prepared once per process; the identity notices a model file that changes meanwhile.
    key = work, *map(str, work.identity().values())
    if key not in _PREPARED:
        work.prepare()
        _PREPARED[key] = work
    with one_thread():
        return perform(_PREPARED[key], path, name)


def table_rows(
    columns: Sequence[str], jobs: Iterable[Job], results: Mapping[int, JobResult]
) -> list[dict[str, Any]]:
    """Return the rows of the completed recordings, in the order of the jobs.

    Parameters
    ----------
    columns : sequence of str
    jobs : iterable of Job
    results : mapping of int to JobResult
        By the index of the job; recordings without a result are left out.

    Examples
    --------
    >>> results = {0: JobResult([["run07.wav", 1.5]], calibrated=True)}
    >>> table_rows(("file", "level_db"), [Job(0, Path("run07.wav"), "run07.wav")], results)
    [{'file': 'run07.wav', 'level_db': 1.5}]
    """
    return [
        dict(zip(columns, row, strict=True))
        for job in jobs
        if job.index in results
        for row in results[job.index].rows
    ]
