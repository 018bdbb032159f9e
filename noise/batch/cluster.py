"""Execution of calls on a Dask cluster.

The workers read the recordings under the same paths. Their versions of the program and its
libraries are compared first, as others would give another table. Dask repeats the call of a worker
that died on another one, up to ``distributed.scheduler.allowed-failures`` (3) times.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any, TypeVar

from models.errors import ParameterError, not_installed
from noise.batch.journal import RESULTS_VERSION

Result = TypeVar("Result")

_TIMEOUT = 10.0
"""Time for scheduler and first worker to answer [s]."""


def check_cluster() -> None:
    """Refuse the call if Dask is not installed.

    Raises
    ------
    ParameterError
        The message holds the command that installs it.
    """
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise ParameterError(
            not_installed("--scheduler needs", "dask with distributed", "cluster")
        ) from None


@contextmanager
def cluster(scheduler: str) -> Iterator[Callable[..., Generator[tuple[int, Any]]]]:
    """Connect to a cluster and yield a function that runs calls on it.

    Parameters
    ----------
    scheduler : str
        Address of the scheduler.

    Yields
    ------
    callable
        ``spread(perform, calls)``, like `noise.base.processes.spread_over_processes`.

    Raises
    ------
    ParameterError
        The scheduler does not answer, has no workers, or they run another version of the program;
        also when the scheduler disappears during the work.
    """
    check_cluster()
    import distributed

    dask: Any = distributed  # it has no types

    def spread(
        perform: Callable[..., Result], calls: Sequence[tuple[Any, ...]]
    ) -> Generator[tuple[int, Result | None]]:
        futures = {client.submit(perform, *c, pure=False): n for n, c in enumerate(calls)}
        with client.as_current():
            completed = dask.as_completed(futures)
        try:
            for future in completed:
                died = isinstance(future.exception(), dask.KilledWorker)
                yield futures[future], None if died else future.result()
        except CancelledError:
            raise ParameterError(
                f"--scheduler {scheduler}: went away during the work; call again once it is back"
            ) from None

    # Dask would log the loss of the scheduler as well as raising it.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        client: Any = dask.Client(scheduler, timeout=_TIMEOUT, set_as_default=False)
        client.wait_for_workers(1, timeout=_TIMEOUT)
    except (OSError, ValueError) as error:  # a time-out is an OSError
        reason = str(error).partition("\n")[0]
        raise ParameterError(f"--scheduler {scheduler}: does not answer ({reason})") from None
    with client:
        for worker, versions in client.run(_versions, on_error="return").items():
            if versions != _versions():
                raise ParameterError(
                    f"--scheduler {scheduler}: worker {worker} has no bushing-noise, or another "
                    "version of it, or of numpy and the like; install the same ones there"
                )
        yield spread


def _versions() -> list[object]:
    """Return the versions of the program's results and of the libraries."""
    return [RESULTS_VERSION, *map(version, ("numpy", "scipy", "numba", "librosa", "scikit-learn"))]
