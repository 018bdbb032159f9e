"""How far a case lies from its rig file, in the floors that the diagnosis itself reckons with.

Once as it is, and once with nothing the matter and all chance the same, which should be about one
floor. What goes between the two is what an effect's absence closes, against which a diagnosis'
closed fraction is held. The generator's own gap knows nothing of `noise`; this does, so it stands
in the score, takes a second or two a case, and is made only where asked for.
"""

from __future__ import annotations

import json
import tempfile
import warnings
from pathlib import Path

from models.rig_file import load_rig
from noise.diagnosis.case import read_case
from noise.diagnosis.gap.floor import case_gap

from ..cases import Case, run_case, write_case
from ..design import design_of
from ..generate import each
from .truth import LEAST_GAP

__all__ = ["add_floors", "floors_of", "gap_from_rig_file"]


def gap_from_rig_file(case: Case) -> float:
    """Distance of recordings from what their rig file simulates, in the diagnosis' floors."""
    with tempfile.TemporaryDirectory() as away, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of bands that a measured response does not reach
        folder = Path(away) / "case"
        write_case(case, folder, None)
        read = read_case([folder], load_rig(folder / "rig.toml"))
        return case_gap(read.recordings, read.rig).distance


def floors_of(answer: dict) -> dict:
    """Return distances with and without what is the matter, and what its absence closes."""
    design = design_of(answer)
    with_it = gap_from_rig_file(run_case(design))
    if design.kind == "none":
        return {"floors": with_it, "floors_off": with_it}
    off = frozenset(form.effect for form, _ in design.forms)
    without = gap_from_rig_file(run_case(design, off, plain=True))
    found = {"floors": with_it, "floors_off": without}
    if with_it > LEAST_GAP:
        found["closed"] = (with_it - without) / (with_it - 1.0)
    return found


def _add(path: Path) -> None:
    answer = json.loads(path.read_text(encoding="utf-8"))
    if "floors" not in answer:
        path.write_text(json.dumps(answer | floors_of(answer), indent=1) + "\n", encoding="utf-8")


def add_floors(answers: Path, workers: int) -> None:
    """Add to each answer how many floors the case is off, where it lacks them."""
    with each(workers) as mapped:
        list(mapped(_add, sorted(answers.glob("*.json"))))
