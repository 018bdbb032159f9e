"""``python -m noise.training.causes``: draw cases and train the cause posterior on them."""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import chain
from pathlib import Path

from noise.base.progress import track
from noise.diagnosis.cases.draw import SHARED
from noise.training.causes.build import known_cases
from noise.training.causes.fit import train_posterior

SEEDS = ("400000:402000",)
"""Of cases, from each first one up to but not including the last; those below are for tests."""


def main() -> int:
    """Draw, train, save."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seeds", nargs="+", default=SEEDS, metavar="FIRST:LAST", type=_range,
        help=f"one case a seed (default: {' '.join(SEEDS)}); those of the shipped posterior are "
        "in its card",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=0, help="of the trees")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.npz")
    options = parser.parse_args()
    seeds = [_range(text) if isinstance(text, str) else text for text in options.seeds]
    drawn = chain.from_iterable(known_cases(each, options.workers) for each in seeds)
    cases = list(track(drawn, "drawing", total=sum(map(len, seeds)), unit="case"))
    posterior = train_posterior(cases, seed=options.seed)
    card = {**posterior.card, "seeds": [f"{each.start}:{each.stop}" for each in seeds]}
    replace(posterior, card=card).save(options.out)
    print(options.out)
    return 0


def _range(text: str) -> range:
    first, _, last = text.partition(":")
    if not (first.isdigit() and last.isdigit() and int(first) % SHARED == 0):
        raise argparse.ArgumentTypeError(
            f"{text!r} must be two whole numbers as in 400000:402000, the first a multiple of "
            f"{SHARED}"
        )
    return range(int(first), int(last))


if __name__ == "__main__":
    raise SystemExit(main())
