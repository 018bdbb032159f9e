"""Work on recordings: which they are, what is done with each, and what comes of it.

A piece of work is a small object that can be sent to another process. What comes back is plain
numbers and texts in the order of the table's columns, so that it is the same value whether it was
computed here, in another process, or read back from a journal.

Linear algebra runs on one thread: on several, sums are split elsewhere and round differently.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import one_line
from noise.base.progress import readable
from noise.base.tables import Cell, plain_cell
from noise.recordings import find_recordings


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
