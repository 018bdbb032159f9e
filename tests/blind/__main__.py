"""``python -m tests.blind generate --out DIR --seed N --cases N [--sealed]``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .effects import DEVELOPMENT, SEALED
from .generate import generate


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="python -m tests.blind")
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("generate", help="write cases, and their answers apart")
    making.add_argument("--out", type=Path, required=True)
    making.add_argument("--seed", type=int, required=True)
    making.add_argument("--cases", type=int, required=True)
    making.add_argument("--workers", type=int, default=2)
    making.add_argument("--sealed", action="store_true", help="forms kept for the sealed set")
    given = parser.parse_args(arguments)
    kept_for = SEALED if given.sealed else DEVELOPMENT
    seconds = generate(given.out, given.seed, given.cases, kept_for, given.workers)
    sys.stderr.write(f"{given.cases} cases in {seconds:.0f} s\n")


if __name__ == "__main__":
    main()
