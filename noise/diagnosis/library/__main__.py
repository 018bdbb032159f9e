"""``python -m noise.diagnosis.library``: build the library and train the cause posterior on it."""

from __future__ import annotations

import argparse
from pathlib import Path

from noise.diagnosis.library.build import known_cases
from noise.diagnosis.training import train_posterior
from noise.progress import track

FIRST = 400_000
"""Seed of the first case; those below are for tests."""


def main() -> int:
    """Draw, train, save."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=2000, help="cases to draw (default: 2000)")
    parser.add_argument("--first", type=int, default=FIRST, help="seed of the first one")
    parser.add_argument("--seed", type=int, default=0, help="of the trees")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.npz")
    options = parser.parse_args()
    drawn = known_cases(options.first, options.cases, options.workers)
    cases = list(track(drawn, "drawing", total=options.cases, unit="case"))
    train_posterior(cases, seed=options.seed).save(options.out)
    print(options.out)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
