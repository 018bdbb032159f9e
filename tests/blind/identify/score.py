"""How well `bushing-noise identify` does on rigs of the second simulator.

Seeds below 100 are for fitting and choosing what the identification has of its own (widths of
intervals, margin between laws); those from 100 on are for reporting.
"""

from __future__ import annotations

import json
import math
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..generate import each
from ..score.cases import resolve
from .rigs import make_rig, write_rig

__all__ = ["score", "table"]

IDENTIFY = "noise.identification.identify:identification_json"
"""What ``bushing-noise identify`` calls."""

COSTLY = 2.0
"""Factor on what the true law misses, beyond which the best of the others says that it matters."""


def score(seed: int, rigs: int, workers: int) -> dict[str, Any]:
    """Identify rigs and compare with the truth."""
    with each(workers) as mapped:
        found = list(mapped(_one, [(seed, i) for i in range(rigs)]))
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
    laws = {one["law"]: one["missed"] for one in answer["laws"]}
    others = [away for law, away in laws.items() if law != made.law.name]
    held = [one["held_out"] for one in answer["laws"] if one["law"] == answer["law"]]
    return {
        "index": job[1], "law": made.law.name, "picked": answer["law"],
        "right": answer["law"] == made.law.name, "laws": laws, "held_out": held[0],
        "costly": min(others, default=math.nan) > COSTLY * laws[made.law.name], "seconds": seconds,
        "numbers": [row for n in answer["numbers"] if (row := _row(n, made)) is not None],
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
    if not good:
        return summary
    for name in ("elastomer_stiffness", "critical_torque", "kinetic_torque", "damping"):
        rows = [r for one in good for r in one["numbers"] if r["name"] == name]
        errors = np.abs([r["error"] for r in rows])
        summary[name] = {
            "n": len(rows), "median_error": float(np.median(errors)),
            "p90_error": float(np.quantile(errors, 0.9)),
            "coverage": float(np.mean([r["inside"] for r in rows])),
            "median_half_width": float(np.median([r["half_width"] for r in rows])),
        }  # fmt: skip
    costly = [one["right"] for one in good if one["costly"]]
    held, seconds = ([one[key] for one in good] for key in ("held_out", "seconds"))
    return summary | {
        "right_law": float(np.mean([one["right"] for one in good])),
        "right_law_where_costly": float(np.mean(costly)) if costly else math.nan,
        "picked": [(one["law"], one["picked"]) for one in good],
        "held_out_gap": {"median": float(np.median(held)), "p90": float(np.quantile(held, 0.9))},
        "seconds": {"median": float(np.median(seconds)), "longest": max(seconds)},
    }


def table(result: dict[str, Any]) -> str:
    """Return the summary for a terminal."""
    return json.dumps(result["summary"], indent=1)
