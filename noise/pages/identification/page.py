"""The report of an identification: the numbers, the law, and each step as a picture."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from models.condition import Condition
from noise.base.atomic import atomic
from noise.identification.law_candidates import CANDIDATES
from noise.identification.law_choice import overall
from noise.identification.outcome import as_json
from noise.identification.quantities import QUANTITIES
from noise.pages.engine.page import page_html, write_page
from noise.pages.identification.figures import law_panel, level_panels, recording_panels
from noise.pages.identification.static_figures import static_panels

if TYPE_CHECKING:
    from pathlib import Path

    from noise.identification.outcome import Identification, Number, Seen
    from noise.identification.table_number import TableNumber

__all__ = ["write_identification"]

_WORDS = {candidate.name: candidate.words for candidate in CANDIDATES}


def write_identification(folder: Path, found: Identification) -> None:
    """Write ``rig.toml``, ``identification.json`` and ``report.html``, all whole or none.

    Parameters
    ----------
    folder : Path
        Made where it is not there; older files of these names are replaced.
    found : Identification

    Raises
    ------
    ParameterError
        A file cannot be written.
    """
    data = json.dumps(as_json(found), indent=2, ensure_ascii=False, allow_nan=False)
    html = _html(found)
    with atomic(folder / "rig.toml") as rig, atomic(folder / "identification.json") as path:
        rig.write_text(found.rig_toml, encoding="utf-8")
        # Names of files may hold what no UTF-8 can.
        path.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        write_page(folder / "report.html", html)


def _html(found: Identification) -> str:
    slipping = [one for one in found.seen if one.levels.slips]
    return page_html(
        "identification.html.j2",
        {},
        {},
        title=_title(found),
        answer=_answer(found),
        numbers=[_row(number) for number in found.numbers],
        levels=level_panels(found) if slipping else (),
        static=[
            (one.name, ", ".join(Condition(None, one.interference, one.support_stiffness).words),
             static_panels(one))
            for one in found.static
        ],
        measured=[_measured(*one) for one in found.measured],
        law_picture=(law_panel(found),) if found.laws else (),
        laws=[
            [
                one.law.replace("_", " "), _WORDS[one.law], f"{one.held_out:.2f}",
                f"{one.trained:.2f}", f"{overall(one):.2f}",
            ]
            for one in found.laws
        ],
        recordings=[
            (one.measured.name, _condition(one), recording_panels(one)) for one in slipping
        ],
        rig_toml=found.rig_toml,
        lists=[
            ("Assumed", found.assumed),
            ("Not found", found.not_found),
            ("To know", found.notes),
            ("Left out", [f"{name}: {reason}" for name, reason in found.refused]),
        ],
        held_out=found.held_out,
        margin=f"{100.0 * (found.margin - 1.0):.0f}",
        seconds=f"{found.seconds:.0f}",
    )  # fmt: skip


def _title(found: Identification) -> str:
    sources = [
        f"{n} {what}"
        for n, what in (
            (len(found.seen), "recordings"), (len(found.static), "static tests"),
            (len(found.measured), "measured numbers"),
        )
        if n
    ]  # fmt: skip
    listed = " and ".join(filter(None, (", ".join(sources[:-1]), sources[-1])))
    return f"The rig, identified from {listed}"


def _measured(number: TableNumber, found: float) -> list[str]:
    unit = QUANTITIES[number.item].unit
    at = f"{number}".partition(" at ")[2]
    if QUANTITIES[number.item].at_a_speed:
        at += f", {number.speeds[0]:g} rad/s"
    told = "does not tell" if math.isnan(found) else f"{found:.4g} {unit}"
    return [number.item.replace("_", " "), at, f"{number.value:.4g} {unit}", told]


def _answer(found: Identification) -> list[str]:
    stiffness = [
        f"At {1e3 * (one.interference or 0.0):g} mm the elastomer has "
        f"{one.value:.4g} Nm/rad ({one.low:.4g} to {one.high:.4g})."
        for one in found.numbers
        if one.name == "elastomer_stiffness"
    ]
    if not found.laws:
        return [f"Law of friction as it was known: {found.law.replace('_', ' ')}.", *stiffness]
    left = next(score.held_out for score in found.laws if score.law == found.law)
    return [
        f"Law of friction: {found.law.replace('_', ' ')} ({_WORDS[found.law]}); it leaves "
        f"{left:.2f} floors on recordings that its fit has not seen.",
        *stiffness,
    ]


def _row(one: Number) -> list[str]:
    at = []
    if one.interference is not None:
        at.append(f"{1e3 * one.interference:g} mm")
    if one.support_stiffness is not None:
        fixed = one.support_stiffness == float("inf")
        at.append("clamp fixed" if fixed else f"{one.support_stiffness:g} Nm/rad")
    return [
        one.name.replace("_", " "), ", ".join(at), f"{one.value:.4g} {one.unit}".rstrip(),
        f"{one.low:.4g} to {one.high:.4g}", str(one.n_recordings or "all"),
    ]  # fmt: skip


def _condition(one: Seen) -> str:
    condition = one.measured.condition
    return ", ".join(replace(condition, speed=float(f"{condition.speed:.3g}")).words)
