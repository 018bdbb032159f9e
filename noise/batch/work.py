"""What is done with each recording, and what comes of it.

A piece of work is a small object that can be sent to another process. What comes back is plain
numbers and texts in the order of the table's columns, so that it is the same value whether it was
computed here, in another process, or read back from a journal.

Linear algebra runs on one thread: on several, sums are split elsewhere and round differently.
"""

from __future__ import annotations

import numbers
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from models.errors import BushingNoiseError

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    Cell = bool | int | float | str | None

__all__ = ["Done", "Job", "Work", "one_thread", "perform", "perform_each"]


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

    def identity(self) -> Mapping[str, Cell]:
        """Return what decides the rows beside the recording and the program."""
        ...

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        ...


def one_thread() -> AbstractContextManager[object]:
    """Keep linear algebra to one thread; to be called once its libraries are loaded."""
    from threadpoolctl import threadpool_limits

    limits: AbstractContextManager[object] = threadpool_limits(1)
    return limits


def perform(work: Work, path: Path, name: str) -> Done:
    """Do the work on one recording; a recording that cannot be used is a row that says so."""
    try:
        rows, calibrated = work.rows(path, name)
    except Exception as error:  # whatever it is, the next file may be fine
        return refusal(work, name, _message(error))
    return Done([[_cell(row.get(column)) for column in work.columns] for row in rows], calibrated)


def refusal(work: Work, name: str, message: str) -> Done:
    """Return what comes of a recording that is refused."""
    said = {"file": name, "error": message}
    return Done([[said.get(column) for column in work.columns]], calibrated=True, error=message)


def perform_each(work: Work, jobs: Sequence[Job]) -> Generator[tuple[Job, Done]]:
    """Do the work in this process, one recording after the other."""
    with one_thread():
        for job in jobs:
            yield job, perform(work, job.path, job.name)


def _message(error: Exception) -> str:
    if isinstance(error, BushingNoiseError):
        return " ".join(str(error).split("\n"))
    if isinstance(error, MemoryError):
        return "needs more memory than there is"
    return f"unexpected, please report: {type(error).__name__}: {error}"


def _cell(value: object) -> Cell:
    if value is None or isinstance(value, str | bool):
        return value
    item = getattr(value, "item", None)  # scalars of numpy
    if callable(item):
        return _cell(item())
    if isinstance(value, numbers.Integral):
        return int(value)
    return float(value) if isinstance(value, numbers.Real) else str(value)
