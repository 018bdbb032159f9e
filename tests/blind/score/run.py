"""The command ``score``: diagnose cases, score what was said, write table, figures and picture."""

from __future__ import annotations

import json
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..effects import CAUSES
from ..generate import Wanted, each, generate_sealed
from .answers import same_names
from .baselines import BASELINES
from .by_bench import by_bench, by_bench_json, by_bench_text
from .closing import LEAST_CLOSED
from .diagnosing import diagnose_copy, resolve
from .log import LOG, log_figures
from .picture import draw_confusion
from .table import Scores, as_json, as_text, loss, score
from .truth import read_truths

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .truth import Truth

__all__ = ["OWN_CLOSED", "Asked", "score_folder", "score_sealed"]

OWN_CLOSED = 0.95
"""Median closed fraction that is aimed at for the library's own forms."""


@dataclass(frozen=True)
class Asked:
    """How to score: by which diagnosis or baseline, quick or not, on how many processes.

    `own` is a folder of cases with the library's own forms, scored beside for the loss; with
    `floors`, gaps are reckoned as the diagnosis does.
    """

    diagnose: str
    baseline: str | None = None
    quick: bool = False
    workers: int = 1
    equivalent: Path | None = None
    own: Path | None = None
    floors: bool = False

    @property
    def about(self) -> str:
        """What is scored, in a word."""
        if self.baseline:
            return f"baseline {self.baseline}"
        return self.diagnose + (" (quick)" if self.quick else "")


def _said(truths: list[Truth], data: Path, asked: Asked) -> list[Mapping | None]:
    if asked.baseline is not None:
        rng = np.random.default_rng(0)
        return [BASELINES[asked.baseline](t, CAUSES, rng) for t in truths]
    jobs = [(asked.diagnose, data / t.case, asked.quick) for t in truths]
    said = []
    with each(asked.workers) as mapped:
        for i, one in enumerate(mapped(diagnose_copy, jobs)):
            sys.stderr.write(f"\r{i + 1} of {len(jobs)} cases")
            said.append(one)
    sys.stderr.write("\n")
    return said


def _scores(data: Path, answers: Path, asked: Asked, least_closed: float) -> Scores:
    if asked.floors:
        from .floors import add_floors

        add_floors(answers, asked.workers)
    truths = read_truths(answers)
    missing = [t.case for t in truths if not (data / t.case).is_dir()]
    if missing:
        raise SystemExit(f"{data} lacks {missing[0]} and {len(missing) - 1} more of the answers")
    same = {}
    if asked.equivalent is not None:
        same = same_names(json.loads(asked.equivalent.read_text(encoding="utf-8")))
    said = _said(truths, data, asked)
    return score(list(zip(truths, said, strict=True)), same=same, least_closed=least_closed)


def _report(data: Path, answers: Path, asked: Asked, out: Path) -> dict:
    out.mkdir(parents=True, exist_ok=True)
    scores = _scores(data, answers, asked, LEAST_CLOSED)
    figures = scores.figures
    if asked.own is not None:
        own = _scores(asked.own / "data", asked.own / "answers", asked, OWN_CLOSED)
        renamed = {f"own forms: {name}": f for name, f in own.figures.items()}
        figures = figures | renamed | loss(own, scores)
        text = f"{as_text(scores.figures)}\n\nOwn forms\n{as_text(own.figures)}\n\n"
        text += as_text(loss(own, scores))
        draw_confusion(own.pairs, out / "confusion_own.png")
    else:
        text = as_text(figures)
    draw_confusion(scores.pairs, out / "confusion.png")
    benches = by_bench(scores.pairs)
    text = f"{by_bench_text(benches, scores.figures)}\n\n{text}"
    out.joinpath("score.txt").write_text(text + "\n", encoding="utf-8")
    listed = as_json(figures) | {"by bench": by_bench_json(benches)}
    out.joinpath("score.json").write_text(json.dumps(listed, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(text + "\n")
    return listed


def _ready(asked: Asked) -> None:
    """Refuse at once what could not be called."""
    if asked.baseline is None:
        resolve(asked.diagnose)


def score_folder(folder: Path, asked: Asked, out: Path) -> dict:
    """Score cases that ``generate`` has written."""
    _ready(asked)
    return _report(folder / "data", folder / "answers", asked, out)


def score_sealed(wanted: Wanted, asked: Asked, out: Path, log: Path = LOG) -> dict:
    """Open the sealed set, score it, log both; cases and answers are gone afterwards."""
    _ready(asked)
    with tempfile.TemporaryDirectory() as here, tempfile.TemporaryDirectory() as there:
        data, answers = Path(here) / "data", Path(there) / "answers"
        opened = generate_sealed(data, answers, wanted, asked.workers, log=log, about=asked.about)
        listed = _report(data, answers, asked, out)
    log_figures(log, opened, listed)
    return listed
