"""What was the matter with a case, and what a diagnosis said of it."""

from __future__ import annotations

import importlib
import json
import math
import shutil
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = [
    "DIAGNOSE", "LEAST_GAP", "Answer", "Truth", "diagnose_copy", "read_answer", "read_truths",
    "resolve", "truth_of",
]  # fmt: skip

LEAST_GAP = 1.5
"""Above so many floors a case counts for all but false alarms."""

DIAGNOSE = "noise.diagnosis.run:diagnosis_json"
"""What ``bushing-noise diagnose`` calls."""


@dataclass(frozen=True)
class Truth:
    """The truth of one case; `verdict` as a perfect diagnosis has it."""

    case: str
    kind: str
    verdict: tuple[str, ...]
    stages: tuple[str, ...] = ()
    gap: float | None = None
    alone: dict[str, float] = field(default_factory=dict)
    bench: str = "quiet"

    @property
    def names(self) -> tuple[str, ...]:
        """Names that are true of the case; ``none`` where nothing is the matter."""
        return self.verdict or ("none",)

    @property
    def counts(self) -> bool:
        """Whether the gap is large enough for what is asked beside false alarms."""
        return self.kind != "none" and (self.gap is None or self.gap > LEAST_GAP)

    @property
    def plain(self) -> bool:
        """Whether each of several effects would be large enough by itself."""
        return bool(self.alone) and min(self.alone.values()) > LEAST_GAP


def truth_of(case: str, answer: dict) -> Truth:
    """Take the truth from an answer as the generator writes it."""
    stages = tuple(effect["stage"] for effect in answer["effects"])
    return Truth(
        case, answer["class"], tuple(answer["verdict"]), stages, answer.get("gap"),
        answer.get("gap_alone", {}), answer.get("bench", "quiet"),
    )  # fmt: skip


def read_truths(folder: Path) -> list[Truth]:
    """Read a folder of answers, in the order of their names."""
    paths = sorted(folder.glob("*.json"))
    if not paths:
        raise SystemExit(f"{folder} holds no answers")
    return [truth_of(path.stem, json.loads(path.read_text(encoding="utf-8"))) for path in paths]


@dataclass(frozen=True)
class Answer:
    """What was said; `failed` where nothing was."""

    verdict: tuple[str, ...]
    probability: Mapping[str, float]
    stage: str | None = None
    closed: float | None = None
    interval: tuple[float, float] | None = None
    seconds: float | None = None
    failed: bool = False

    @property
    def ranking(self) -> list[str]:
        """Names, the most probable first; among equals those of the verdict."""
        names = self.verdict or ("none",)
        return sorted(self.probability, key=lambda n: (-self.probability[n], n not in names))

    def of(self, name: str) -> float:
        """Return the probability of a name; 0 where nothing was said of it."""
        return self.probability.get(name, 0.0)


def read_answer(diagnosis: Mapping | None, case: str = "diagnosis") -> Answer:
    """Read a ``diagnosis.json``; None is a diagnosis that failed."""
    if diagnosis is None:
        return Answer((), {}, failed=True)
    if not isinstance(diagnosis.get("verdict"), list):
        raise ValueError(f"{case}: verdict = {diagnosis.get('verdict')!r} must be a list of names")
    verdict = tuple(diagnosis["verdict"])
    probability = diagnosis.get("probabilities", {})
    for name, p in probability.items():
        if not (math.isfinite(p) and -1e-9 <= p <= 1.0 + 1e-9):
            raise ValueError(f"{case}: probability of {name} = {p!r} must lie between 0 and 1")
    effects = diagnosis.get("effects", ())
    first = min(effects, key=lambda e: (e["name"] not in verdict, -e["probability"]), default={})
    low, high = first.get("closed_low"), first.get("closed_high")
    return Answer(
        verdict,
        probability,
        (diagnosis.get("location") or {}).get("stage"),
        first.get("closed"),
        None if low is None or high is None else (low, high),
        diagnosis.get("seconds"),
    )


def resolve(name: str) -> Callable:
    """Find a function by ``module:function``."""
    module, _, function = name.partition(":")
    try:
        return getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, ValueError) as error:
        raise SystemExit(
            f"--diagnose {name}: there is no such function ({error}); give MODULE:FUNCTION that "
            "takes a folder and a rig file"
        ) from None


def diagnose_copy(job: tuple[str, Path, bool]) -> Mapping | None:
    """Diagnose a copy of a case, whose name and place tell nothing, answers out of reach.

    None where that fails, which standard error then says.
    """
    name, case, quick = job
    diagnose = resolve(name)
    with tempfile.TemporaryDirectory() as away:
        copy = shutil.copytree(case, Path(away) / "case")
        begun = time.perf_counter()
        try:
            said = dict(diagnose(copy, copy / "rig.toml", **({"quick": True} if quick else {})))
        except Exception as error:
            sys.stderr.write(f"{case.name}: {type(error).__name__}: {error}\n")
            return None
        return {"seconds": time.perf_counter() - begun} | said
