"""``python -m tests.blind generate|score|identify|improve``: cases, and how well they are answered.

``generate`` makes development cases, ``score`` scores a diagnosis on cases, ``identify`` makes rigs
with six laws of friction and scores what ``bushing-noise identify`` finds of them, ``improve``
tells how often ``bushing-noise diagnose`` finds no gap any more against the rig that it improved.

``score`` takes a folder that ``generate`` has written, or ``--sealed``, which makes the sealed set,
scores it, and writes both to the log in the repository. Without ``--bench`` all kinds of bench are
made, of each as many cases as ``--cases`` says, or else one block.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from .benches import KINDS
from .design import BLOCKS
from .generate import Wanted, generate
from .score.cases import DIAGNOSE
from .score.run import Asked, score_folder, score_sealed

SEALED_SEEDS = 1000
"""From which on seeds are of the sealed set, which was opened once before, with seed 1."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    given = _parser().parse_args(arguments)
    if given.command in ("identify", "improve"):
        _scored(given)
        return
    wanted = _wanted(given)
    if given.command == "generate":
        seconds = generate(given.out, wanted, given.workers)
        made = wanted.cases * len(wanted.benches)
        sys.stderr.write(f"{made} cases in {seconds:.0f} s\n")
        return
    asked = Asked(given.diagnose, given.quick, given.workers)
    if given.sealed == (given.folder is not None):
        raise SystemExit("score takes either a folder that generate has written, or --sealed")
    if given.sealed:
        score_sealed(wanted, asked, given.out)
    else:
        score_folder(given.folder, asked, given.out)


def _wanted(given: argparse.Namespace) -> Wanted:
    sealed = given.command == "score" and given.sealed
    block = given.block or ("sealed kind" if sealed else "kind")
    seed = given.seed if given.seed is not None else SEALED_SEEDS + 1 if sealed else 1
    if (seed >= SEALED_SEEDS) != sealed:
        raise SystemExit(f"--seed {seed}: seeds from {SEALED_SEEDS} on are of the sealed set alone")
    cases = given.cases or len(BLOCKS[block])
    return Wanted(seed, cases, block, tuple(given.bench or KINDS))


def _scored(given: argparse.Namespace) -> None:
    """Identify rigs, or improve them, and print how well that went."""
    if given.command == "identify":
        from .identify.score import score, table

        result = score(given.seed, given.cases, given.workers)
    else:
        from .score.improving import improve_cases, table

        result = improve_cases(given.seed, given.cases, given.workers)
    if given.out is not None:
        given.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(table(result) + "\n")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.blind")
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("generate", help="write development cases, answers apart")
    scoring = commands.add_parser("score", help="score a diagnosis on cases")
    for name, cases, about in (
        ("identify", 60, "score an identification on so many rigs"),
        ("improve", 24, "score the improved rigs of a diagnosis, a minute a case of one effect"),
    ):
        one = commands.add_parser(name, help=about)
        one.add_argument("--cases", type=int, default=cases)
        one.add_argument("--seed", type=int, default=1, help="from 100 on for reporting")
        one.add_argument("--workers", type=int, default=1)
        one.add_argument("--out", type=Path, metavar="FILE.json")
    for one in (making, scoring):
        one.add_argument("--out", type=Path, required=True)
        one.add_argument("--seed", type=int)
        one.add_argument("--bench", action="append", choices=list(KINDS), help="repeatable")
        one.add_argument("--cases", type=int, help="of each kind of bench; one block by default")
        one.add_argument("--workers", type=int, default=2)
        one.add_argument(
            "--block", choices=list(BLOCKS),
            help="how many of each class; by default those of a development draw of a kind",
        )  # fmt: skip
    scoring.add_argument("folder", type=Path, nargs="?", help="what generate has written")
    scoring.add_argument("--sealed", action="store_true", help="open the sealed set; logged")
    scoring.add_argument("--diagnose", default=DIAGNOSE, metavar="MODULE:FUNCTION")
    scoring.add_argument("--quick", action="store_true", help="the first answer alone")
    return parser


if __name__ == "__main__":
    main()
