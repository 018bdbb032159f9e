"""A whole set of cases on several processes; the data and the answers in folders apart.

The sealed forms are drawn here as well, but only for whoever names the log, in which the opening
is written before the first case is made.
"""

from __future__ import annotations

import json
import subprocess
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from .cases import run_case, write_case
from .design import draw_design
from .effects import DEVELOPMENT, SEALED
from .gap import gaps_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["LOG", "Wanted", "append_to_log", "commit", "each", "generate", "generate_sealed"]

LOG = Path(__file__).parent / "sealed_log.jsonl"


@dataclass(frozen=True)
class Wanted:
    """Which cases to make: of each kind of bench the first `cases` of a seed.

    `block` is as in `design.BLOCKS`, `benches` names kinds as `benches.KINDS` does.
    """

    seed: int
    cases: int
    block: str = "shares"
    benches: tuple[str, ...] = ("quiet",)


@contextmanager
def each(workers: int) -> Iterator[Callable]:
    """Give a map over several processes; one worker stays in this process."""
    if workers == 1:
        yield map
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield pool.map


def _one(job: tuple[Path, Path, int, int, str, str, str]) -> None:
    data, answers, seed, index, kept_for, block, bench = job
    name = f"case-{index + 1:04d}" if bench == "quiet" else f"{bench}-{index + 1:04d}"
    case = run_case(draw_design(seed, index, kept_for, block, bench))
    case = replace(case, answer=case.answer | gaps_of(case))
    write_case(case, data / name, answers / f"{name}.json")


def _make(data: Path, answers: Path, wanted: Wanted, kept_for: str, workers: int) -> float:
    if data.exists():
        raise SystemExit(f"{data} is there already; name another folder")
    begun = time.perf_counter()
    jobs = [
        (data, answers, wanted.seed, i, kept_for, wanted.block, bench)
        for bench in wanted.benches
        for i in range(wanted.cases)
    ]
    with each(workers) as mapped:
        list(mapped(_one, jobs))
    return time.perf_counter() - begun


def generate(out: Path, wanted: Wanted, workers: int) -> float:
    """Write development cases into ``out/data``, answers into ``out/answers``; return seconds."""
    return _make(out / "data", out / "answers", wanted, DEVELOPMENT, workers)


def commit(folder: Path = LOG.parent) -> tuple[str, bool | None]:
    """Return the commit that a folder is at, and whether something is changed since."""
    said = []
    for call in (["rev-parse", "HEAD"], ["status", "--porcelain"]):
        try:
            done = subprocess.run(
                ["git", "-C", str(folder), *call], capture_output=True, text=True, check=True
            )
        except (OSError, subprocess.CalledProcessError):
            return "unknown", None
        said.append(done.stdout.strip())
    return said[0], bool(said[1])


def append_to_log(log: Path, entry: dict) -> None:
    """Add a line to the log of the sealed set: an opening, or what one gave."""
    with log.open("a", encoding="utf-8") as file:
        file.write(json.dumps(entry) + "\n")


def _log_opening(log: Path, **about: object) -> str:
    """Write that the sealed set is opened, by what and for what; return the time as its name."""
    at = datetime.now(UTC).isoformat(timespec="microseconds")
    name, dirty = commit()
    append_to_log(log, {"opened": at, "commit": name, "dirty": dirty, **about})
    return at


def generate_sealed(
    data: Path, answers: Path, wanted: Wanted, workers: int, *, log: Path, about: str
) -> str:
    """Log that the sealed set is opened, then write its cases; return the opening's name."""
    opened = _log_opening(
        log, seed=wanted.seed, cases=wanted.cases, block=wanted.block, benches=wanted.benches,
        about=about,
    )  # fmt: skip
    _make(data, answers, wanted, SEALED, workers)
    return opened
