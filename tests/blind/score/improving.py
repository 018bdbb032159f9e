"""How often nothing is left to explain once a diagnosis has improved the rig file of a case."""

from __future__ import annotations

import contextlib
import io
import json
import sys
import tempfile
import time
from itertools import count, islice
from pathlib import Path

from scipy.stats import binomtest

from ..cases import run_case, write_case
from ..design import draw_design
from ..effects import DEVELOPMENT
from ..gap import gaps_of
from ..generate import each
from .cases import LEAST_GAP, resolve

__all__ = ["improve_case", "improve_cases", "table"]

MAIN = "noise.cli:main"
"""What ``bushing-noise`` calls."""


def improve_case(job: tuple[int, int]) -> dict:
    """Diagnose a case, and fresh repeats of it against the rig file that this gives."""
    design = draw_design(*job, DEVELOPMENT)
    ((form, strength),) = design.forms
    row = {"index": job[1], "effect": form.effect, "form": form.name, "strength": strength}
    with tempfile.TemporaryDirectory() as away:
        case, fresh, out = (Path(away) / name for name in ("case", "fresh", "out"))
        write_case(run_case(design), case, None)
        write_case(run_case(design, again=1), fresh, None)
        begun = time.perf_counter()
        _called("diagnose", case, "--rig", case / "rig.toml", "--out", out)
        told = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
        row |= {"seconds": time.perf_counter() - begun, "written": told["improved"]}
        row |= {key: told[key] for key in ("verdict", "gap", "p_value")}
        rig = out / told["improved"] if told["improved"] else case / "rig.toml"
        again = json.loads(_called("diagnose", fresh, "--rig", rig, "--quick"))
        row["fresh"] = {key: again[key] for key in ("verdict", "gap", "p_value")}
    sys.stderr.write(f"{row}\n")
    return row


def _called(*arguments: object) -> str:
    """Return what a command prints."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(io.StringIO()):
        code = resolve(MAIN)([str(one) for one in arguments])
    if code != 0:
        raise RuntimeError(f"{arguments}: exit code {code}")
    return text.getvalue()


def improve_cases(seed: int, cases: int, workers: int) -> list[dict]:
    """Improve the rigs of the first cases of a seed that have one effect and a gap."""
    singles = (
        index
        for index in count()
        for design in [draw_design(seed, index, DEVELOPMENT)]
        if design.kind == "one" and gaps_of(run_case(design))["gap"] > LEAST_GAP
    )
    with each(workers) as mapped:
        return list(mapped(improve_case, [(seed, index) for index in islice(singles, cases)]))


def table(rows: list[dict]) -> str:
    """Return what the aims ask for, with 90 % intervals."""
    written = [row for row in rows if row["written"]]

    def share(right: list[bool]) -> str:
        if not right:
            return "none"
        sure = binomtest(sum(right), len(right)).proportion_ci(0.9, method="wilson")
        share = sum(right) / len(right)
        return f"{share:.2f} ({sum(right)} of {len(right)}; {sure.low:.2f} to {sure.high:.2f})"

    said = {
        "no gap left, all cases (aim 0.60)": [not r["fresh"]["verdict"] for r in rows],
        "no gap left, file written (aim 0.85)": [not r["fresh"]["verdict"] for r in written],
        "file written": [bool(row["written"]) for row in rows],
        "effect named": [row["effect"] in row["verdict"] for row in rows],
    }
    return "\n".join(f"{name}: {share(right)}" for name, right in said.items())
