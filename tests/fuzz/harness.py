"""Many inputs, each in a process that may hang or die of it, and what came of them.

Inputs run one after the other in a worker, in process, which is what makes them quick. The worker
says what came of each; where it takes too long it is ended, where it dies a new one goes on with
the next.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from tests.fuzz.judged import MOST_MEMORY

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from multiprocessing.connection import Connection

    from tests.fuzz.judged import Input, Outcome

__all__ = ["LONGEST", "Finding", "Tally", "try_inputs"]

LONGEST = 20.0
"""Of an input [s]."""

SOON = 3.0
"""After which a library that goes in a circle is ended here [s]; users wait longer."""

_FIRST = 600.0
"""Of the valid files, with which everything is loaded, and compiled where it is not yet [s]."""

_LAST = "last.pickle"


@dataclass(frozen=True)
class Finding:
    """A fault: which input, by its numbers and as it was, and what happened."""

    name: str
    input: Input | None
    call: str
    fault: str


@dataclass
class Tally:
    """What came of inputs."""

    codes: Counter[tuple[str, int]] = field(default_factory=Counter)
    findings: list[Finding] = field(default_factory=list)
    memory: int = 0
    longest: float = 0.0
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of inputs."""
        return sum(self.codes.values())

    def summary(self) -> str:
        """Return a few lines: how many, how they ended, the largest and the longest."""
        ends = Counter[int]()
        for (_, code), times in self.codes.items():
            ends[code] += times
        said = ", ".join(f"{times} with {code}" for code, times in sorted(ends.items()))
        return (
            f"{self.n} inputs ended: {said}\n"
            f"{len(self.findings)} findings; memory up to {self.memory / 1e6:.0f} MB; the longest "
            f"took {self.longest:.2f} s"
        )


def try_inputs(inputs: Sequence[tuple[int, int] | Input]) -> Iterator[Tally]:
    """Try inputs one by one; yield what came of all so far, after each.

    Parameters
    ----------
    inputs : sequence
        Each a seed and a number, or an input as it is.
    """
    tally = Tally()
    with tempfile.TemporaryDirectory() as folder:
        worker = _Worker(Path(folder))
        try:
            tally.findings += worker.begin()
            yield tally
            for one in inputs:
                begun = time.perf_counter()
                call, outcome = worker.ask(one)
                took = time.perf_counter() - begun
                if not isinstance(outcome, str) and outcome.memory > MOST_MEMORY:
                    worker.end()  # what it needs shows in a process that has done nothing before
                    tally.findings += worker.begin()
                    call, outcome = worker.ask(one)
                tally.longest = max(tally.longest, took)
                tally.seconds[call] = tally.seconds.get(call, 0.0) + took
                code = -1
                if isinstance(outcome, str):
                    faults: tuple[str, ...] = (outcome,)
                else:
                    code, faults = outcome.code, outcome.faults
                    tally.memory = max(tally.memory, outcome.memory)
                tally.codes[call, code] += 1
                name = " ".join(map(str, one)) if isinstance(one, tuple) else "corpus"
                tally.findings += [Finding(name, worker.last(), call, fault) for fault in faults]
                yield tally
        finally:
            worker.end()


class _Worker:
    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process: multiprocessing.process.BaseProcess | None = None

    def begin(self) -> list[Finding]:
        """Start it, and let it try the valid files; return those that are not taken."""
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs, self._folder), daemon=True)
        self._process.start()
        theirs.close()
        if not self._pipe.poll(_FIRST):
            raise TimeoutError(f"the valid files took longer than {_FIRST:.0f} s")
        return [Finding("valid", None, call, fault) for call, fault in self._pipe.recv()]

    def ask(self, one: tuple[int, int] | Input) -> tuple[str, Outcome | str]:
        """Return the call of an input, and the outcome or what became of the worker."""
        self._pipe.send(one)
        call = "?"
        try:
            call = self._pipe.recv()
            if self._pipe.poll(LONGEST):
                return call, self._pipe.recv()
            fault = f"hang: over {LONGEST:.0f} s"
        except EOFError:
            assert self._process is not None
            self._process.join()
            fault = f"crash: the process ended with {self._process.exitcode}: {self._printed()}"
        self.end()
        self.begin()
        return call, fault

    def last(self) -> Input:
        """Return the input as it was tried: what a library writes may hold the time of day."""
        found: Input = pickle.loads((self._folder / _LAST).read_bytes())
        return found

    def _printed(self) -> str:
        return (self._folder / "printed.txt").read_text(errors="replace")[-300:]

    def end(self) -> None:
        """Kill it."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()


def _work(pipe: Connection, folder: Path) -> None:
    """Try what is asked for, until nobody asks."""
    printed = os.open(folder / "printed.txt", os.O_RDWR | os.O_CREAT | os.O_APPEND)
    os.dup2(printed, 2)  # what libraries print past Python is looked at as well

    from noise.recordings.formats import isolated
    from tests.fuzz.calls import CALLS
    from tests.fuzz.judged import Input, input_of, judge
    from tests.fuzz.valid_files import write_valid_files

    valid, place = folder / "valid", folder / "place"
    if not valid.exists():
        valid.mkdir()
        write_valid_files(valid)
    refused = []
    for name, call in CALLS.items():
        outcome = judge(Input(name, (valid / call.valid).read_bytes()), valid, place)
        expected = (0,) if name not in _REFUSED else (1, 2)
        if outcome.code not in expected or outcome.faults:
            refused.append((name, f"{outcome.code}, {outcome.faults}: {outcome.said}"))
    isolated._PATIENCE = SOON  # from here on the libraries are loaded
    pipe.send(refused)
    while True:
        try:
            asked = pipe.recv()
        except EOFError:
            return
        case = input_of(*asked, valid) if isinstance(asked, tuple) else asked
        (folder / _LAST).write_bytes(pickle.dumps(case))
        pipe.send(case.call)
        pipe.send(judge(case, valid, place))


_REFUSED = {"identify", "frf", "calibrator", "diagnose", "rig, diagnosed", "rig, identified"}
"""Calls that need more than a short noise, and say so once they have read it."""
