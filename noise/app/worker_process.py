"""Background process for work that must not delay the sound.

Only the newest question is answered: it replaces a question that is still waiting. The process
ends with the server.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from functools import cache
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.context import BaseContext
from threading import RLock
from typing import Any, Generic, TypeVar

from models.errors import BushingNoiseError
from noise.base.processes import Worker
from noise.batch.work import one_thread

_LOADED = ("noise.app.design_view", "noise.app.design_chart", "noise.labels.segments")
"""Modules that are loaded before a process starts."""

_Question = TypeVar("_Question")
_Answer = TypeVar("_Answer")


@cache
def process_context() -> BaseContext:
    """Return the context for starting processes: on Linux they start with modules loaded."""
    if sys.platform != "linux":
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload(list(_LOADED))
    return context


class WorkerProcess(Generic[_Question, _Answer]):
    """Process that answers the newest question.

    Parameters
    ----------
    answer : str
        ``module:function`` from question to answer, imported by the process.
    nice : int
        Niceness of the process.
    context : multiprocessing.context.BaseContext, optional
        Start method, by default `process_context`.
    """

    def __init__(self, answer: str, nice: int = 0, context: BaseContext | None = None) -> None:
        self._answer, self._nice, self._context = answer, nice, context
        self._lock = RLock()
        self._worker: Worker | None = None
        self._wanted: tuple[_Question] | None = None
        self._current: tuple[_Question] | None = None
        self._newest: tuple[_Question, _Answer | None, str] | None = None
        self._stopped = False
        self._share = (context or process_context()).RawValue("d", 0.0)

    def ask(self, question: _Question) -> None:
        """Replace the waiting question."""
        with self._lock:
            self._wanted = (question,)
            self._go_on()

    def answer_to(self, question: _Question) -> tuple[_Answer | None, str] | None:
        """Return answer and error message of a question; None while it is computed."""
        with self._lock:
            if self._newest is not None and self._newest[0] == question:
                return self._newest[1:]
            waiting = self._wanted or self._current
            if waiting is None or waiting[0] != question:
                self.ask(question)
            return None

    def share_of(self, question: _Question) -> float:
        """Return the share of a question that is done, as reported by `report_share`."""
        with self._lock:
            current = self._current is not None and self._current[0] == question
            return float(self._share.value) if current else 0.0

    @property
    def newest(self) -> tuple[_Question, _Answer | None, str] | None:
        """Last answered question, its answer and its error message."""
        return self._newest

    @property
    def busy(self) -> bool:
        """Whether a question is unanswered."""
        with self._lock:
            return self._current is not None or self._wanted is not None

    def stop(self) -> None:
        """End the process."""
        with self._lock:
            self._stopped, worker = True, self._worker
        if worker is not None:
            worker.end()

    def _go_on(self) -> None:
        if self._stopped or self._current is not None or self._wanted is None:
            return
        self._worker = self._worker or Worker(
            self._context or process_context(), _share_with, (self._share,)
        )
        self._current, self._wanted = self._wanted, None
        self._share.value = 0.0
        self._worker.submit(_answered, self._answer, self._nice, *self._current).add_done_callback(
            self._take
        )

    def _take(self, done: Future[tuple[_Answer | None, str]]) -> None:
        if done.cancelled():
            return
        try:
            answer, error = done.result()
        except BrokenProcessPool:
            answer, error, self._worker = None, "the process beside the sound died", None
        with self._lock:
            if self._current is not None:
                self._newest, self._current = (*self._current, answer, error), None
            self._go_on()


_shares: list[Any] = []
"""Shared memory for the share that is done, in a process that answers."""


def _share_with(share: object) -> None:
    _shares[:] = [share]


def report_share(share: float) -> None:
    """Report the share of the current question that is done; outside such a process, do nothing."""
    for one in _shares:
        one.value = share


@cache
def _function(answer: str, nice: int) -> Callable[[object], Any]:
    """Set the niceness and import the function, once per process."""
    with suppress(AttributeError, OSError):
        os.nice(nice)
    module, _, name = answer.partition(":")
    function: Callable[[object], Any] = getattr(import_module(module), name)
    return function


def _answered(answer: str, nice: int, question: object) -> tuple[Any, str]:
    with one_thread():
        try:
            return _function(answer, nice)(question), ""
        except BushingNoiseError as error:
            return None, str(error)
