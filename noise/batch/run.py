"""A batch: work on many recordings, in this process, in several, or on a cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from noise.batch.journal import Journal, file_identity
from noise.batch.pool import spread_over_processes
from noise.batch.work import Done, Job, Work, one_thread, perform, refusal

DIED = "the processes that worked on it died; is there enough memory?"
"""Why a recording is refused that no process survives."""


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
