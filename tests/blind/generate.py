"""A whole set of cases on several processes; the data and the answers in folders apart."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing import get_context
from typing import TYPE_CHECKING

from .cases import run_case, write_case
from .design import draw_design
from .effects import DEVELOPMENT, SEALED
from .gap import gaps_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

__all__ = ["SEALED_SEEDS", "each", "generate"]

SEALED_SEEDS = 1000
"""From which on seeds are of the sealed set."""


@contextmanager
def each(workers: int) -> Iterator[Callable]:
    """Give a map over several processes; one worker stays in this process."""
    if workers == 1:
        yield map
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield pool.map


def _one(job: tuple[Path, int, int, str, str]) -> None:
    out, seed, index, block, bench = job
    name = f"{bench}-{index + 1:04d}"
    kept_for = SEALED if seed >= SEALED_SEEDS else DEVELOPMENT
    case = run_case(draw_design(seed, index, kept_for, block, bench))
    case = replace(case, answer=case.answer | gaps_of(case))
    write_case(case, out / "data" / name, out / "answers" / f"{name}.json")


def generate(
    out: Path, seed: int, cases: int, block: str, benches: Sequence[str], workers: int
) -> None:
    """Write cases into ``out/data`` and answers into ``out/answers``.

    Of each kind of bench the first `cases` of a seed; `block` is as in `design.BLOCKS`.
    """
    if (out / "data").exists():
        raise SystemExit(f"{out / 'data'} is there already; name another folder")
    jobs = [(out, seed, i, block, bench) for bench in benches for i in range(cases)]
    with each(workers) as mapped:
        list(mapped(_one, jobs))
