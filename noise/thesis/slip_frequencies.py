"""Slip frequencies: how they rise with speed, and the mode that they never pass (5.1, 5.2.1).

Conclusion 3 bounds the slip frequency on beams by the first torsional mode, measured at 250 and
310 Hz. At 0.381 mm it rises by 10 to 25 Hz for each 2.5 rad/s. A constant-torque model that truly
sticks does neither: while it sticks its torque rises at k_EFF times the speed, so its slips come
ever faster. At 0.381 mm and 2214 Nm/rad the printed damping ends stick-slip by 5 rad/s, so the
model is also run with 0.080, that at 3745 Nm/rad.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from models.condition import FIXED
from noise.thesis.row import Column, Row, above, below, between, number
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    both,
    cycle_frequency,
    listing_slip_frequency,
    slip_frequency,
    strongest_line,
    third_over_second,
)

_MODES = {LONG: 250.0, SHORT: 310.0}
"""First torsional mode, measured [Hz]."""

_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0)
_UNDAMPED = 0.080
"""c_E without the beat that made it 0.236 [Nm s/rad]."""

BOUNDED = (
    (Case(1.0, 0.279, LONG), (1.0, 2.5, 5.0)),
    (Case(1.0, 0.279, SHORT), (1.0, 2.5, 5.0)),
    (Case(1.0, 0.381, LONG, _UNDAMPED), _SPEEDS),
    (Case(1.0, 0.381, SHORT), _SPEEDS),
)
"""Conditions and speeds for `bounded`, up to where the equations stick."""

_RISE = (10.0, 25.0)
"""For each 2.5 rad/s at 0.381 mm [Hz]."""


def bounded(case: Case, speeds: Sequence[float]) -> Iterator[Row]:
    """Slip frequency at speeds of the vibration study, below the first torsional mode."""
    for at in (case.at(speed) for speed in speeds):
        yield Row(
            "slip_frequency", str(at), "Hz", below(_MODES[case.support_stiffness]),
            listing=listing_slip_frequency(at), **both(slip_frequency, at), measured=True, digits=3,
            in_sample=_chosen(at.speed) and at.interference_mm == 0.381,
        )  # fmt: skip


def _chosen(slower: float) -> bool:
    """Whether the slips at 0.381 mm at and above a speed [rad/s] had a part in the calibration."""
    return slower >= 2.5


def rising() -> Iterator[Row]:
    """Rise of the slip frequency from one speed to the next at 0.381 mm."""
    case = Case(1.0, 0.381, LONG, _UNDAMPED)
    of_speeds = [case.at(speed) for speed in _SPEEDS]
    listing = np.diff([listing_slip_frequency(at) for at in of_speeds]).tolist()
    exact, calibrated = (
        np.diff([slip_frequency(material, at) for at in of_speeds]).tolist()
        for material in (THESIS, CALIBRATED)
    )
    for i, (low, high) in enumerate(pairwise(_SPEEDS)):
        steps = (high - low) / 2.5
        yield Row(
            "slip_frequency_rise", f"{case.place()}, {low:g} to {high:g} rad/s", "Hz",
            between(_RISE[0] * steps, _RISE[1] * steps),
            listing=listing[i], exact=exact[i], calibrated=calibrated[i], measured=True, digits=3,
            in_sample=_chosen(low),
        )  # fmt: skip


def at_fixed_clamp() -> Iterator[Row]:
    """Classical stick-slip, and the one peak at the lowest interference."""
    classical = Case(1.0, 0.279, FIXED)
    exact, calibrated = (slip_frequency(material, classical) for material in (THESIS, CALIBRATED))
    for factor, frequency, harmonic in (
        (1, 155.0, ""),
        (4, 620.0, ", fourth harmonic"),
        (6, 930.0, ", sixth harmonic"),
    ):
        yield Row(
            "slip_frequency", f"{classical}{harmonic}", "Hz", number(frequency),
            exact=factor * exact, calibrated=factor * calibrated,
            measured=True, tolerance=0.02, digits=3, counted=factor == 1,
        )  # fmt: skip
    for speed in (1.0, 2.5):
        case = Case(speed, 0.178, FIXED)
        yield Row(
            "strongest_line", str(case), "Hz", number(1250.0), **both(strongest_line, case),
            measured=True, tolerance=0.05,
        )  # fmt: skip


def harmonics() -> Iterator[Row]:
    """Which harmonics of the slip frequency stand out in the torque (5.2.1).

    At 1 and 2.5 rad/s that is the third, "due to the proximity" of the first torsional mode
    (6.3.2): slips come at a third of that, between the mode measured and that of the stuck model.
    """
    for speed in (1.0, 2.5):
        case = Case(speed, 0.279, LONG)
        yield Row(
            "slip_frequency", f"{case}, third harmonic on the first torsional mode", "Hz",
            between(83.0, 99.0), **both(slip_frequency, case), judged=Column.CALIBRATED,
            measured=True, tolerance=0.05, digits=3,
        )  # fmt: skip
        yield Row(
            "third_over_second_harmonic", str(case), "1", above(1.0),
            **both(third_over_second, case), measured=True, digits=2,
        )  # fmt: skip
    for speed in (5.0, 7.5):
        case = Case(speed, 0.279, LONG)
        yield Row(
            "strongest_harmonic", str(case), "1", number(4.0), **both(_strongest_harmonic, case),
            judged=Column.CALIBRATED, measured=True, tolerance=0.1, digits=2,
        )  # fmt: skip


def constant() -> Iterator[Row]:
    """Where the peaks of the autospectra do not move with the speed (5.2.1).

    They "were identified as the harmonics of the fundamental frequency", so that is what must stay,
    slip or not. Which of them is the strongest is another matter: where several are within 2 dB it
    changes though no peak moves.
    """
    for before, after in (
        (Case(1.0, 0.178, LONG), Case(2.5, 0.178, LONG)),
        (Case(5.0, 0.279, LONG), Case(7.5, 0.279, LONG)),
        (Case(2.5, 0.279, SHORT), Case(5.0, 0.279, SHORT)),
        (Case(2.5, 0.279, SHORT), Case(7.5, 0.279, SHORT)),
    ):
        exact, calibrated = (
            cycle_frequency(material, after) / cycle_frequency(material, before)
            for material in (THESIS, CALIBRATED)
        )
        yield Row(
            "cycle_frequency_ratio", f"{after}, over that at {before.speed:g} rad/s", "1",
            number(1.0), exact=exact, calibrated=calibrated, judged=Column.CALIBRATED,
            measured=True, tolerance=0.05, digits=3,
        )  # fmt: skip


def _strongest_harmonic(material: str, case: Case) -> float:
    return strongest_line(material, case) / cycle_frequency(material, case)


def falling_with_interference() -> Iterator[Row]:
    """Fundamental frequency at one interference over that at the next lower one (5.2.1)."""
    for low, high in ((0.178, 0.279), (0.279, 0.381)):
        for support in (LONG, FIXED):
            before, after = Case(1.0, low, support), Case(1.0, high, support)
            exact, calibrated = (
                cycle_frequency(material, after) / cycle_frequency(material, before)
                for material in (THESIS, CALIBRATED)
            )
            yield Row(
                "cycle_frequency_ratio", f"{after}, over that at {low:g} mm", "1", below(1.0),
                exact=exact, calibrated=calibrated, measured=True, digits=3,
            )  # fmt: skip
