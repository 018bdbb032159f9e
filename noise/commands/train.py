"""``bushing-noise train``: the classifier again, from simulation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.commands import options as opt
from noise.commands.targets import check_target
from noise.progress import say, track

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterable

    from noise.classifier.training import Sample

__all__ = ["configure", "run"]


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Build the classifier again from simulated runs and made-up sounds that are none of the "
        "three noises; the same seed gives the same classifier. It takes minutes. Use it with "
        "`bushing-noise label --classifier FILE.npz`."
    )
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="FILE.npz",
        help="file for the classifier (required)",
    )
    opt.add_seed(parser, "seed of the training samples and of the forest")


def run(options: Namespace) -> int:
    """Train, save, and tell the score."""
    if options.out.suffix.lower() != ".npz" or options.out.is_dir():
        raise ParameterError(f"--out {options.out}: a classifier is a file that ends in .npz")
    check_target(options.out)
    say("preparing")
    from noise.classifier.training import train

    def progress(samples: Iterable[Sample], total: int) -> Iterable[Sample]:
        return track(samples, "simulating", total=total, unit="training sample")

    classifier = train(seed=options.seed, progress=progress)
    classifier.save(options.out)
    say(f"trained: {_scores(classifier.card)}")
    print(options.out)
    return 0


def _scores(card: object) -> str:
    test = card.get("test") if isinstance(card, dict) else None
    if not isinstance(test, dict):
        return "no score"
    return ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in test.items())
