"""Scores of a diagnosis on cases of the second rig, by kind of bench and in all.

A case counts, beside false alarms, above `LEAST_GAP` floors. A diagnosis that failed counts against
every quantity, false alarms included. A share has Wilson's interval, all else that of cases drawn
again.
"""

from __future__ import annotations

import importlib
import json
import math
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.stats import binomtest

from .generate import each

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Pairs = list[tuple[dict, dict]]

__all__ = ["DIAGNOSE", "LEAST_GAP", "figures", "read_diagnosis", "score_folder", "table"]

LEAST_GAP = 1.5
DIAGNOSE = "tests.helpers.diagnosed:diagnosis_json"
"""What ``bushing-noise diagnose`` calls."""

FAILED: dict = {"verdict": [], "probabilities": {}, "failed": True}
"""The diagnosis of a case that broke down."""

_DRAWS, _GROUPS, _SURE = 400, 10, 0.9


class Figure(NamedTuple):
    """A value with its interval, and how many cases it is of."""

    cases: int
    value: float
    low: float
    high: float


def read_diagnosis(diagnosis: Mapping, case: str = "diagnosis") -> dict:
    """Check what is scored of a ``diagnosis.json``."""
    if not isinstance(diagnosis.get("verdict"), list):
        raise ValueError(f"{case}: verdict = {diagnosis.get('verdict')!r} must be a list of names")
    for name, p in diagnosis.get("probabilities", {}).items():
        if not (math.isfinite(p) and -1e-9 <= p <= 1.0 + 1e-9):
            raise ValueError(f"{case}: probability of {name} = {p!r} must lie between 0 and 1")
    return {"probabilities": {}, "failed": False} | dict(diagnosis)


def _names(truth: dict) -> list[str]:
    """Names that are true of a case; ``none`` where nothing is the matter."""
    return truth["verdict"] or ["none"]


def _counts(truth: dict, *kinds: str) -> bool:
    large = truth["class"] != "none" and truth.get("gap", math.inf) > LEAST_GAP
    return large and (not kinds or truth["class"] in kinds)


def _plain(truth: dict, kind: str) -> bool:
    """Whether each of several effects would be large enough by itself."""
    return _counts(truth, kind) and min(truth["gap_alone"].values(), default=0.0) > LEAST_GAP


def _ranking(answer: dict) -> list[str]:
    """Names, the most probable first; among equals those of the verdict."""
    p, verdict = answer["probabilities"], answer["verdict"] or ["none"]
    return sorted(p, key=lambda name: (-p[name], name not in verdict))


def _exact(truth: dict, answer: dict) -> bool:
    return set(answer["verdict"]) == set(truth["verdict"])


def _sure_of_a_name(_: dict, answer: dict) -> bool:
    p = [p for name, p in answer["probabilities"].items() if name not in ("none", "unknown")]
    return answer["failed"] or bool(max(p, default=0.0) > _SURE)


def _brier(truth: dict, answer: dict) -> float:
    p, names = answer["probabilities"], _names(truth)
    return sum((p.get(name, 0.0) - (name in names)) ** 2 for name in {*names, *p})


def _confidence(truth: dict, answer: dict) -> tuple[float, bool]:
    ranking = _ranking(answer)
    if not ranking:
        return 1.0, False
    return answer["probabilities"][ranking[0]], ranking[0] in _names(truth)


def _closed(_: dict, answer: dict) -> float:
    """Share of the gap that the effect of the verdict closes, or else the most probable one."""
    effects = answer.get("effects", ())
    verdict = answer["verdict"]
    first = min(effects, key=lambda e: (e["name"] not in verdict, -e["probability"]), default={})
    return first.get("closed") or 0.0


def calibration_error(rows: np.ndarray) -> float:
    """Expected calibration error of rows of confidence and whether it was right."""
    order = np.argsort(rows[:, 0], kind="stable")
    groups = np.array_split(rows[order], min(_GROUPS, len(rows)))
    return float(sum(abs(g[:, 0].mean() - g[:, 1].mean()) * len(g) for g in groups) / len(rows))


def _known(truth: dict) -> bool:
    return _counts(truth, "one", "pair", "triple")


def _scored(truth: dict) -> bool:
    return _counts(truth) or truth["class"] == "none"


QUANTITIES: dict[str, tuple[Callable, Callable, Callable]] = {
    "false alarm": (lambda t: t["class"] == "none",
                    lambda _, a: bool(a["verdict"]) or a["failed"], np.mean),
    "detected": (_counts, lambda _, a: bool(a["verdict"]), np.mean),
    "right first": (lambda t: _counts(t, "one"),
                    lambda t, a: t["verdict"][0] in _ranking(a)[:1], np.mean),
    "among three": (lambda t: _counts(t, "one"),
                    lambda t, a: t["verdict"][0] in _ranking(a)[:3], np.mean),
    "stage": (_known, lambda t, a: (a.get("location") or {}).get("stage")
              in [e["stage"] for e in t["effects"]], np.mean),
    "parameters": (lambda t: _counts(t, "parameters"),
                   lambda _, a: "parameters" in a["verdict"], np.mean),
    "exact pair": (lambda t: _plain(t, "pair"), _exact, np.mean),
    "exact triple": (lambda t: _plain(t, "triple"), _exact, np.mean),
    "unknown": (lambda t: _counts(t, "stranger"), lambda _, a: "unknown" in a["verdict"], np.mean),
    "named > 0.9": (lambda t: _counts(t, "stranger"), _sure_of_a_name, np.mean),
    "ECE": (_scored, _confidence, calibration_error),
    "Brier": (_scored, _brier, np.mean),
    "closed": (_known, _closed, np.median),
    "seconds": (lambda _: True, lambda _, a: a.get("seconds", 0.0), np.median),
    "failed": (lambda _: True, lambda _, a: a["failed"], np.mean),
}  # fmt: skip
"""Of which cases each is asked, what of a case, and what of them all."""


def figures(pairs: Pairs, seed: int = 0) -> dict[str, Figure]:
    """Return the figures of pairs of what the generator wrote and what was diagnosed."""
    rng = np.random.default_rng(seed)
    of_all = {}
    for name, (asked, value, statistic) in QUANTITIES.items():
        values = [value(t, a) for t, a in pairs if asked(t)]
        n = len(values)
        if n == 0:
            continue
        rows = np.array(values, dtype=float).reshape(n, -1)
        if all(isinstance(one, bool) for one in values):
            sure = binomtest(round(float(rows.sum())), n).proportion_ci(method="wilson")
            low, high = float(sure.low), float(sure.high)
        else:
            drawn = [statistic(rows[rng.integers(0, n, n)]) for _ in range(_DRAWS)]
            low, high = np.quantile(drawn, [0.025, 0.975]).tolist()
        of_all[name] = Figure(n, float(statistic(rows)), low, high)
    return of_all


def table(pairs: Pairs) -> str:
    """Lay out a table in Markdown: value, 95 % interval and cases; a row a kind of bench."""
    benches = dict.fromkeys(truth["bench"] for truth, _ in pairs)
    rows = {b: figures([(t, a) for t, a in pairs if t["bench"] == b]) for b in benches}
    rows["all"] = figures(pairs)
    lines = [["bench", *rows["all"]], ["---"] * (len(rows["all"]) + 1)]
    for bench, of_bench in rows.items():
        cells = [
            f"{f.value:.2f} ({f.low:.2f}-{f.high:.2f}; {f.cases})" if f else "-"
            for f in map(of_bench.get, rows["all"])
        ]
        lines.append([bench, *cells])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


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


def _diagnosis(job: tuple[str, Path, bool]) -> dict:
    """Diagnose a copy of a case, whose name and place tell nothing, answers out of reach."""
    name, case, quick = job
    diagnose = resolve(name)
    with tempfile.TemporaryDirectory() as away:
        copy = shutil.copytree(case, Path(away) / "case")
        begun = time.perf_counter()
        try:
            result = dict(diagnose(copy, copy / "rig.toml", **({"quick": True} if quick else {})))
        except Exception as error:
            sys.stderr.write(f"{case.name}: {type(error).__name__}: {error}\n")
            return FAILED
        return read_diagnosis({"seconds": time.perf_counter() - begun} | result, case.name)


def score_folder(folder: Path, diagnose: str, out: Path, *, quick: bool, workers: int) -> None:
    """Score cases that ``generate`` has written; write and print the table."""
    resolve(diagnose)
    answers = sorted((folder / "answers").glob("*.json"))
    if not answers:
        raise SystemExit(f"{folder / 'answers'} holds no answers")
    jobs = [(diagnose, folder / "data" / path.stem, quick) for path in answers]
    truths = [json.loads(path.read_text(encoding="utf-8")) for path in answers]
    results = []
    with each(workers) as mapped:
        for result in mapped(_diagnosis, jobs):
            results.append(result)
            sys.stderr.write(f"\r{len(results)} of {len(jobs)} cases")
    pairs = list(zip(truths, results, strict=True))
    out.mkdir(parents=True, exist_ok=True)
    of_all = {name: figure._asdict() for name, figure in figures(pairs).items()}
    out.joinpath("score.md").write_text(table(pairs) + "\n", encoding="utf-8")
    out.joinpath("score.json").write_text(json.dumps(of_all, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(table(pairs) + "\n")
