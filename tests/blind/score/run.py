"""The command ``score``: diagnose cases, score what was said, log what the sealed set gave."""

from __future__ import annotations

import json
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..generate import LOG, Wanted, append_to_log, each, generate_sealed
from .cases import DIAGNOSE, diagnose_copy, read_answer, read_truths, resolve
from .figures import as_json, as_text

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Asked", "score_folder", "score_sealed"]


@dataclass(frozen=True)
class Asked:
    """How to score: by which diagnosis, quick or not, on how many processes."""

    diagnose: str = DIAGNOSE
    quick: bool = False
    workers: int = 1

    @property
    def about(self) -> str:
        """What is scored, in a word."""
        return self.diagnose + (" (quick)" if self.quick else "")


def _report(data: Path, answers: Path, asked: Asked, out: Path) -> dict:
    out.mkdir(parents=True, exist_ok=True)
    truths = read_truths(answers)
    missing = [t.case for t in truths if not (data / t.case).is_dir()]
    if missing:
        raise SystemExit(f"{data} lacks {missing[0]} and {len(missing) - 1} more of the answers")
    said: list[Mapping | None] = []
    with each(asked.workers) as mapped:
        jobs = [(asked.diagnose, data / t.case, asked.quick) for t in truths]
        for i, one in enumerate(mapped(diagnose_copy, jobs)):
            sys.stderr.write(f"\r{i + 1} of {len(jobs)} cases")
            said.append(one)
    sys.stderr.write("\n")
    pairs = [(t, read_answer(one, t.case)) for t, one in zip(truths, said, strict=True)]
    text, listed = as_text(pairs), as_json(pairs)
    out.joinpath("score.txt").write_text(text + "\n", encoding="utf-8")
    out.joinpath("score.json").write_text(json.dumps(listed, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(text + "\n")
    return listed


def score_folder(folder: Path, asked: Asked, out: Path) -> dict:
    """Score cases that ``generate`` has written."""
    resolve(asked.diagnose)
    return _report(folder / "data", folder / "answers", asked, out)


def score_sealed(wanted: Wanted, asked: Asked, out: Path, log: Path = LOG) -> dict:
    """Open the sealed set, score it, log both; cases and answers are gone afterwards."""
    resolve(asked.diagnose)
    with tempfile.TemporaryDirectory() as here, tempfile.TemporaryDirectory() as there:
        data, answers = Path(here) / "data", Path(there) / "answers"
        opened = generate_sealed(data, answers, wanted, asked.workers, log=log, about=asked.about)
        listed = _report(data, answers, asked, out)
    append_to_log(log, {"figures_of": opened, **listed})
    return listed
