"""Sliding speeds of a slip (6.3.1), mean torques (5.1, 5.2.1), PDMS (5.1.2), the creak's peak."""

from __future__ import annotations

import numpy as np

from models.condition import FIXED
from noise.thesis.row import Column, Row, below, number
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    listing_peak_speed,
    listing_run,
    mean_torque,
    motion,
    oscillation,
    peak_speed,
    rig_of,
)
from sim.analysis.regime import LEAST_OSCILLATION
from sim.run import simulate

__all__ = ["creak", "first_slip", "friction", "peaks", "silicone"]

_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0, 13.0)
_SILICONE_SPEEDS = (0.25, 1.0, 5.0, 17.0)


def peaks() -> list[Row]:
    """Largest sliding speed of a run from rest (Figures 6.1 and 6.4)."""
    return [
        Row(
            "peak_sliding_speed", str(case), "rad/s", number(published),
            listing=listing_peak_speed(case), exact=peak_speed(THESIS, case),
            calibrated=peak_speed(CALIBRATED, case), digits=3,
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
            exact=_first_peak(run.stuck, run.sliding_speed), digits=3,
        ),
        Row(
            "peak_sliding_speed", f"{case}, all slips", "rad/s", number(45.0),
            listing=listing_peak_speed(case), exact=peak_speed(THESIS, case),
            calibrated=peak_speed(CALIBRATED, case), digits=3,
        ),
    ]  # fmt: skip


def _first_peak(
    stuck: np.ndarray[tuple[int], np.dtype[np.bool_]],
    sliding: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> float:
    start = int(stuck.argmin())
    length = int(stuck[start:].argmax()) or sliding.size
    return float(sliding[start : start + length].max())


def friction() -> list[Row]:
    """Mean torque: hardly a function of speed, doubled and tripled by interference."""
    rows = [
        Row(
            "mean_torque", f"{Case(1.0, interference, FIXED)}", "Nm", number(published),
            exact=mean_torque(THESIS, Case(1.0, interference, FIXED)),
            calibrated=mean_torque(CALIBRATED, Case(1.0, interference, FIXED)),
            judged=Column.CALIBRATED, measured=True, tolerance=0.1, digits=3,
        )
        for interference, published in ((0.178, 4.0), (0.279, 8.0), (0.381, 30.0))
    ]  # fmt: skip
    for interference in (0.178, 0.279, 0.381):
        spans = []
        for material in (THESIS, CALIBRATED):
            means = [mean_torque(material, Case(v, interference, FIXED)) for v in _SPEEDS]
            spans.append(max(means) / min(means))
        rows.append(
            Row(
                "mean_torque_ratio", f"{interference:g} mm, fixed clamp, largest over smallest, "
                "1 to 13 rad/s", "1", number(1.0, "little variation"), exact=spans[0],
                calibrated=spans[1], judged=Column.CALIBRATED, measured=True, tolerance=0.1,
                digits=3,
            )
        )  # fmt: skip
    return rows


def silicone() -> list[Row]:
    """PDMS: no vibration from 0.25 to 17 rad/s, torque about tripled."""
    rows = []
    for interference in (0.254, 0.381):
        for support in (LONG, FIXED):
            cases = [Case(v, interference, support) for v in _SILICONE_SPEEDS]
            place = f"PDMS, {cases[0].place()}"
            means = [mean_torque("PDMS", case) for case in (cases[0], cases[-1])]
            rows += [
                Row(
                    "oscillation", f"{place}, 0.25 to 17 rad/s", "1", below(LEAST_OSCILLATION),
                    calibrated=round(max(oscillation("PDMS", case) for case in cases), 9),
                    judged=Column.CALIBRATED, measured=True, digits=1,
                ),
                Row(
                    "mean_torque_ratio", f"{place}, 17 over 0.25 rad/s", "1",
                    number(3.0, "nearly 3"), calibrated=means[1] / means[0],
                    judged=Column.CALIBRATED, measured=True, tolerance=0.05, digits=3,
                ),
            ]  # fmt: skip
    return rows


def creak() -> list[Row]:
    """Peak pressure of the creak falls by about 25 % with the stiffer support (5.2.3)."""
    peak = {
        support: float(
            np.abs(
                simulate(
                    rig_of(CALIBRATED), 1.0, interference=0.381e-3, support_stiffness=support
                ).pressure
            ).max()
        )
        for support in (LONG, SHORT)
    }
    return [
        Row(
            "peak_pressure_ratio", "0.381 mm, 1 rad/s, 3745 over 2214 Nm/rad", "1", number(0.75),
            calibrated=peak[SHORT] / peak[LONG], judged=Column.CALIBRATED, measured=True,
            tolerance=0.1, digits=2,
        )
    ]  # fmt: skip
