"""``python -m noise.training.causes``: draw cases, and train the cause posterior on them."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from models.errors import ParameterError
from noise.base.files import check_target
from noise.base.progress import counted, say, track
from noise.diagnosis.causes.location import learn_stage_nulls
from noise.training.causes.cases.draw import SHARED
from noise.training.causes.fit import CHUNK, draw_into, load_cases, null_scale, train_posterior


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
    training = commands.add_parser("train", help="train the posterior on cases that were drawn")
    training.add_argument("folder", type=Path, metavar="FOLDER", help="of draw")
    training.add_argument("--seed", type=int, default=0, help="of the trees")
    training.add_argument("--out", type=Path, required=True, metavar="FILE.npz")
    training.add_argument(
        "--stages", type=Path, metavar="FILE.npz",
        help="also learn what stages differ by without a cause",
    )  # fmt: skip
    options = parser.parse_args()
    try:
        if options.command == "draw":
            paths = draw_into(options.out, options.seeds, options.workers)
            total = -(-len(options.seeds) // CHUNK)
            for _ in track(paths, "drawing", total=total, unit="file"):
                pass
        else:
            _train(options)
    except ParameterError as error:
        say(f"error: {error}")
        return 2
    print(options.out)
    return 0


def _train(options: argparse.Namespace) -> None:
    check_target(options.out)
    cases = load_cases(options.folder)
    say(f"training on {counted(len(cases), 'case')}")
    posterior = train_posterior(cases, seed=options.seed)
    card = {**posterior.card, "seeds": f"{cases[0].seed}:{cases[-1].seed + 1}"}
    replace(posterior, card=card).save(options.out)
    if options.stages is not None:
        check_target(options.stages, "--stages")
        nulls = [case for case in cases if case.truth.kind == "none"]
        names = tuple(sorted({name for case in nulls for name in case.table.names}))
        scale = null_scale(nulls, names)
        learn_stage_nulls([case.table for case in nulls], names, scale).save(options.stages)


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
