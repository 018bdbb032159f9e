"""Damping that ends stick-slip (6.3.2), and that of Table 5.5, which must not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from noise.thesis.row import Values
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    listing_sudden_share,
    rig_of,
    sudden_share,
)
from sim.analysis.critical_damping import critical_damping, largest_sticking
from sim.analysis.slips import LEAST_SUDDEN

_CASE = Case(7.5, 0.279, SHORT)
_HIGHEST = 0.3
"""Where searches start [Nm s/rad]."""

_TOLERANCE = 1e-5
_SECONDS = 1.0


def critical() -> Iterator[Values]:
    """Critical damping at 7.5 rad/s, printed twice, and stick on either side of it."""
    found = {
        "listing": _listing_limit(_CASE),
        "exact": _limit(THESIS, _CASE),
        "calibrated": _limit(CALIBRATED, _CASE),
    }
    yield from (found, found)
    for damping in (0.05, 0.1):
        case = replace(_CASE, damping=damping)
        yield {"listing": listing_sudden_share(case), "exact": sudden_share(THESIS, case)}


def measured() -> Iterator[Values]:
    """Damping of Table 5.5, which must not end stick-slip at the speeds where it was measured."""
    for interference, support, speed in (
        (0.279, LONG, 4.5), (0.279, SHORT, 2.6), (0.381, LONG, 13.0), (0.381, SHORT, 13.0),
    ):  # fmt: skip
        case = Case(speed, interference, support)
        yield {"listing": _listing_limit(case), "exact": _limit(THESIS, case)}


def _limit(material: str, case: Case) -> float:
    return critical_damping(
        rig_of(material),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        highest=_HIGHEST,
        tolerance=_TOLERANCE,
        seconds=_SECONDS,
    )


def _listing_limit(case: Case) -> float:
    def sticks(damping: float) -> bool:
        # Below any damping that matters; the listing takes none of zero.
        at = replace(case, damping=max(damping, 1e-9))
        return listing_sudden_share(at, _SECONDS) > LEAST_SUDDEN

    return largest_sticking(sticks, _HIGHEST, _TOLERANCE)
