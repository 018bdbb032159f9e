"""Work beside the sound, in a process of its own, so that it never keeps the sound waiting.

Only the newest question counts: one that comes while another is answered takes the place of those
that wait. The process ends with the server, however that ends.
"""

from __future__ import annotations

import os
import sys
import time
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

_REST = 0.5
"""Longest rest between answers, as long as one took: half a processor is left to the sound [s]."""

_LOADED = ("noise.app.design_sound", "noise.app.design_chart", "noise.labels.segments")
"""Modules that take seconds to be loaded."""

_Question = TypeVar("_Question")
_Answer = TypeVar("_Answer")


@cache
def process_context() -> BaseContext:
    """Return a context of processes that begin with all modules loaded; of new ones off Linux."""
    if sys.platform != "linux":
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload(list(_LOADED))
    return context


class WorkerProcess(Generic[_Question, _Answer]):
    """A process that answers the newest question.

    Parameters
    ----------
    answer : str
        ``module:function`` from question to answer: only the process imports it, once it is nice.
    nice : int
        By how much everything else goes first, as of the command ``nice``.
    context : multiprocessing.context.BaseContext, optional
        In which it is started, by default `process_context`.
    """

    def __init__(self, answer: str, nice: int = 0, context: BaseContext | None = None) -> None:
        self._answer, self._nice, self._context = answer, nice, context
        self._lock = RLock()
        self._worker: Worker | None = None
        self._wanted: tuple[_Question] | None = None
        self._current: tuple[_Question] | None = None
        self._newest: tuple[_Question, _Answer | None, str] | None = None
        self._stopped = False

    def ask(self, question: _Question) -> None:
        """Ask, and forget those questions that have not been begun."""
        with self._lock:
            self._wanted = (question,)
            self._go_on()

    def answer_to(self, question: _Question) -> tuple[_Answer | None, str] | None:
        """Return the answer and what went wrong, None while there is none; asks if need be."""
        with self._lock:
            if self._newest is not None and self._newest[0] == question:
                return self._newest[1:]
            waiting = self._wanted or self._current
            if waiting is None or waiting[0] != question:
                self.ask(question)
            return None

    @property
    def newest(self) -> tuple[_Question, _Answer | None, str] | None:
        """The question that was answered last, its answer, and what went wrong if it has none."""
        return self._newest

    @property
    def busy(self) -> bool:
        """Whether something that was asked is not answered yet."""
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
        self._worker = self._worker or Worker(self._context or process_context())
        self._current, self._wanted = self._wanted, None
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


@cache
def _answers(answer: str, nice: int) -> list[Any]:
    """Be nice, import what answers, and keep until when there is a rest [s]."""
    with suppress(AttributeError, OSError):
        os.nice(nice)
    with suppress(AttributeError, OSError):  # on Linux: nothing that waits for it is woken late
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    module, _, name = answer.partition(":")
    return [getattr(import_module(module), name), 0.0]


def _answered(answer: str, nice: int, question: object) -> tuple[Any, str]:
    known = _answers(answer, nice)
    time.sleep(max(0.0, known[1] - time.perf_counter()))
    began = time.perf_counter()
    with one_thread():
        try:
            return known[0](question), ""
        except BushingNoiseError as error:
            return None, str(error)
        finally:
            ended = time.perf_counter()
            known[1] = ended + min(_REST, ended - began)
