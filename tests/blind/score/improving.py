"""How often nothing is left to explain once a diagnosis has improved the rig file of a case.

Of each case with one effect and a gap above 1.5 floors the recordings are diagnosed whole, and the
rig file that this writes is diagnosed quickly: against the recordings that it was fitted to, and
against fresh repeats of them, of the same rig and effect but of other chance, which count. Seeds
below 100 are for choosing, those from 100 on for reporting.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import sys
import tempfile
import time
from itertools import count
from pathlib import Path

from ..cases import run_case, write_case
from ..design import draw_design
from ..effects import DEVELOPMENT
from ..gap import gaps_of
from ..generate import each
from .diagnosing import resolve
from .truth import LEAST_GAP

__all__ = ["improve_case", "improve_cases", "strong_singles", "table"]

MAIN = "noise.cli:main"
"""What ``bushing-noise`` calls."""


def strong_singles(seed: int, cases: int) -> list[int]:
    """Return the places of the first cases of a seed that have one effect and a gap."""
    found: list[int] = []
    for index in count():
        if len(found) == cases:
            return found
        design = draw_design(seed, index, DEVELOPMENT)
        if design.kind == "one" and gaps_of(run_case(design))["gap"] > LEAST_GAP:
            found.append(index)
    raise AssertionError("there is always another case")


def improve_case(job: tuple[int, int]) -> dict:
    """Diagnose a case, and once more against the rig file that this gives."""
    design = draw_design(*job, DEVELOPMENT)
    ((form, strength),) = design.forms
    row = {"index": job[1], "effect": form.effect, "form": form.name, "strength": strength}
    with tempfile.TemporaryDirectory() as away:
        case, fresh, out = (Path(away) / name for name in ("case", "fresh", "out"))
        write_case(run_case(design), case, None)
        write_case(run_case(design, again=1), fresh, None)
        begun = time.perf_counter()
        told = _told(["diagnose", case, "--rig", case / "rig.toml", "--out", out], out)
        row |= {"seconds": time.perf_counter() - begun, "verdict": told["verdict"]}
        row |= {"gap": told["gap"], "p_value": told["p_value"], "written": told["improved"]}
        row["findings"] = [
            {k: e[k] for k in ("name", "probability", "gap_before", "gap_after")}
            for e in told["effects"] if e["gap_after"] is not None
        ]  # fmt: skip
        rig = case / "rig.toml"
        if told["improved"]:
            rig = out / told["improved"]
            row["rig"] = rig.read_text(encoding="utf-8")
        for name, data in (("fitted", case), ("fresh", fresh)):
            again = _told(["diagnose", data, "--rig", rig, "--quick"])
            row[name] = {k: again[k] for k in ("verdict", "gap", "p_value")}
            row[name]["none"] = again["probabilities"]["none"]
    sys.stderr.write(f"{_line(row)}\n")
    return row


def _told(arguments: list[object], out: Path | None = None) -> dict:
    """Return what a diagnosis says, as it prints or writes it."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(io.StringIO()):
        code = resolve(MAIN)([str(one) for one in arguments])
    if code != 0:
        raise RuntimeError(f"{arguments}: exit code {code}")
    return json.loads(
        text.getvalue() if out is None else (out / "diagnosis.json").read_text(encoding="utf-8")
    )


def improve_cases(seed: int, cases: int, workers: int) -> list[dict]:
    """Improve the rigs of so many cases of a seed."""
    jobs = [(seed, index) for index in strong_singles(seed, cases)]
    with each(workers) as mapped:
        return list(mapped(improve_case, jobs))


def table(rows: list[dict]) -> str:
    """Return what the aims ask for, with 90 % intervals, and a line a case."""
    written = [row for row in rows if row["written"]]
    lines = [_line(row) for row in rows]
    lines += [""]
    for said, of, name in (
        ("no gap left, all cases, fresh repeats (aim 0.60)", rows, "fresh"),
        ("no gap left, file written, fresh repeats (aim 0.85)", written, "fresh"),
        ("no gap left, file written, recordings fitted to", written, "fitted"),
    ):
        lines.append(f"{said}: {_share([not row[name]['verdict'] for row in of])}")
    lines.append(f"file written: {_share([bool(row['written']) for row in rows])}")
    lines.append(f"effect named: {_share([row['effect'] in row['verdict'] for row in rows])}")
    return "\n".join(lines)


def _line(row: dict) -> str:
    said = f"{_named(row['verdict']):28s} {'written' if row['written'] else '-':8s}"
    again = "; ".join(
        f"{name} {_named(row[name]['verdict'])} {row[name]['gap']:.2f} "
        f"p {row[name]['p_value']:.2g} none {row[name]['none']:.2f}"
        for name in ("fitted", "fresh")
    )
    return (
        f"{row['index']:4d} {row['effect']:24s} {row['form']:28s} {row['strength']:.3f} gap "
        f"{row['gap']:5.2f} said {said} {again} {row['seconds']:.0f} s"
    )


def _named(verdict: list[str]) -> str:
    return "+".join(verdict) or "no gap"


def _share(right: list[bool]) -> str:
    """Share and its 90 % interval (Wilson)."""
    n, z = len(right), 1.645
    if n == 0:
        return "none"
    p = sum(right) / n
    middle = (p + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * math.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    return f"{p:.2f} ({sum(right)} of {n}; {middle - half:.2f} to {middle + half:.2f})"
