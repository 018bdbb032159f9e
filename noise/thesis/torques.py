"""Sliding speeds of a slip (6.3.1), mean torques (5.1, 5.2.1), PDMS (5.1.2), the creak's peak."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.condition import FIXED
from noise.thesis.row import Column, Row, below, number
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    both,
    listing_peak_speed,
    listing_run,
    mean_torque,
    motion,
    oscillation,
    peak_pressure,
    peak_speed,
)
from sim.analysis.regime import LEAST_OSCILLATION

_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0, 13.0)
_SILICONE_SPEEDS = (0.25, 1.0, 5.0, 17.0)


def peaks() -> list[Row]:
    """Largest sliding speed of a run from rest (Figures 6.1 and 6.4)."""
    return [
        Row(
            "peak_sliding_speed", str(case), "rad/s", number(published),
            listing=listing_peak_speed(case), **both(peak_speed, case), digits=3,
        )
        for speed, published in ((1.0, 24.0), (10.0, 18.0))
        for case in (Case(speed, 0.279, LONG), Case(speed, 0.279, SHORT))
    ]  # fmt: skip


def first_slip() -> list[Row]:
    """Largest sliding speed of the first slip (Figure 6.7), by which T_crit - T_kin is set."""
    case = Case(1.0, 0.381, SHORT)
    run = motion(THESIS, case)
    listing = listing_run(case)
    return [
        Row(
            "peak_sliding_speed", f"{case}, first slip", "rad/s", number(45.0),
            listing=_first_peak(listing.stuck, -listing.relative_speed),
            exact=_first_peak(run.stuck, run.sliding_speed), digits=3, in_sample=True,
        ),
        Row(
            "peak_sliding_speed", f"{case}, all slips", "rad/s", number(45.0),
            listing=listing_peak_speed(case), **both(peak_speed, case), digits=3, in_sample=True,
        ),
    ]  # fmt: skip


def _first_peak(
    stuck: np.ndarray[tuple[int], np.dtype[np.bool_]],
    sliding: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> float:
    start = int(stuck.argmin())
    length = int(stuck[start:].argmax()) or sliding.size
    return float(sliding[start : start + length].max())


def friction() -> Iterator[Row]:
    """Mean torque: hardly a function of speed, doubled and tripled by interference."""
    for interference, published in ((0.178, 4.0), (0.279, 8.0), (0.381, 30.0)):
        case = Case(1.0, interference, FIXED)
        yield Row(
            "mean_torque", str(case), "Nm", number(published), **both(mean_torque, case),
            judged=Column.CALIBRATED, measured=True, tolerance=0.1, digits=3, in_sample=True,
        )  # fmt: skip
    for interference in (0.178, 0.279, 0.381):
        yield Row(
            "mean_torque_ratio", f"{interference:g} mm, fixed clamp, largest over smallest, "
            "1 to 13 rad/s", "1", number(1.0, "little variation"),
            **both(_span, Case(1.0, interference, FIXED)), judged=Column.CALIBRATED,
            measured=True, tolerance=0.1, digits=3, in_sample=interference == 0.279,
        )  # fmt: skip


def _span(material: str, case: Case) -> float:
    """Largest over smallest mean torque of all speeds."""
    means = [mean_torque(material, case.at(speed)) for speed in _SPEEDS]
    return max(means) / min(means)


def silicone() -> Iterator[Row]:
    """PDMS: no vibration from 0.25 to 17 rad/s, torque about tripled."""
    for interference in (0.254, 0.381):
        for support in (LONG, FIXED):
            cases = [Case(v, interference, support) for v in _SILICONE_SPEEDS]
            place = f"PDMS, {cases[0].place()}"
            means = [mean_torque("PDMS", case) for case in (cases[0], cases[-1])]
            yield Row(
                "oscillation", f"{place}, 0.25 to 17 rad/s", "1", below(LEAST_OSCILLATION),
                calibrated=round(max(oscillation("PDMS", case) for case in cases), 9),
                judged=Column.CALIBRATED, measured=True, digits=1, in_sample=True,
            )  # fmt: skip
            yield Row(
                "mean_torque_ratio", f"{place}, 17 over 0.25 rad/s", "1",
                number(3.0, "nearly 3"), calibrated=means[1] / means[0],
                judged=Column.CALIBRATED, measured=True, tolerance=0.05, digits=3, in_sample=True,
            )  # fmt: skip


def creak() -> Iterator[Row]:
    """Peak pressure of the creak: lower on the stiffer support, the same at all speeds (5.2.3)."""
    slow = Case(1.0, 0.381, LONG)
    before = peak_pressure(CALIBRATED, slow)
    for case, published, where in (
        (Case(1.0, 0.381, SHORT), 0.75, "3745 over 2214 Nm/rad"),
        (slow.at(5.0), 1.0, "2214 Nm/rad, 5 over 1 rad/s"),
        (slow.at(10.0), 1.0, "2214 Nm/rad, 10 over 1 rad/s"),
    ):
        at = "1 rad/s, " if case.speed == 1.0 else ""
        yield Row(
            "peak_pressure_ratio", f"0.381 mm, {at}{where}", "1", number(published),
            calibrated=peak_pressure(CALIBRATED, case) / before, judged=Column.CALIBRATED,
            measured=True, tolerance=0.1, digits=2,
        )  # fmt: skip
