"""Damping that ends stick-slip (6.3.2), and that of Table 5.5, which must not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from noise.thesis.row import Column, Row, above, below, number
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


def critical() -> Iterator[Row]:
    """Critical damping at 7.5 rad/s, and stick on either side of it."""
    listing = _listing_limit(_CASE)
    exact, calibrated = _limit(THESIS, _CASE), _limit(CALIBRATED, _CASE)
    for printed, where, digits in ((0.7599, "", 4), (0.76, "; figure 6.10", 3)):
        yield Row(
            "critical_damping", f"{_CASE}{where}", "Nm s/rad", number(printed),
            listing=listing, exact=exact, calibrated=calibrated, judged=Column.LISTING,
            meant=number(printed / 10.0), tolerance=0.001, limit=_HIGHEST, digits=digits,
        )  # fmt: skip
    for damping, published in (
        (0.05, above(LEAST_SUDDEN, "sticks")),
        (0.1, below(LEAST_SUDDEN, "slides")),
    ):
        case = replace(_CASE, damping=damping)
        yield Row(
            "sudden_share", str(case), "1", published,
            listing=listing_sudden_share(case), exact=sudden_share(THESIS, case), digits=2,
        )  # fmt: skip


def measured() -> Iterator[Row]:
    """Damping of Table 5.5, which must not end stick-slip at the speeds where it was measured."""
    for interference, support, printed, speed in (
        (0.279, LONG, 0.105, 4.5),
        (0.279, SHORT, 0.085, 2.6),
        (0.381, LONG, 0.236, 13.0),
        (0.381, SHORT, 0.080, 13.0),
    ):
        case = Case(speed, interference, support)
        yield Row(
            "damping", f"{case}: stick-slip needs less than what is computed", "Nm s/rad",
            above(printed, f"{printed:g}"), listing=_listing_limit(case),
            exact=_limit(THESIS, case), limit=_HIGHEST, digits=3,
        )  # fmt: skip


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
