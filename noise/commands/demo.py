"""``bushing-noise demo``: the whole chain, once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import say
from noise.commands import options as opt

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

__all__ = ["configure", "run"]

_DEFAULT_OUT = "bushing-noise-demo"


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Run the whole chain: simulate a creak, a squawk, a squeal and a silent run, make them "
        "audible, compute their features, label them, and write a report. The folder then holds "
        "recordings/, audio/, features.csv, labels.csv, report.html, and hits/, blows of a hammer "
        "on the modelled clamp for `bushing-noise frf`."
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(_DEFAULT_OUT),
        metavar="FOLDER",
        help=f"folder for the results (default: {_DEFAULT_OUT})",
    )
    opt.add_seed(parser, "seed of the sensors' noise")


def run(options: Namespace) -> int:
    """Run the demonstration."""
    opt.check_folder(options.out)
    say(f"writing the demonstration into {options.out}")
    from noise.demo import run_demo

    run_demo(options.out, seed=options.seed)
    print(options.out / "report.html")
    return 0
