"""Table of published numbers beside computed ones: ``rows.csv`` and what computes its rows.

Each row of ``rows.csv`` is a published number with all that its verdict depends on (`Row`) and how
it is computed, in one of three ways. ``value`` is the number itself. ``quantity`` names one of
`noise.thesis.runs.QUANTITIES`, computed at ``cases`` for the models in ``columns`` (by default the
equations and the calibrated material). Otherwise the function of the group's name computes all rows
of the group, in order. A case is speed, interference and support stiffness, then c_E or a material
where they are others; cases are parted by semicolons, and ``combined`` says what is made of them.

Why measured numbers are missed, a sentence or two each, with what was tried, is in ``why.toml``.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from importlib import resources
from typing import Any

from noise.base import packaged_toml
from noise.thesis import formulas, heat, modes
from noise.thesis.row import Published, Row, Values, number
from noise.thesis.runs import CALIBRATED, LISTED, QUANTITIES, THESIS, Case

FORMULAS: Mapping[str, Callable[[], Iterable[Values]]] = {
    one.__name__: one
    for one in (
        formulas.potentiometer, formulas.torque_cell, formulas.transducers, formulas.shaft,
        formulas.series, formulas.pressures, formulas.sleeves, formulas.squeal, heat.heating,
        modes.beams, modes.beam_modes, modes.fitted, modes.shipped,
    )
}  # fmt: skip
"""Groups of rows that a function computes as a whole."""

_COMBINED: Mapping[str, Callable[[list[float]], float]] = {
    "": lambda values: values[0],
    "ratio": lambda values: values[0] / values[1],
    "rise": lambda values: values[0] - values[1],
    "span": lambda values: max(values) / min(values),
    "largest": max,
    "x4": lambda values: 4.0 * values[0],
    "x6": lambda values: 6.0 * values[0],
}
_DECIMALS = 6  # of what runs give: beyond them lies rounding


@lru_cache(maxsize=1)
def _lines() -> dict[str, list[dict[str, str]]]:
    """Return the rows of ``rows.csv`` by the name of their group."""
    text = (resources.files("noise.thesis") / "rows.csv").read_text(encoding="utf-8")
    groups: dict[str, list[dict[str, str]]] = {}
    for line in csv.DictReader(text.splitlines()):
        groups.setdefault(line["group"], []).append(line)
    return groups


def group_names() -> list[str]:
    """Return the names of the groups of rows, in the order of the table.

    Examples
    --------
    >>> group_names()[:2]
    ['potentiometer', 'torque_cell']
    """
    return list(_lines())


@lru_cache(maxsize=1)
def reasons() -> dict[tuple[str, str], str]:
    """Return why measured numbers are missed, by item and condition of the row.

    Examples
    --------
    >>> reasons()["v_crit1", "0.178 mm, 2214 Nm/rad"][:20]
    "The torque's drop at"
    """
    given = packaged_toml("noise.thesis", "why.toml")["why"]
    return {tuple(row): one["text"] for one in given for row in one["rows"]}


def thesis_rows(groups: Iterable[str]) -> list[Row]:
    """Compute the rows of groups; those that are missed say why.

    Raises
    ------
    ValueError
        A function computes more rows or fewer than ``rows.csv`` has.

    Examples
    --------
    >>> [row.verdict for row in thesis_rows(["misprints"])][:2]
    ['misprint', 'misprint']
    """
    return [row for group in groups for row in _group_rows(group)]


def _group_rows(group: str) -> Iterator[Row]:
    lines = _lines()[group]
    computed = FORMULAS[group]() if group in FORMULAS else map(_computed, lines)
    for line, values in zip(lines, computed, strict=True):
        row, about = _published(line), dict[str, Any](values)
        yield replace(row, **about, why=reasons().get((row.item, row.condition), ""))


def _published(line: Mapping[str, str]) -> Row:
    def value(name: str) -> float | None:
        return float(line[name]) if line[name] else None

    return Row(
        line["item"], line["condition"], line["unit"],
        Published(line["published"], float(line["low"]), float(line["high"])),
        judged=line["judged"] or "exact",
        tolerance=float(line["tolerance"] or 0.01),
        measured=bool(line["measured"]),
        meant=number(float(line["meant"])) if line["meant"] else None,
        scale=value("scale"),
        in_sample=bool(line["in_sample"]),
        counted=not line["counted"],
        limit=value("limit"),
        digits=int(line["digits"] or 4),
    )  # fmt: skip


def _computed(line: Mapping[str, str]) -> dict[str, float]:
    """Return the values of a row by column."""
    if line["value"]:
        return {line["judged"] or "exact": float(line["value"])}
    quantity = line["quantity"]
    results: dict[str, float] = {}
    cases = [_case(text) for text in line["cases"].split(";")]
    for column in (line["columns"] or "exact calibrated").split():
        if column == "listing":
            values = [LISTED[quantity](case) for case, _ in cases]
        else:
            shipped = THESIS if column == "exact" else CALIBRATED
            values = [QUANTITIES[quantity](own or shipped, case) for case, own in cases]
        value = _COMBINED[line["combined"]](values)
        results[column] = value if math.isinf(value) else round(value, _DECIMALS)
    return results


def _case(text: str) -> tuple[Case, str]:
    """Return a case, and its material where stated."""
    words = text.split()
    material = words.pop() if words[-1][0].isalpha() and words[-1] != "fixed" else ""
    speed, interference, support, *damping = (
        math.inf if word == "fixed" else float(word) for word in words
    )
    return Case(speed, interference, support, *damping), material
