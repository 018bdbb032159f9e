"""``python -m tests.studies.next_to_check``: how much 30 corrections teach, by which order.

Pages of `next_to_check.md`. ``drawn`` is the folder by which an order was chosen, ``real`` and
``variants`` need the recordings that ``BUSHING_NOISE_REAL_DATA`` names.
"""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import nullcontext
from pathlib import Path

import numpy as np

from tests.studies.next_to_check.experiment import (
    at_random,
    by_next_to_check,
    errors,
    labels_of,
    learned,
    rounds,
    said,
    simulated,
    sound_alone,
)
from tests.studies.next_to_check.folders import (
    LEFT_OUT,
    drawn_clips,
    halves,
    known_and_folder,
    real_clips,
    variants,
)

CORRECTIONS = 30
_VARIANTS = 9


def main() -> None:
    """Correct, learn, and print a line for each time; then the page's table."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.next_to_check")
    parser.add_argument("folder", choices=("drawn", "real", "variants"))
    parser.add_argument("--work", type=Path, required=True, help="keeps what was drawn")
    parser.add_argument("--partitions", type=int, default=10, metavar="N")
    parser.add_argument("--random", type=int, default=2, metavar="N", help="of each partition")
    parser.add_argument("--samples", type=int, default=600, metavar="N", help="as of `open`")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="learn from sound alone, 60 rounds of trees instead of 220, and leave calibration and "
        "thresholds as they were",
    )
    options = parser.parse_args()
    with rounds(60) if options.quick else nullcontext():
        _study(options)


def _study(options: argparse.Namespace) -> None:
    options.work.mkdir(parents=True, exist_ok=True)
    clips = _clips(options.folder, options.work)
    samples = simulated(options.work / f"samples{options.samples}.joblib", options.samples)
    if options.quick:
        samples = sound_alone(samples)
    if options.folder == "drawn":
        samples = [sample for sample in samples if sample.name not in LEFT_OUT]
    known, folder = known_and_folder(clips)
    start = learned(samples, known, [])
    kept = start if options.quick else None
    rows = dict(zip(folder, labels_of(folder, start), strict=True))
    found = []
    for seed in range(options.partitions):
        pool, held = halves(folder, seed)
        before = _errors(held, pool, [], rows)
        chosen = [by_next_to_check(pool, [rows[clip] for clip in pool], CORRECTIONS)]
        chosen += [at_random(pool, 100 * seed + i, CORRECTIONS) for i in range(options.random)]
        after = [
            _errors(held, pool, corrected, dict(zip(folder, labels_of(folder, again), strict=True)))
            for corrected in chosen
            for again in [learned(samples, known, corrected, kept)]
        ]
        noises = [sum(clip.label != "unknown" for clip in corrected) for corrected in chosen]
        found.append((before, *after))
        names = ["before", "next to check", *["random"] * options.random]
        for name, number, of_one in zip(names, ["", *noises], found[-1], strict=True):
            _print(f"{seed} {name} {number}", of_one)
    for name in found[0][0]:
        table = np.array([[one[name] for one in row] for row in found])
        _print_fall(name, table)


def _errors(held, pool, corrected, rows) -> dict[str, float]:
    """Return errors of what is held out, and of the folder, where what was corrected is right."""
    there = [said(clip, rows[clip]) if clip in corrected else rows[clip] for clip in pool]
    of_folder = errors(pool, there)
    return errors(held, [rows[clip] for clip in held]) | {
        f"folder {name}": of_folder[name] for name in ("all", "mean")
    }


def _clips(folder: str, work: Path):
    if folder == "drawn":
        return drawn_clips(work)
    clips = real_clips(Path(os.environ["BUSHING_NOISE_REAL_DATA"]) / "labelled", work)
    return clips if folder == "real" else [*clips, *variants(clips, _VARIANTS, work)]


def _print(what: str, found: dict[str, float]) -> None:
    sys.stdout.write(f"{what}: {', '.join(f'{k} {v:.4f}' for k, v in found.items())}\n")
    sys.stdout.flush()


def _print_fall(name: str, table) -> None:
    """Print before, by next to check, at random, how much lower, and the ratio of both falls.

    Each is a mean over the partitions with its interval of 90 %, by drawing them again.
    """
    before, ours, others = table[:, 0], table[:, 1], table[:, 2:].mean(axis=1)
    rng = np.random.default_rng(0)
    again = rng.integers(len(table), size=(4000, len(table)))
    falls = [before - after for after in (ours, others)]
    with np.errstate(divide="ignore", invalid="ignore"):  # some fall by nothing
        ratio = falls[0][again].mean(axis=1) / falls[1][again].mean(axis=1)
    told = []
    for x in (before, ours, others, falls[0] - falls[1]):
        low, high = np.quantile(x[again].mean(axis=1), (0.05, 0.95))
        told.append(f"{x.mean():.4f} ({low:.4f} to {high:.4f})")
    low, high = np.nanquantile(ratio, (0.05, 0.95))
    sys.stdout.write(
        f"| {name} | {' | '.join(told)} | {falls[0].mean() / falls[1].mean():.2f} "
        f"({low:.2f} to {high:.2f}) |\n"
    )


if __name__ == "__main__":
    main()
