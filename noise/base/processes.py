"""Processes of this machine that share work, any of which may die.

Each is given one piece at a time, so that when one dies it is known which piece it was at. That one
is tried once more, in a new process. Where no process can be started the work is done in this one.
A process ends by itself when the one that it works for is gone, sees no interrupt that is meant for
that one, and does not run the caller's script again.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import lru_cache, partial
from multiprocessing import current_process, get_context, resource_tracker
from multiprocessing.util import Finalize
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")

_ATTEMPTS = 2
_EVERY = 0.5
"""Between looks at who a process works for [s]."""


def spread_over_processes(
    perform: Callable[..., Result], calls: Sequence[tuple[Any, ...]], workers: int
) -> Generator[tuple[int, Result | None]]:
    """Do calls in several processes.

    Parameters
    ----------
    perform : callable
        That can be sent to another process.
    calls : sequence of tuple
        Arguments of each call.
    workers : int
        Number of processes.

    Yields
    ------
    int, object
        Place of a call and what it returned, in the order in which calls are done; None where two
        processes died at it.
    """
    waiting, died = deque(range(len(calls))), Counter[int]()
    free = [Worker() for _ in range(min(workers, len(calls)))]
    busy: dict[Future[Result], tuple[Worker, int]] = {}
    try:
        while waiting or busy:
            while waiting and free:
                worker, place = free.pop(), waiting.popleft()
                busy[worker.submit(perform, *calls[place])] = worker, place
            for future in wait(busy, return_when=FIRST_COMPLETED).done:
                worker, place = busy[future]
                try:
                    result: Result | None = future.result()
                except BrokenProcessPool:
                    began = worker.process is not None
                    worker.end()
                    worker = Worker()
                    died[place] += 1
                    if began and died[place] < _ATTEMPTS:
                        waiting.appendleft(place)
                    del busy[future]
                    free.append(worker)
                    if began and died[place] < _ATTEMPTS:
                        continue
                    result = None if began else perform(*calls[place])
                else:
                    del busy[future]
                    free.append(worker)
                yield place, result
    finally:
        for worker in (*free, *(worker for worker, _ in busy.values())):
            worker.end()


class Worker:
    """A process that does one call at a time, and can be ended at any moment."""

    def __init__(self) -> None:
        with interrupts_blocked(), _on_its_own():
            # A new interpreter, not a copy of this one, whose threads a copy would lack.
            self._executor = ProcessPoolExecutor(
                1, get_context("spawn"), initializer=_watch, initargs=(os.getpid(),)
            )
            self._begun = self._submitted(os.getpid)
        # A process that ends waits for those that it started.
        self._at_exit = Finalize(None, self.end, exitpriority=10)

    @property
    def process(self) -> int | None:
        """Its number; None where it could not be started."""
        try:
            return self._begun.result()
        except BrokenProcessPool:
            return None

    def submit(self, perform: Callable[..., Result], *given: object) -> Future[Result]:
        """Have a call done; a process that died raises BrokenProcessPool as its result."""
        return self._submitted(partial(perform, *given))

    def _submitted(self, perform: Callable[[], Result]) -> Future[Result]:
        try:
            return self._executor.submit(perform)
        except (BrokenProcessPool, OSError) as error:  # it died before, or cannot be started
            failed: Future[Result] = Future()
            failed.set_exception(BrokenProcessPool(str(error)))
            return failed

    def end(self) -> None:
        """End the process, whatever it is at."""
        self._at_exit.cancel()
        process = self.process
        self._executor.shutdown(wait=False, cancel_futures=True)
        if process is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.kill(process, getattr(signal, "SIGKILL", signal.SIGTERM))


@contextmanager
def _on_its_own() -> Iterator[None]:
    """Start a process within that does not run the caller's script, from any process.

    One of a Dask cluster is not allowed to start others, as nobody would end them.
    """
    script, config = sys.modules["__main__"], current_process()._config  # type: ignore[attr-defined]
    sys.modules["__main__"], daemon = ModuleType("__main__"), config.get("daemon", False)
    config["daemon"] = False
    try:
        yield
    finally:
        sys.modules["__main__"], config["daemon"] = script, daemon


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Start processes within that never see an interrupt; this one sees it afterwards.

    Ctrl-C in a terminal goes to all processes that were started there. While one is loaded it
    cannot ignore interrupts yet, and would answer with an error of its own.

    Examples
    --------
    >>> with interrupts_blocked():
    ...     pass
    """
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    # Started by the first process, it would let interrupts in. Of what it cleans up after one that
    # was killed nobody need read.
    warned = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore"
    resource_tracker.ensure_running()
    os.environ.pop("PYTHONWARNINGS")
    if warned is not None:
        os.environ["PYTHONWARNINGS"] = warned
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ending_with_this(perform: Callable[Given, Result]) -> Callable[Given, Result]:
    """Return work whose process ends when this one does, for the processes of joblib.

    They wait for more work for minutes after whoever they work for was killed.

    Parameters
    ----------
    perform : callable
        That can be sent to another process.

    Returns
    -------
    callable
        Does the same, and in this process no more than that.

    Examples
    --------
    >>> ending_with_this(max)(1, 2)
    2
    """
    return partial(_watched, os.getpid(), perform)


def _watched(
    starter: int, perform: Callable[Given, Result], *given: Given.args, **named: Given.kwargs
) -> Result:
    if os.getppid() == starter:
        _watch(starter)
    return perform(*given, **named)


@lru_cache(maxsize=1)
def _watch(starter: int) -> None:
    if os.name == "nt":  # there nobody else becomes the parent
        return

    def watch() -> None:
        while os.getppid() == starter:
            time.sleep(_EVERY)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
