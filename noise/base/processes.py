"""Process pool that survives the death of its workers.

A worker gets one call at a time, so that the call at which it died is known. That call is tried
once more in a new process. Where no process can be started, the work is done in this one. A worker
exits when its parent is gone, ignores interrupts, and does not run the caller's script again.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import current_process, get_context, parent_process, resource_tracker
from multiprocessing.context import BaseContext
from multiprocessing.util import Finalize
from types import ModuleType
from typing import Any, TypeVar

Result = TypeVar("Result")

_ATTEMPTS = 2


def spread_over_processes(
    perform: Callable[..., Result], calls: Sequence[tuple[Any, ...]], workers: int
) -> Generator[tuple[int, Result | None]]:
    """Run calls in several processes.

    Parameters
    ----------
    perform : callable
        Function that can be pickled.
    calls : sequence of tuple
        Arguments of each call.
    workers : int
        Number of processes.

    Yields
    ------
    index : int
        Index of a call, in the order of completion.
    result : object
        Return value; None if two processes died at the call.
    """
    waiting, deaths = deque(range(len(calls))), Counter[int]()
    free = [Worker() for _ in range(min(workers, len(calls)))]
    busy: dict[Future[Result], tuple[Worker, int]] = {}
    try:
        while waiting or busy:
            while waiting and free:
                worker, index = free.pop(), waiting.popleft()
                busy[worker.submit(perform, *calls[index])] = worker, index
            for future in wait(busy, return_when=FIRST_COMPLETED).done:
                worker, index = busy.pop(future)
                free.append(worker)
                try:
                    result: Result | None = future.result()
                except BrokenProcessPool:
                    started = worker.process is not None
                    worker.end()
                    free[-1] = Worker()
                    deaths[index] += 1
                    if started and deaths[index] < _ATTEMPTS:
                        waiting.appendleft(index)
                        continue
                    result = None if started else perform(*calls[index])
                yield index, result
    finally:
        for worker in (*free, *(worker for worker, _ in busy.values())):
            worker.end()


class Worker:
    """Process that runs one call at a time and can be killed at any moment.

    Parameters
    ----------
    context : multiprocessing.context.BaseContext, optional
        In which it starts; by default in a new interpreter: a forked copy would lack the threads
        of this one.
    setup : callable, optional
        Called with `arguments` in the process when it starts; they may be shared memory.
    arguments : tuple
    """

    def __init__(
        self,
        context: BaseContext | None = None,
        setup: Callable[..., object] | None = None,
        arguments: tuple[Any, ...] = (),
    ) -> None:
        with interrupts_blocked(), _independent_start():
            self._executor = ProcessPoolExecutor(
                1,
                context or get_context("spawn"),
                initializer=_exit_with_starter,
                initargs=(setup, arguments),
            )
            self._process_id = self.submit(os.getpid)
        # Without this the interpreter would wait at exit for a busy worker.
        self._at_exit = Finalize(None, self.end, exitpriority=10)

    @property
    def process(self) -> int | None:
        """Process identifier; None if the process could not be started."""
        try:
            return self._process_id.result()
        except BrokenProcessPool:
            return None

    def submit(self, perform: Callable[..., Result], *arguments: object) -> Future[Result]:
        """Start a call; the future of a dead process raises BrokenProcessPool."""
        try:
            return self._executor.submit(perform, *arguments)
        except (BrokenProcessPool, OSError) as error:  # it died, or cannot be started
            failed: Future[Result] = Future()
            failed.set_exception(BrokenProcessPool(str(error)))
            return failed

    def end(self) -> None:
        """Kill the process."""
        self._at_exit.cancel()
        process = self.process
        self._executor.shutdown(wait=False, cancel_futures=True)
        if process is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.kill(process, getattr(signal, "SIGKILL", signal.SIGTERM))


@contextmanager
def _independent_start() -> Iterator[None]:
    """Start processes that do not run the caller's script, even from a daemonic process.

    Python forbids daemonic processes to have children.
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
    """Start processes that ignore interrupts; this process receives them after the block.

    Ctrl-C in a terminal interrupts all processes started there. A process that is still loading
    cannot ignore it and would print a traceback.

    Examples
    --------
    >>> with interrupts_blocked():
    ...     pass
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    # Starting the resource tracker unblocks interrupts, so it is started before. Its warnings about
    # resources of killed workers are no use to anyone.
    warning_filters = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = "ignore"
    resource_tracker.ensure_running()
    os.environ.pop("PYTHONWARNINGS")
    if warning_filters is not None:
        os.environ["PYTHONWARNINGS"] = warning_filters
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _exit_with_starter(setup: Callable[..., object] | None, arguments: tuple[Any, ...]) -> None:
    """Start a thread that exits the process when the process that started it has ended."""
    if setup is not None:
        setup(*arguments)
    starter = parent_process()

    def wait_for_end() -> None:
        if starter is not None:
            starter.join()
            os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()
