"""Where the work is done: here, on several processes, or on a cluster."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.batch.work import perform_each

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from noise.batch.work import Done, Job, Work

__all__ = ["perform_all"]


def perform_all(
    work: Work, jobs: Sequence[Job], *, workers: int = 1, scheduler: str | None = None
) -> Generator[tuple[Job, Done]]:
    """Do the work on all recordings.

    Parameters
    ----------
    work : Work
        Prepared.
    jobs : sequence of Job
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
        The cluster cannot be used.
    """
    if scheduler is not None:
        from noise.batch.cluster import perform_on_cluster

        return perform_on_cluster(work, jobs, scheduler)
    if workers > 1:
        from noise.batch.processes import perform_on_processes

        return perform_on_processes(work, jobs, workers)
    return perform_each(work, jobs)
