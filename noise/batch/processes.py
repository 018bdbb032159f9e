"""Work on several processes of this machine, any of which may die.

Each process is given one recording at a time, so that when one dies it is known which recording it
was at. That one is tried once more, in a new process; if that dies as well, the recording is
refused. Where no process can be started the work is done in this one. A process ends by itself when
the one that feeds it is gone.
"""

from __future__ import annotations

import signal
from collections import deque
from multiprocessing import connection, get_context
from typing import TYPE_CHECKING

from noise.batch.interrupts import interrupts_blocked
from noise.batch.rows import parts_of, stored
from noise.batch.work import Done, one_thread, perform, refusal

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator, Sequence
    from multiprocessing.connection import Connection

    from noise.batch.rows import Cell
    from noise.batch.work import Job, Work

__all__ = ["DIED", "perform_on_processes"]

DIED = "the process that worked on it died, and so did a second one; is there enough memory?"
"""Why a recording is refused that no process survives."""

_ATTEMPTS = 2


def perform_on_processes(
    work: Work, jobs: Sequence[Job], workers: int
) -> Generator[tuple[Job, Done]]:
    """Do the work on `workers` processes; yields in the order in which recordings are done."""
    waiting = deque(jobs)
    tried = dict.fromkeys((job.index for job in jobs), 0)
    team = [_Worker(work) for _ in range(min(workers, len(jobs)))]
    try:
        while waiting or any(worker.job for worker in team):
            for place, worker in enumerate(team):
                if waiting and worker.job is None:
                    job = waiting.popleft()
                    if not worker.give(job):  # it died before it was given anything
                        worker.end()
                        team[place] = _Worker(work)
                        if not team[place].give(job):
                            yield job, _performed_here(work, job)
            given = [worker.link for worker in team if worker.job]
            ready = connection.wait(given) if given else []
            for place, worker in enumerate(team):
                if worker.link not in ready or worker.job is None or worker.begins():
                    continue
                job = worker.job
                done = worker.take()
                if done is None:
                    began = worker.began
                    worker.end()
                    team[place] = _Worker(work)
                    tried[job.index] += 1
                    if tried[job.index] < _ATTEMPTS:
                        waiting.appendleft(job)
                        continue
                    done = refusal(work, job.name, DIED) if began else _performed_here(work, job)
                yield job, done
    finally:
        for worker in team:
            worker.end()


def _performed_here(work: Work, job: Job) -> Done:
    """Do in this process what no other one can be started for."""
    with one_thread():
        return perform(work, job.path, job.name)


class _Worker:
    """A process that works on one recording at a time."""

    def __init__(self, work: Work) -> None:
        # A new interpreter, not a copy of this one, whose threads a copy would lack.
        context = get_context("spawn")
        self.link, theirs = context.Pipe()
        self.job: Job | None = None
        self.began = False
        self._process = context.Process(target=_serve, args=(theirs, work), daemon=True)
        with interrupts_blocked():
            self._process.start()
        theirs.close()

    def give(self, job: Job) -> bool:
        """Hand over a recording; return whether there was anyone to take it."""
        try:
            self.link.send(job)
        except OSError:
            return False
        self.job = job
        return True

    def begins(self) -> bool:
        """Return whether all that it has said is that it began."""
        if self.began:
            return False
        try:
            self.began = bool(self.link.recv())
        except (EOFError, OSError):
            return False
        return True

    def take(self) -> Done | None:
        """Return what came of the recording, None where the process died at it."""
        self.job = None
        try:
            return self._received()
        except (EOFError, OSError):
            return None

    def _received(self) -> Done:
        """Wait for all rows, which come in parts, and what goes with them."""
        ended: list[Done] = []

        def rows() -> Iterator[list[Cell]]:
            while not isinstance(answer := self.link.recv(), Done):
                yield from answer
            ended.append(answer)

        kept = stored(rows())
        return ended[0]._replace(rows=kept)

    def end(self) -> None:
        """End the process, whatever it is at."""
        self.link.close()
        self._process.kill()
        self._process.join()


def _serve(link: Connection, work: Work) -> None:
    """Work until there is nobody left to work for."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # meant for the process that feeds this one
    work.prepare()
    with one_thread():
        try:
            link.send(True)
            while True:
                job: Job = link.recv()
                done = perform(work, job.path, job.name)
                for part in parts_of(done.rows):
                    link.send(part)
                link.send(done._replace(rows=[]))
        except (EOFError, OSError):
            return
