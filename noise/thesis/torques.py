"""Shape and size of the torque at given conditions (5.1, 5.2, 6.1, 6.3), and what it makes.

Regimes, amplitudes and patterns; sliding speeds of a slip (6.3.1); mean torques; PDMS (5.1.2);
natural rubber before, on and after its transfer film (5.1.3, 5.2.2, 5.2.3), of which all numbers
were chosen so that the measured ones come out; the creak's peak.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import nan

import numpy as np

from models.condition import FIXED
from noise.thesis.row import Values
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    acceleration,
    both,
    listing_peak_speed,
    listing_run,
    mean_torque,
    motion,
    oscillation,
    peak_pressure,
    peak_speed,
    slip_pattern,
    strongest_line,
    strongest_share,
    sudden_share,
    torque_swing,
)
from sim.analysis.regime import LEAST_OSCILLATION

_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0, 13.0)
_SILICONE_SPEEDS = (0.25, 1.0, 5.0, 17.0)
_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"


def regimes() -> Iterator[Values]:
    """Sudden share of six traces that stick and slip; regime of a triangular and a harmonic one."""
    for place in (
        (0.25, 0.279, FIXED), (0.5, 0.279, FIXED), (1.0, 0.279, FIXED), (1.0, 0.279, SHORT),
        (2.5, 0.178, LONG), (1.0, 0.381, FIXED),
    ):  # fmt: skip
        yield both(sudden_share, Case(*place))
    for case in (Case(4.3, 0.178, LONG), Case(7.9, 0.279, SHORT)):
        yield both(sudden_share, case)
        yield both(_oscillation, case)
        yield both(_line_share, case)


def _oscillation(material: str, case: Case) -> float:
    return round(oscillation(material, case), 6)


def _line_share(material: str, case: Case) -> float:
    """Share of the strongest line, where there is an oscillation."""
    vibrates = oscillation(material, case) > LEAST_OSCILLATION
    return strongest_share(material, case) if vibrates else nan


def amplitudes() -> Iterator[Values]:
    """Swing of the torque's trace: what changes it (5.2.1) and what does not (6.1)."""
    for before, after in (
        (Case(1.0, 0.178, LONG), Case(2.5, 0.178, LONG)),
        (Case(1.0, 0.279, LONG), Case(1.0, 0.279, SHORT)),
        (Case(1.0, 0.381, LONG), Case(1.0, 0.381, SHORT)),
        (Case(1.0, 0.178, LONG), Case(1.0, 0.279, LONG)),
        (Case(1.0, 0.279, LONG), Case(1.0, 0.381, LONG)),
    ):
        yield both(partial(_swing_ratio, before), after)


def _swing_ratio(before: Case, material: str, after: Case) -> float:
    return round(torque_swing(material, after) / torque_swing(material, before), 6)


def patterns() -> Iterator[Values]:
    """Slips with and without superimposed oscillation in turn, through 2.5 rad/s (6.3.2)."""
    for speed in (1.0, 2.5):
        yield both(slip_pattern, Case(speed, 0.279, LONG))


def peaks() -> Iterator[Values]:
    """Largest sliding speed of a run from rest (Figures 6.1 and 6.4)."""
    for speed in (1.0, 10.0):
        for support in (LONG, SHORT):
            case = Case(speed, 0.279, support)
            yield {"listing": listing_peak_speed(case), **both(peak_speed, case)}


def first_slip() -> Iterator[Values]:
    """Largest sliding speed of the first slip (Figure 6.7), by which T_crit - T_kin is set."""
    case = Case(1.0, 0.381, SHORT)
    run, listing = motion(THESIS, case), listing_run(case)
    yield {
        "listing": _first_peak(listing.stuck, -listing.relative_speed),
        "exact": _first_peak(run.stuck, run.sliding_speed),
    }
    yield {"listing": listing_peak_speed(case), **both(peak_speed, case)}


def _first_peak(
    stuck: np.ndarray[tuple[int], np.dtype[np.bool_]],
    sliding: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> float:
    start = int(stuck.argmin())
    length = int(stuck[start:].argmax()) or sliding.size
    return float(sliding[start : start + length].max())


def friction() -> Iterator[Values]:
    """Mean torque: doubled and tripled by interference, hardly a function of speed."""
    for quantity in (mean_torque, _span):
        for interference in (0.178, 0.279, 0.381):
            yield both(quantity, Case(1.0, interference, FIXED))


def _span(material: str, case: Case) -> float:
    """Largest over smallest mean torque of all speeds."""
    return _spread_of([mean_torque(material, case.at(speed)) for speed in _SPEEDS])


def _spread_of(means: list[float]) -> float:
    return max(means) / min(means)


def silicone() -> Iterator[Values]:
    """PDMS: no vibration from 0.25 to 17 rad/s, torque about tripled."""
    for interference in (0.254, 0.381):
        for support in (LONG, FIXED):
            cases = [Case(v, interference, support) for v in _SILICONE_SPEEDS]
            yield {"calibrated": round(max(oscillation("PDMS", case) for case in cases), 9)}
            slow, fast = (mean_torque("PDMS", case) for case in (cases[0], cases[-1]))
            yield {"calibrated": fast / slow}


def natural_rubber() -> Iterator[Values]:
    """Return where it vibrates, at which frequency, and what the film changes."""
    for support in (LONG, SHORT):
        for material in (_NEW, _CLEANED):
            yield {"calibrated": strongest_line(material, Case(10.0, 0.127, support))}
    for material, speed, support in (
        (_NEW, 7.0, LONG), (_NEW, 10.0, LONG), (_CLEANED, 10.0, LONG), (_CLEANED, 1.0, SHORT),
    ):  # fmt: skip
        yield {"calibrated": sudden_share(material, Case(speed, 0.127, support))}
    for support, speeds in ((LONG, (1.0, 5.0, 10.0, 19.75)), (SHORT, (1.0, 5.0, 10.0))):
        means = [mean_torque(_CLEANED, Case(speed, 0.127, support)) for speed in speeds]
        yield {"calibrated": _spread_of(means)}
    for speed, support in ((1.0, LONG), (1.0, SHORT), (19.75, LONG)):
        yield {"calibrated": oscillation(_CLEANED, Case(speed, 0.127, support))}
    film = Case(7.5, 0.127, LONG)
    yield {"calibrated": mean_torque(_FILM, film) / mean_torque(_NEW, film)}
    yield {"calibrated": acceleration(_FILM, film)}
    yield {"calibrated": strongest_share(_FILM, film)}


def creak() -> Iterator[Values]:
    """Peak pressure of the creak: lower on the stiffer support, the same at all speeds (5.2.3)."""
    slow = Case(1.0, 0.381, LONG)
    before = peak_pressure(CALIBRATED, slow)
    for case in (Case(1.0, 0.381, SHORT), slow.at(5.0), slow.at(10.0)):
        yield {"calibrated": peak_pressure(CALIBRATED, case) / before}
