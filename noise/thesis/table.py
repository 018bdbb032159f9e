"""Table of published numbers beside computed ones: ``rows.csv`` and the groups that compute it.

Each row of ``rows.csv`` is a published number with all that its verdict depends on (`Row`); a group
of rows is computed by the function of its name, which yields a mapping of values a row, in order.
Why measured numbers are missed, a sentence or two each, with what was tried, is in ``why.toml``.
"""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import lru_cache
from importlib import resources
from typing import Any

from noise.thesis import (
    anchors,
    calibrations,
    critical_velocities,
    damping,
    heat,
    modes,
    slip_frequencies,
    stiffness,
    torques,
)
from noise.thesis.row import Column, Published, Row, Values, number

GROUPS: tuple[Callable[[], Iterable[Values]], ...] = (
    calibrations.potentiometer, calibrations.torque_cell, calibrations.transducers,
    calibrations.converter, calibrations.lengths, stiffness.shaft, stiffness.beams,
    stiffness.series, modes.torsional_modes, modes.beam_modes, anchors.fitted, anchors.shipped,
    heat.heating, calibrations.misprints, modes.squeal, damping.critical, damping.measured,
    critical_velocities.simulated, critical_velocities.transitions,
    critical_velocities.contradiction, torques.regimes, torques.amplitudes, torques.patterns,
    torques.peaks, torques.first_slip, torques.friction, torques.silicone, stiffness.pressures,
    stiffness.sleeves, torques.natural_rubber, torques.creak, slip_frequencies.at_fixed_clamp,
    slip_frequencies.bounded, slip_frequencies.rising, slip_frequencies.harmonics,
    slip_frequencies.constant, slip_frequencies.falling_with_interference,
)  # fmt: skip
"""All groups, in the order of the table."""


@lru_cache(maxsize=1)
def reasons() -> dict[tuple[str, str], str]:
    """Return why measured numbers are missed, by item and condition of the row.

    Examples
    --------
    >>> reasons()["v_crit1", "0.178 mm, 2214 Nm/rad"][:20]
    "The torque's drop at"
    """
    text = (resources.files("noise.thesis") / "why.toml").read_text(encoding="utf-8")
    return {tuple(row): one["text"] for one in tomllib.loads(text)["why"] for row in one["rows"]}


@lru_cache(maxsize=1)
def published_rows() -> dict[str, list[Row]]:
    """Return the rows by the name of their group, with nothing computed.

    Examples
    --------
    >>> published_rows()["squeal"][0].published.low
    6570.0
    """
    text = (resources.files("noise.thesis") / "rows.csv").read_text(encoding="utf-8")
    found: dict[str, list[Row]] = {}
    for line in csv.DictReader(text.splitlines()):
        found.setdefault(line["group"], []).append(_row(line))
    return found


def _row(line: dict[str, str]) -> Row:
    def value(name: str) -> float | None:
        return float(line[name]) if line[name] else None

    return Row(
        line["item"], line["condition"], line["unit"],
        Published(line["published"], float(line["low"]), float(line["high"])),
        judged=Column(line["judged"] or Column.EXACT.value),
        tolerance=float(line["tolerance"] or 0.01),
        measured=bool(line["measured"]),
        meant=number(float(line["meant"])) if line["meant"] else None,
        scale=value("scale"),
        in_sample=bool(line["in_sample"]),
        counted=not line["counted"],
        limit=value("limit"),
        digits=int(line["digits"] or 4),
    )  # fmt: skip


def group_rows(group: Callable[[], Iterable[Values]]) -> Iterator[Row]:
    """Yield the rows of a group with what it computes.

    Raises
    ------
    ValueError
        It computes more rows or fewer than ``rows.csv`` has.

    Examples
    --------
    >>> [round(row.exact, 2) for row in group_rows(calibrations.misprints)][:2]
    [8.86, 101.6]
    """
    for row, values in zip(published_rows()[group.__name__], group(), strict=True):
        computed: dict[str, Any] = dict(values)
        yield replace(row, **computed, why=reasons().get((row.item, row.condition), ""))


def thesis_rows(groups: Iterable[Callable[[], Iterable[Values]]]) -> list[Row]:
    """Compute the rows of groups; those that are missed say why.

    Examples
    --------
    >>> [row.verdict for row in thesis_rows([calibrations.misprints])][:2]
    ['misprint', 'misprint']
    """
    return [row for group in groups for row in group_rows(group)]
