"""Work on a cluster, through joblib's Dask backend.

The cluster's machines read the recordings themselves, under the same paths. Before anything is
handed out they are asked which program they run: another version would give another table.

Dask hands the recordings of a worker that died to another one, and gives a recording up after some
workers (``distributed.scheduler.allowed-failures``, 3) died at it. joblib would wait forever for
what was given up; here it is a recording refused, and the others go on.

What is spread over the machines need not be recordings: `cluster` hands out any calls, as those of
a screen's points, by the same rules.
"""

from __future__ import annotations

import logging
from concurrent.futures import CancelledError
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError
from noise.batch.identity import program_identity
from noise.batch.work import Job, one_thread, perform, refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence

    from noise.batch.work import Done, Work

__all__ = ["check_cluster", "cluster", "perform_on_cluster"]

_DIED = "the workers of the cluster that worked on it died; do they have enough memory?"

_PATIENCE = 10.0
"""How long scheduler and first worker may take to answer [s]."""


def check_cluster() -> None:
    """Refuse the call where the libraries for a cluster are missing.

    Raises
    ------
    ParameterError
        With the command that installs them.
    """
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise ParameterError(
            "--scheduler needs dask and distributed, which are not installed; "
            'run: pip install "bushing-noise[cluster]"'
        ) from None


def perform_on_cluster(
    work: Work, jobs: Sequence[Job], scheduler: str
) -> Generator[tuple[Job, Done]]:
    """Do the work on a cluster; yields in the order in which recordings are done.

    Raises
    ------
    ParameterError
        There is no scheduler, it has no workers, or they run another version of the program.
    """
    by_index = {job.index: job for job in jobs}
    calls = [(work, job.index, str(job.path), str(job.path.absolute()), job.name) for job in jobs]
    with cluster(scheduler) as spread:
        for index, done in spread(_perform, calls):
            job = by_index[index]
            yield job, done or refusal(work, job.name, _DIED)


@contextmanager
def cluster(
    scheduler: str,
) -> Iterator[
    Callable[
        [Callable[..., tuple[int, Any]], Iterable[tuple[Any, ...]]], Generator[tuple[int, Any]]
    ]
]:
    """Give a function that spreads calls over a cluster.

    Parameters
    ----------
    scheduler : str
        Its address.

    Yields
    ------
    callable
        ``spread(perform, calls)``: calls `perform` with the arguments of each call, of which the
        second is its index, and yields what it returns, ``(index, result)``, in the order in which
        calls are done; the result is None where workers died at it.

    Raises
    ------
    ParameterError
        There is no scheduler, it has no workers, or they run another version of the program; while
        it spreads, that the scheduler is gone.
    """
    check_cluster()
    from joblib import Parallel, delayed, parallel_config

    def spread(
        perform: Callable[..., tuple[int, Any]], calls: Iterable[tuple[Any, ...]]
    ) -> Generator[tuple[int, Any]]:
        parallel = Parallel(batch_size=1, pre_dispatch="all", return_as="generator_unordered")
        try:
            yield from parallel(delayed(perform)(*call) for call in calls)
        except CancelledError:
            raise ParameterError(
                f"--scheduler {scheduler}: went away during the work; call again once it is back"
            ) from None

    with (
        _unsaid(),
        _client(scheduler) as client,
        parallel_config(backend=_surviving_backend()(client=client)),
    ):
        yield spread


@contextmanager
def _unsaid() -> Iterator[None]:
    """Keep Dask from printing how a scheduler went away: the error says that it did."""
    logger = logging.getLogger("distributed.client")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)


def _client(scheduler: str) -> Any:
    import distributed

    connect: Any = distributed.Client
    try:
        client = connect(scheduler, timeout=_PATIENCE, set_as_default=False)
        client.wait_for_workers(1, timeout=_PATIENCE)
    except (OSError, ValueError) as error:  # a time-out is an OSError
        reason = str(error).partition("\n")[0]
        raise ParameterError(f"--scheduler {scheduler}: does not answer ({reason})") from None
    programs: dict[str, str] = client.run(_program, on_error="return")
    for worker, program in programs.items():
        if program != program_identity():
            client.close()
            raise ParameterError(
                f"--scheduler {scheduler}: worker {worker} has no bushing-noise, or another "
                f"version of it, or of numpy and the like; install the same ones there"
            )
    return client


def _program() -> str:
    return program_identity()


def _perform(work: Work, index: int, as_given: str, absolute: str, name: str) -> tuple[int, Done]:
    """Do the work on a machine whose working folder is another."""
    work = _prepared(work)
    with one_thread():
        done = perform(work, Path(absolute), name)
    if done.error is None:
        return index, done
    # Messages name files as the caller named them; that of a sidecar differs in the ending only.
    stem, stem_as_given = (str(Path(path).with_suffix("")) for path in (absolute, as_given))
    return index, refusal(work, name, done.error.replace(stem, stem_as_given))


_READY: dict[object, Work] = {}


def _prepared(work: Work) -> Work:
    """Prepare the work once a process, which may live longer than a classifier's file."""
    key = work, *work.identity().values()
    if key not in _READY:
        work.prepare()
        _READY[key] = work
    return _READY[key]


def _surviving_backend() -> Any:
    from joblib._dask import DaskDistributedBackend

    class Surviving(DaskDistributedBackend):  # type: ignore[misc]  # joblib has no types
        """Tells what was given up as a result that is none."""

        def submit(self, func: Any, callback: Any = None) -> Any:
            future = super().submit(func, callback)
            ((_, arguments, _),) = func.items
            index = arguments[1]

            def given_up(future: Any) -> None:
                if future.exception() is not None:
                    callback([(index, None)])

            future.add_done_callback(given_up)
            return future

    return Surviving
