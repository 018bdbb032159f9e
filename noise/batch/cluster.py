"""Calls on a Dask cluster, whose machines read the recordings themselves, under the same paths.

Before anything is handed out they are asked which program they run: another version would give
another table. Dask hands the call of a worker that died to another one, and gives a call up after
some workers (``distributed.scheduler.allowed-failures``, 3) died at it.
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
            not_installed("--scheduler needs", "dask with distributed", "cluster")
        ) from None


@contextmanager
def cluster(scheduler: str) -> Iterator[Callable[..., Generator[tuple[int, Any]]]]:
    """Give a function that spreads calls over a cluster.

    Parameters
    ----------
    scheduler : str
        Its address.

    Yields
    ------
    callable
        ``spread(perform, calls)``, as `noise.base.processes.spread_over_processes`.

    Raises
    ------
    ParameterError
        There is no scheduler, it has no workers, or they run another version of the program; while
        it spreads, that the scheduler is gone.
    """
    check_cluster()
    import distributed

    dask: Any = distributed  # which has no types

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

    # The error says how a scheduler went away; Dask need not.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        client: Any = dask.Client(scheduler, timeout=_PATIENCE, set_as_default=False)
        client.wait_for_workers(1, timeout=_PATIENCE)
    except (OSError, ValueError) as error:  # a time-out is an OSError
        reason = str(error).partition("\n")[0]
        raise ParameterError(f"--scheduler {scheduler}: does not answer ({reason})") from None
    with client:
        for worker, program in client.run(_program, on_error="return").items():
            if program != _program():
                raise ParameterError(
                    f"--scheduler {scheduler}: worker {worker} has no bushing-noise, or another "
                    "version of it, or of numpy and the like; install the same ones there"
                )
        yield spread


def _program() -> list[object]:
    return [RESULTS_VERSION, *map(version, ("numpy", "scipy", "numba", "librosa", "scikit-learn"))]
