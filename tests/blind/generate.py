"""A whole set of cases on several processes; the data and the answers in folders apart."""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING

from .cases import run_case, write_case
from .design import draw_design

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["generate"]


def _one(out: Path, seed: int, index: int, kept_for: str) -> int:
    name = f"case-{index + 1:04d}"
    case = run_case(draw_design(seed, index, kept_for))
    write_case(case, out / "data" / name, out / "answers" / f"{name}.json")
    return index


def generate(out: Path, seed: int, cases: int, kept_for: str, workers: int) -> float:
    """Write cases into ``out/data`` and their answers into ``out/answers``; return the seconds."""
    if (out / "data").exists():
        raise SystemExit(f"{out / 'data'} is there already; name another folder")
    begun = time.perf_counter()
    if workers == 1:
        for index in range(cases):
            _one(out, seed, index, kept_for)
        return time.perf_counter() - begun
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        jobs = [pool.submit(_one, out, seed, index, kept_for) for index in range(cases)]
        for job in jobs:
            job.result()
    return time.perf_counter() - begun
