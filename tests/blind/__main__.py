"""``python -m tests.blind generate|score|identify``: cases, and how well they are answered.

``generate`` makes cases, ``score`` scores a diagnosis on them, ``identify`` makes rigs with six
laws of friction and scores what ``bushing-noise identify`` makes of them. Seeds from 1000 on give
cases of the sealed set, whose forms of effects nothing is developed on. Without ``--bench`` all
kinds of bench are made, of each as many cases as ``--cases`` says, or else one block.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from .benches import KINDS
from .design import BLOCKS
from .generate import SEALED_SEEDS, generate
from .identify import score_rigs
from .score import DIAGNOSE, score_folder


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    given = _parser().parse_args(arguments)
    if given.command == "generate":
        block = given.block or ("sealed kind" if given.seed >= SEALED_SEEDS else "kind")
        cases = given.cases or len(BLOCKS[block])
        generate(given.out, given.seed, cases, block, given.bench or list(KINDS), given.workers)
    elif given.command == "score":
        score_folder(
            given.folder, given.diagnose, given.out, quick=given.quick, workers=given.workers
        )
    else:
        result = score_rigs(given.seed, given.cases, given.workers)
        sys.stdout.write(json.dumps(result, indent=1) + "\n")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.blind")
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("generate", help="write cases, answers apart")
    making.add_argument("--out", type=Path, required=True)
    making.add_argument("--seed", type=int, default=1, help="from 1000 on of the sealed set")
    making.add_argument("--bench", action="append", choices=list(KINDS), help="repeatable")
    making.add_argument("--cases", type=int, help="of each kind of bench; one block by default")
    making.add_argument(
        "--block", choices=list(BLOCKS),
        help="how many of each class; by default those of a draw of a kind",
    )  # fmt: skip
    scoring = commands.add_parser("score", help="score a diagnosis on cases")
    scoring.add_argument("folder", type=Path, help="what generate has written")
    scoring.add_argument("--out", type=Path, required=True)
    scoring.add_argument("--diagnose", default=DIAGNOSE, metavar="MODULE:FUNCTION")
    scoring.add_argument("--quick", action="store_true", help="the first answer alone")
    identifying = commands.add_parser("identify", help="score an identification on so many rigs")
    identifying.add_argument("--cases", type=int, default=60)
    identifying.add_argument("--seed", type=int, default=1, help="from 100 on for reporting")
    for one in (making, scoring, identifying):
        one.add_argument("--workers", type=int, default=2)
    return parser


if __name__ == "__main__":
    main()
