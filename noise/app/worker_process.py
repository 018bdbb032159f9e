"""Work beside the sound, in a process of its own, so that it never keeps the sound waiting.

Only the newest question counts: one that comes while another is answered takes the place of those
that wait. The process ends with the server, however that ends.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from importlib import import_module
from multiprocessing import get_context
from threading import Condition, Thread
from typing import TYPE_CHECKING, Generic, TypeVar

from models.errors import BushingNoiseError
from noise.base.processes import interrupts_blocked
from noise.batch import one_thread

if TYPE_CHECKING:
    from multiprocessing.connection import Connection


_REST = 0.5
"""Longest rest after an answer, as long as it took: half a processor is left to the sound [s]."""

_Question = TypeVar("_Question")
_Answer = TypeVar("_Answer")


class WorkerProcess(Generic[_Question, _Answer]):
    """A process that answers the newest question.

    Parameters
    ----------
    answer : str
        ``module:function`` from question to answer: only the process imports it, once it is nice.
    nice : int
        By how much everything else goes first, as of the command ``nice``.
    """

    def __init__(self, answer: str, nice: int = 0) -> None:
        self._answer, self._nice = answer, nice
        self._changed = Condition()
        self._wanted: tuple[_Question] | None = None
        self._newest: tuple[_Question, _Answer | None, str] | None = None
        self._current: tuple[_Question] | None = None
        self._stopped = False
        self._thread: Thread | None = None

    def ask(self, question: _Question) -> None:
        """Ask, and forget those questions that have not been begun."""
        with self._changed:
            self._ask(question)

    def answer_to(self, question: _Question) -> tuple[_Answer | None, str] | None:
        """Return the answer and what went wrong, None while there is none; asks if need be."""
        with self._changed:
            if self._newest is not None and self._newest[0] == question:
                return self._newest[1:]
            waiting = self._wanted or self._current
            if waiting is None or waiting[0] != question:
                self._ask(question)
            return None

    def _ask(self, question: _Question) -> None:
        self._wanted = (question,)
        if self._thread is None:
            self._thread = Thread(target=self._work, daemon=True)
            self._thread.start()
        self._changed.notify()

    @property
    def newest(self) -> tuple[_Question, _Answer | None, str] | None:
        """The question that was answered last, its answer, and what went wrong if it has none."""
        with self._changed:
            return self._newest

    @property
    def busy(self) -> bool:
        """Whether something that was asked is not answered yet."""
        with self._changed:
            return self._current is not None or self._wanted is not None

    def stop(self) -> None:
        """End the process."""
        with self._changed:
            self._stopped = True
            self._changed.notify()

    def _work(self) -> None:
        context = get_context("spawn")  # a copy of this process would lack its threads
        process = link = None
        while True:
            with self._changed:
                self._current = None
                self._changed.wait_for(lambda: self._wanted is not None or self._stopped)
                if self._stopped or self._wanted is None:
                    break
                self._current, self._wanted = self._wanted, None
                [question] = self._current
            if process is None or link is None or not process.is_alive():
                link, theirs = context.Pipe()
                arguments = (theirs, self._answer, self._nice)
                process = context.Process(target=_serve, args=arguments, daemon=True)
                with interrupts_blocked():
                    process.start()
                theirs.close()
            try:
                link.send(question)
                while not link.poll(0.2) and not self._stopped:
                    pass
                answer, error = (None, "") if self._stopped else link.recv()
            except (OSError, EOFError):
                answer, error = None, "the process beside the sound died"
            with self._changed:
                self._newest, self._current = (question, answer, error), None
        if process is not None:
            process.kill()


def _serve(link: Connection, answer: str, nice: int) -> None:
    with suppress(ValueError):  # a key in the terminal is for the server
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(AttributeError, OSError):
        os.nice(nice)
    with suppress(AttributeError, OSError):  # on Linux: nothing that waits for it is woken late
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    module, _, name = answer.partition(":")
    answered = getattr(import_module(module), name)
    with one_thread(), suppress(EOFError, OSError):
        while True:
            question = link.recv()
            began = time.perf_counter()
            try:
                link.send((answered(question), ""))
            except BushingNoiseError as error:
                link.send((None, str(error)))
            time.sleep(min(_REST, time.perf_counter() - began))
