"""``python -m noise.training.causes``: draw cases, and train the cause posterior on them."""

from __future__ import annotations

import argparse
from pathlib import Path

from models.errors import ParameterError
from noise.base.progress import say, track
from noise.diagnosis.cases.draw import SHARED
from noise.training.causes.store import CHUNK, draw_into


def main() -> int:
    """Draw, or train and save."""
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    drawing = commands.add_parser("draw", help="simulate cases whose causes are known, into files")
    drawing.add_argument(
        "--seeds", required=True, metavar="FIRST:LAST", type=_range,
        help="one case a seed; those below 400000 are for tests, those of the shipped posterior "
        "are in its card",
    )  # fmt: skip
    drawing.add_argument("--workers", type=int, default=1, help="processes")
    drawing.add_argument("--out", type=Path, required=True, metavar="FOLDER")
    options = parser.parse_args()
    try:
        return _draw(options)
    except ParameterError as error:
        say(f"error: {error}")
        return 2


def _draw(options: argparse.Namespace) -> int:
    paths = draw_into(options.out, options.seeds, options.workers)
    for _ in track(paths, "drawing", total=-(-len(options.seeds) // CHUNK), unit="file"):
        pass
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
