"""Shape of the torque at given conditions: regime, amplitude, pattern (5.1, 5.2, 6.3)."""

from __future__ import annotations

from collections.abc import Iterator
from math import nan

from models.condition import FIXED
from noise.thesis.row import Column, Row, above, below, number
from noise.thesis.runs import (
    LONG,
    SHORT,
    Case,
    both,
    oscillation,
    slip_pattern,
    strongest_share,
    sudden_share,
    torque_swing,
)
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import LEAST_SUDDEN

_STICK_SLIP = above(LEAST_SUDDEN, "stick-slip")
_NO_STICK_SLIP = below(LEAST_SUDDEN, "no stick-slip")
_SAME = 0.25
"""Amplitudes that "did not vary" may differ by as much [-]; they were read from traces."""


def regimes() -> Iterator[Row]:
    """Regimes of traces that are shown or described (Figure 5.1, 5.1.1, 5.2.1)."""
    for case, where in (
        (Case(0.25, 0.279, FIXED), "lowest velocities, 5.1.1"),
        (Case(0.5, 0.279, FIXED), "lowest velocities, 5.1.1"),
        (Case(1.0, 0.279, FIXED), "Figure 5.1(a)"),
        (Case(1.0, 0.279, SHORT), "Figure 5.1(b)"),
        (Case(2.5, 0.178, LONG), "5.2.1"),
        (Case(1.0, 0.381, FIXED), "Figure 5.15(b)"),
    ):
        yield Row(
            "sudden_share", f"{case}, {where}", "1", _STICK_SLIP, **both(sudden_share, case),
            judged=Column.CALIBRATED, measured=True, digits=2,
        )  # fmt: skip
    for case, where in (
        (Case(4.3, 0.178, LONG), "triangular, Figure 5.1(c)"),
        (Case(7.9, 0.279, SHORT), "harmonic, Figure 5.1(d)"),
    ):
        yield Row(
            "sudden_share", f"{case}, {where}", "1", _NO_STICK_SLIP, **both(sudden_share, case),
            judged=Column.CALIBRATED, measured=True, digits=2,
        )  # fmt: skip
        yield Row(
            "oscillation", f"{case}, {where}", "1", above(LEAST_OSCILLATION),
            **both(_oscillation, case), judged=Column.CALIBRATED, measured=True, digits=2,
        )  # fmt: skip
        yield Row(
            "strongest_share", f"{case}, {where}, primarily one frequency", "1", above(0.5),
            **both(_line_share, case), judged=Column.CALIBRATED, measured=True, digits=2,
        )  # fmt: skip


def _oscillation(material: str, case: Case) -> float:
    return round(oscillation(material, case), 6)


def _line_share(material: str, case: Case) -> float:
    """Share of the strongest line, where there is an oscillation."""
    vibrates = oscillation(material, case) > LEAST_OSCILLATION
    return strongest_share(material, case) if vibrates else nan


def amplitudes() -> Iterator[Row]:
    """Swing of the torque's trace: what changes it (5.2.1) and what does not (6.1)."""
    for before, after, published, where in (
        (Case(1.0, 0.178, LONG), Case(2.5, 0.178, LONG), number(1.0), "over 1 rad/s, 5.2.1"),
        (Case(1.0, 0.279, LONG), Case(1.0, 0.279, SHORT), number(1.0), "over 2214 Nm/rad, 6.1"),
        (Case(1.0, 0.381, LONG), Case(1.0, 0.381, SHORT), number(1.0), "over 2214 Nm/rad, 6.1"),
        (Case(1.0, 0.178, LONG), Case(1.0, 0.279, LONG), above(1.0), "over 0.178 mm, 5.2.1"),
        (Case(1.0, 0.279, LONG), Case(1.0, 0.381, LONG), above(1.0), "over 0.279 mm, 5.2.1"),
    ):

        def ratio(material: str, _: Case, before: Case = before, after: Case = after) -> float:
            return round(torque_swing(material, after) / torque_swing(material, before), 6)

        yield Row(
            "torque_swing_ratio", f"{after}, {where}", "1", published, **both(ratio, after),
            judged=Column.CALIBRATED, measured=True, tolerance=_SAME, digits=2,
        )  # fmt: skip


def patterns() -> Iterator[Row]:
    """Slips with and without superimposed oscillation in turn, through 2.5 rad/s (6.3.2)."""
    for speed in (1.0, 2.5):
        case = Case(speed, 0.279, LONG)
        yield Row(
            "slip_pattern", f"{case}, slips until alike", "1", number(2.0),
            **both(slip_pattern, case), judged=Column.CALIBRATED, measured=True, digits=1,
        )  # fmt: skip
