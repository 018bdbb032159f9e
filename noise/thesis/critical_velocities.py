"""Critical speeds of Tables 5.1 and 5.2, and stick-slip as the thesis simulated it (6.3.1).

The thesis simulated at 1, 2.5, 5, 7.5 and 10 rad/s, so "stick-slip through 5 rad/s" admits an end
anywhere below 7.5. What ends it is the same for all: `sim.analysis.critical_speeds`.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isinf, nan

from models.condition import FIXED
from noise.thesis.row import Column, Published, Row, above, below, between, number
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    both,
    listing_sudden_share,
    rig_of,
    sudden_share,
)
from sim.analysis.critical_damping import with_damping
from sim.analysis.critical_speeds import SPEEDS, critical_speeds
from sim.analysis.slips import LEAST_SUDDEN

_STEP = SPEEDS[1] - SPEEDS[0]
_SECONDS = 1.0
TRANSITIONS = {
    (0.178, LONG): (below(1.0), number(4.6)),
    (0.178, SHORT): (below(1.0), number(5.9)),
    (0.178, FIXED): (below(1.0), number(2.7)),
    (0.279, LONG): (number(4.5), number(7.9)),
    (0.279, SHORT): (number(2.6), number(12.5)),
    (0.279, FIXED): (number(2.5), number(8.3)),
    (0.381, LONG): (above(13.0), above(13.0)),
    (0.381, SHORT): (above(13.0), above(13.0)),
    (0.381, FIXED): (above(13.0), above(13.0)),
}
"""V_crit1 and V_crit2 by interference [mm] and support stiffness, Tables 5.1 and 5.2."""

MEASURED = tuple(Case(1.0, *place) for place in TRANSITIONS)


def transitions(case: Case) -> Iterator[Row]:
    """V_crit1, V_crit2, and the quasi-harmonic regime between them."""
    place = case.interference, case.support_stiffness
    exact, calibrated = (critical_speeds(rig_of(m), *place) for m in (THESIS, CALIBRATED))
    listing = nan if case.fixed else _listing_end(case)
    published = TRANSITIONS[case.interference_mm, case.support_stiffness]
    where = case.place()
    # What `noise.training.calibrate` searches by: all but V_crit1 at 0.178 mm.
    thin = case.interference_mm == 0.178
    yield _row(
        "v_crit1", where, published[0], listing, exact.v_crit1, calibrated.v_crit1,
        in_sample=not thin,
    )  # fmt: skip
    yield _row(
        "v_crit2", where, published[1], nan, exact.v_crit2, calibrated.v_crit2, in_sample=True
    )
    if case.interference_mm == 0.279:
        printed = published[1].low - published[0].low
        yield Row(
            "quasi_harmonic_range", where, "rad/s", number(printed),
            exact=exact.v_crit2 - exact.v_crit1,
            calibrated=calibrated.v_crit2 - calibrated.v_crit1, measured=True,
            tolerance=2.0 * _STEP / printed, digits=3, in_sample=True, counted=False,
        )  # fmt: skip


def _row(
    item: str, place: str, published: Published, listing: float, exact: float,
    calibrated: float, *, in_sample: bool,
) -> Row:  # fmt: skip
    finite = published.high if isinf(published.low) else published.low
    return Row(
        item, place, "rad/s", published, listing=listing, exact=exact, calibrated=calibrated,
        judged=Column.CALIBRATED, measured=True, tolerance=_STEP / finite, limit=SPEEDS[-1],
        digits=4, in_sample=in_sample,
    )  # fmt: skip


def simulated() -> Iterator[Row]:
    """Stick-slip as 6.3.1 reports it of the simulation."""
    ends: dict[float, tuple[float, float]] = {}
    for case, published in (
        (Case(1.0, 0.279, LONG), between(7.5, 10.0, "7.5, not 10")),
        (Case(1.0, 0.279, SHORT), between(5.0, 7.5, "5, not 7.5")),
        (Case(1.0, 0.381, LONG), above(10.0)),
        (Case(1.0, 0.381, LONG, 0.080), above(10.0)),
        (Case(1.0, 0.381, SHORT), above(10.0)),
    ):
        rig = rig_of(THESIS)
        if case.damping is not None:
            rig = with_damping(rig, case.damping)
        listing = _listing_end(case)
        exact = critical_speeds(rig, case.interference, case.support_stiffness).v_crit1
        if case.interference_mm == 0.279:
            ends[case.support_stiffness] = (listing, exact)
        yield Row(
            "simulated_stick_slip", case.place(), "rad/s", published,
            listing=listing, exact=exact, limit=SPEEDS[-1],
        )  # fmt: skip
    ratios = [b / a for a, b in zip(ends[LONG], ends[SHORT], strict=True)]
    yield Row(
        "simulated_stick_slip_ratio", "0.279 mm, 3745 over 2214 Nm/rad", "1", below(1.0),
        listing=ratios[0], exact=ratios[1], digits=3,
    )  # fmt: skip


def contradiction() -> Iterator[Row]:
    """0.178 mm at 1 rad/s: quasi-harmonic in Table 5.1, stick-slip in 5.2.1."""
    case = Case(1.0, 0.178, LONG)
    # What Table 5.1 says there is its V_crit1 below 1 rad/s.
    for where, published, counted in (
        ("Table 5.1", below(LEAST_SUDDEN, "quasi-harmonic"), False),
        ("5.2.1", above(LEAST_SUDDEN, "stick-slip"), True),
    ):
        yield Row(
            "sudden_share", f"{case}, {where}", "1", published, **both(sudden_share, case),
            judged=Column.CALIBRATED, measured=True, digits=2, counted=counted,
        )  # fmt: skip


def _listing_end(case: Case) -> float:
    """Last speed at which the listing sticks and slips [rad/s]."""
    sticking = [v for v in SPEEDS if listing_sudden_share(case.at(v), _SECONDS) > LEAST_SUDDEN]
    last = max(sticking, default=0.0)
    return inf if last == SPEEDS[-1] else last
