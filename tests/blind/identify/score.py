"""How well `bushing-noise identify` does on rigs of the second simulator.

Seeds below 100 are for fitting and choosing what the identification has of its own (widths of
intervals, margin between laws); those from 100 on are for reporting.
"""

from __future__ import annotations

import json
import math
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from ..score.diagnosing import resolve
from .laws import LAWS
from .rigs import make_rig, write_rig

__all__ = ["SAME_LAW", "score", "table"]

IDENTIFY = "noise.identification.run:identification_json"
"""What ``bushing-noise identify`` calls."""

SAME_LAW = {name: (name,) for name in LAWS}
"""Which laws that the identification knows are meant by each of the second rig's."""

COSTLY = 3.0
"""Floors beyond which the best distance of the other laws says that leaving one out costs."""


def score(seed: int, rigs: int, workers: int) -> dict[str, Any]:
    """Identify rigs and compare with the truth."""
    jobs = [(seed, i) for i in range(rigs)]
    if workers == 1:
        found = [_one(job) for job in jobs]
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            found = list(pool.map(_one, jobs))
    return {"seed": seed, "rigs": rigs, "summary": _summary(found), "each": found}


def _one(job: tuple[int, int]) -> dict[str, Any]:
    identify = resolve(IDENTIFY)
    made = make_rig(*job)
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        write_rig(made, data)
        started = time.perf_counter()
        try:
            answer = dict(identify(data, data / "known.toml"))
        except Exception as error:  # a rig that is refused counts as one that failed
            return {"index": job[1], "law": made.law.name, "failed": str(error)[:200]}
        seconds = time.perf_counter() - started
    rows = [row for n in answer["numbers"] if (row := _row(n, made)) is not None]
    laws = {
        one["law"]: math.sqrt(0.5 * (one["held_out"] ** 2 + one["trained"] ** 2))
        for one in answer["laws"]
    }
    held = {one["law"]: one["held_out"] for one in answer["laws"]}
    own = SAME_LAW[made.law.name]
    others = [away for law, away in laws.items() if law not in own]
    return {
        "index": job[1], "law": made.law.name, "picked": answer["law"],
        "right": answer["law"] in own, "cost_of_leaving_out": min(others, default=math.nan),
        "held_out": held.get(answer["law"], math.nan), "laws": laws,
        "own_distance": min((laws[x] for x in own if x in laws), default=math.nan),
        "numbers": rows, "seconds": seconds,
    }  # fmt: skip


def _row(number: dict[str, Any], made: Any) -> dict[str, Any] | None:
    """Compare a number with the truth; those that the user knew are left out."""
    name, truth = number["name"], made.truth
    fit = number.get("interference_mm")
    if name == "elastomer_stiffness":
        true = truth["fits"][str(fit)][0]
    elif name == "damping":
        support = number["support_stiffness_Nm_rad"]
        true = truth["damping"][str(-1.0 if support == "fixed" else float(support))]
    elif name in ("critical_torque", "kinetic_torque"):
        levels = [
            level[name.split("_")[0]]
            for level, (_, of, _) in zip(truth["levels"], made.conditions, strict=True)
            if of == fit and level["slips"] > 1
        ]
        if not levels:
            return None
        true = float(np.exp(np.mean(np.log(levels))))
        if made.law.name == "constant":
            true = truth["fits"][str(fit)][1 if name == "critical_torque" else 2]
    else:
        return None
    return {
        "name": name, "fit": fit, "error": math.log(number["value"] / true),
        "half_width": 0.5 * math.log(number["high"] / number["low"]),
        "inside": bool(number["low"] <= true <= number["high"]), "recordings": number["recordings"],
    }  # fmt: skip


def _summary(found: list[dict[str, Any]]) -> dict[str, Any]:
    good = [one for one in found if "failed" not in one]
    summary: dict[str, Any] = {"identified": len(good), "of": len(found)}
    for name in ("elastomer_stiffness", "critical_torque", "kinetic_torque", "damping"):
        rows = [r for one in good for r in one["numbers"] if r["name"] == name]
        errors = np.abs([r["error"] for r in rows])
        widths = np.array([r["half_width"] for r in rows])
        summary[name] = {
            "n": len(rows), "median_error": float(np.median(errors)),
            "p90_error": float(np.quantile(errors, 0.9)),
            "coverage": float(np.mean([r["inside"] for r in rows])),
            "half_width_over_error": float(np.median(widths) / np.median(errors)),
        }  # fmt: skip
        summary[name]["median_error_by_law"] = {
            law: float(np.median([
                abs(r["error"]) for one in good if one["law"] == law
                for r in one["numbers"] if r["name"] == name
            ] or [math.nan]))
            for law in SAME_LAW
        }  # fmt: skip
    counted = [one for one in good if one["cost_of_leaving_out"] > COSTLY]
    summary["law"] = {
        "right": float(np.mean([one["right"] for one in good])) if good else math.nan,
        "costly": len(counted),
        "right_where_costly": (
            float(np.mean([one["right"] for one in counted])) if counted else math.nan
        ),
        "picked": {
            law: sorted(one["picked"] for one in good if one["law"] == law) for law in SAME_LAW
        },
    }
    held = [one["held_out"] for one in good if not math.isnan(one["held_out"])]
    if held:
        summary["held_out_gap"] = {
            "median": float(np.median(held)), "p90": float(np.quantile(held, 0.9)),
            "within_1.3": float(np.mean(np.array(held) <= 1.3)),
        }  # fmt: skip
    if good:
        seconds = [one["seconds"] for one in good]
        summary["seconds"] = {"median": float(np.median(seconds)), "longest": max(seconds)}
    return summary


def table(result: dict[str, Any]) -> str:
    """Return the summary for a terminal."""
    return json.dumps(result["summary"], indent=1)
