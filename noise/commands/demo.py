"""``bushing-noise demo``: the whole chain, once."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from noise.base.progress import say
from noise.commands.options import Option, check_folder, seed

_DEFAULT_OUT = "bushing-noise-demo"


DESCRIPTION = (
    "Run the whole chain: simulate a creak, a squawk, a squeal and a silent run, make them "
    "audible, compute their features, label them, and write a report. The folder then holds "
    "recordings/, audio/, features.csv, labels.csv, report.html, and hits/, blows of a hammer "
    "on the modelled clamp for `bushing-noise frf`."
)

OPTIONS = (
    Option("--out FOLDER", Path, Path(_DEFAULT_OUT)).help("folder for the results"),
    seed("seed of the sensors' noise"),
)


def run(options: Namespace) -> int:
    """Run the demonstration."""
    check_folder(options.out)
    say(f"writing the demonstration into {options.out}")
    from noise.demo import run_demo

    run_demo(options.out, seed=options.seed)
    print(options.out / "report.html")
    return 0
