# ruff: noqa: T201
"""What a diagnosis costs: a training case and its parts, and the answers to a folder.

Run by hand: ``python tests/benchmarks/diagnosis.py [RIGS]``. Training cases of so many rigs
(default 5), four to a rig; then five recordings of 1 s of the thesis's rig, one of whose parameters
is off by 12 %, diagnosed by the first answer alone and as a whole. Processor seconds stand beside
the clock's, since the machine may have other work; cases are given by five recordings of 0.6 s.
"""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.diagnosis.case import Case
from noise.diagnosis.diagnose import diagnose_case
from noise.diagnosis.evidence.summary import NominalNumbers, summary
from noise.diagnosis.simulated.model_runs import with_offsets
from noise.training.causes.cases.draw import SHARED, draw_case
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Iterator

    from models.recording import Recording

FIRST = 900_000
"""Seed of the first case; those of training lie elsewhere."""

RIG = load_material_rig("fluorocarbon-thesis")

_spent: dict[str, tuple[float, float]] = {}


@contextmanager
def spent(on: str) -> Iterator[None]:
    """Add what is spent on something, by processor and by clock [s]."""
    cpu, clock = time.process_time(), time.perf_counter()
    yield
    before = _spent.get(on, (0.0, 0.0))
    _spent[on] = (
        before[0] + time.process_time() - cpu,
        before[1] + time.perf_counter() - clock,
    )


def cases_of_rigs(n_rigs: int) -> tuple[int, int, float]:
    """Draw and summarise cases; return their number, that of recordings, and seconds recorded."""
    n_cases, n_recordings, seconds = 0, 0, 0.0
    for first in range(FIRST, FIRST + SHARED * n_rigs, SHARED):
        nominal = None
        for seed in range(first, first + SHARED):
            try:
                with spent("draw"):
                    case = draw_case(seed)
                nominal = nominal or NominalNumbers(case.rig)
                for recording in case.recordings:
                    with spent("nominal"):
                        nominal.moments(recording)
                        paths = nominal.transfer_functions.whole(recording)
                    with spent("summary"):
                        summary(recording, case.rig, paths)
            except ParameterError:
                continue
            n_cases += 1
            n_recordings += len(case.recordings)
            seconds += sum(recording.duration for recording in case.recordings)
    return n_cases, n_recordings, seconds


def five_recordings() -> list[Recording]:
    """Recordings of 1 s of a rig whose stiffness is off."""
    other = with_offsets(RIG, {"elastomer_stiffness": 1.12})
    at = {"interference": 0.279e-3, "support_stiffness": 3745.0, "seconds": 1.0}
    speeds = (1.0, 1.5, 2.2, 3.0, 3.0)
    return [
        simulate(other, speed, **at, rng=np.random.default_rng(i)).recording
        for i, speed in enumerate(speeds)
    ]


def main() -> None:
    """Measure, and print."""
    cases_of_rigs(1)  # compiles
    _spent.clear()
    n_cases, n_recordings, seconds = cases_of_rigs(int(sys.argv[1]) if sys.argv[1:] else 5)
    print(f"{n_cases} cases of {n_recordings / n_cases:.1f} recordings of "
          f"{seconds / n_recordings:.2f} s")  # fmt: skip
    for on, (cpu, clock) in _spent.items():
        print(f"  {on:8} {1e3 * cpu / n_recordings:6.1f} ms a recording by the processor, "
              f"{1e3 * clock / n_recordings:6.1f} ms by the clock")  # fmt: skip
    total = sum(cpu for cpu, _ in _spent.values()) / seconds * 5 * 0.6
    print(f"  case of five recordings of 0.6 s: {total:.3f} s of the processor")
    recordings = tuple(five_recordings())
    case = Case(RIG, tuple(recording.name for recording in recordings), recordings)
    for name, quick in (("first answer", True), ("first answer again", True), ("whole", False)):
        _spent.clear()
        with spent(name):
            found = diagnose_case(case, quick=quick)
        cpu, clock = _spent[name]
        print(f"  {name:18} {cpu:6.1f} s of the processor, {clock:6.1f} s: {found.verdict}")


if __name__ == "__main__":
    main()
