"""Critical speeds of Tables 5.1 and 5.2, and stick-slip as the thesis simulated it (6.3.1).

The thesis simulated at 1, 2.5, 5, 7.5 and 10 rad/s, so "stick-slip through 5 rad/s" admits an end
anywhere below 7.5. What ends it is the same for all: `sim.analysis.critical_speeds`.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, nan

from models.condition import FIXED
from noise.thesis.row import Values
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

_SECONDS = 1.0


def transitions() -> Iterator[Values]:
    """V_crit1, V_crit2, and at 0.279 mm the quasi-harmonic regime between them."""
    for interference in (0.178, 0.279, 0.381):
        for support in (LONG, SHORT, FIXED):
            case = Case(1.0, interference, support)
            place = case.interference, support
            exact, calibrated = (critical_speeds(rig_of(m), *place) for m in (THESIS, CALIBRATED))
            listing = nan if case.fixed else _listing_end(case)
            yield {
                "listing": listing, "exact": exact.v_crit1, "calibrated": calibrated.v_crit1
            }  # fmt: skip
            yield {"exact": exact.v_crit2, "calibrated": calibrated.v_crit2}
            if interference == 0.279:
                yield {
                    "exact": exact.v_crit2 - exact.v_crit1,
                    "calibrated": calibrated.v_crit2 - calibrated.v_crit1,
                }


def simulated() -> Iterator[Values]:
    """Stick-slip as 6.3.1 reports it of the simulation, and the ratio of two ends."""
    ends = []
    for case in (
        Case(1.0, 0.279, LONG),
        Case(1.0, 0.279, SHORT),
        Case(1.0, 0.381, LONG),
        Case(1.0, 0.381, LONG, 0.080),
        Case(1.0, 0.381, SHORT),
    ):
        rig = rig_of(THESIS)
        if case.damping is not None:
            rig = with_damping(rig, case.damping)
        exact = critical_speeds(rig, case.interference, case.support_stiffness).v_crit1
        ends.append((_listing_end(case), exact))
        yield {"listing": ends[-1][0], "exact": exact}
    listing, exact = (b / a for a, b in zip(ends[0], ends[1], strict=True))
    yield {"listing": listing, "exact": exact}


def contradiction() -> Iterator[Values]:
    """0.178 mm at 1 rad/s: quasi-harmonic in Table 5.1, stick-slip in 5.2.1."""
    found = both(sudden_share, Case(1.0, 0.178, LONG))
    yield from (found, found)


def _listing_end(case: Case) -> float:
    """Last speed at which the listing sticks and slips [rad/s]."""
    sticking = [v for v in SPEEDS if listing_sudden_share(case.at(v), _SECONDS) > LEAST_SUDDEN]
    last = max(sticking, default=0.0)
    return inf if last == SPEEDS[-1] else last
