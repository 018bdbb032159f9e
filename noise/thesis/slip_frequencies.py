"""Slip frequencies: how they rise with speed, and the mode that they never pass (5.1, 5.2.1).

Conclusion 3 bounds the slip frequency on beams by the first torsional mode, measured at 250 and
310 Hz. At 0.381 mm it rises by 10 to 25 Hz for each 2.5 rad/s. A constant-torque model that truly
sticks does neither: while it sticks its torque rises at k_EFF times the speed, so its slips come
ever faster. At 0.381 mm and 2214 Nm/rad the printed damping ends stick-slip by 5 rad/s, so the
model is also run with 0.080, that at 3745 Nm/rad.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from models.condition import FIXED
from noise.thesis.row import Values
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

_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0)
_UNDAMPED = 0.080
"""c_E without the beat that made it 0.236 [Nm s/rad]."""


def bounded() -> Iterator[Values]:
    """Slip frequency at speeds of the vibration study, below the first torsional mode.

    Speeds are those up to where the equations stick.
    """
    for case, speeds in (
        (Case(1.0, 0.279, LONG), _SPEEDS[:3]),
        (Case(1.0, 0.279, SHORT), _SPEEDS[:3]),
        (Case(1.0, 0.381, LONG, _UNDAMPED), _SPEEDS),
        (Case(1.0, 0.381, SHORT), _SPEEDS),
    ):
        for at in (case.at(speed) for speed in speeds):
            yield {"listing": listing_slip_frequency(at), **both(slip_frequency, at)}


def rising() -> Iterator[Values]:
    """Rise of the slip frequency from one speed to the next at 0.381 mm."""
    of_speeds = [Case(speed, 0.381, LONG, _UNDAMPED) for speed in _SPEEDS]
    rises = [
        np.diff([frequency(at) for at in of_speeds]).tolist()
        for frequency in (
            listing_slip_frequency,
            partial(slip_frequency, THESIS),
            partial(slip_frequency, CALIBRATED),
        )
    ]
    for listing, exact, calibrated in zip(*rises, strict=True):
        yield {"listing": listing, "exact": exact, "calibrated": calibrated}


def at_fixed_clamp() -> Iterator[Values]:
    """Classical stick-slip and its harmonics, and the one peak at the lowest interference."""
    found = both(slip_frequency, Case(1.0, 0.279, FIXED))
    for factor in (1, 4, 6):
        yield {column: factor * value for column, value in found.items()}
    for speed in (1.0, 2.5):
        yield both(strongest_line, Case(speed, 0.178, FIXED))


def harmonics() -> Iterator[Values]:
    """Which harmonics of the slip frequency stand out in the torque (5.2.1).

    At 1 and 2.5 rad/s that is the third, "due to the proximity" of the first torsional mode
    (6.3.2): slips come at a third of that, between the mode measured and that of the stuck model.
    """
    for speed in (1.0, 2.5):
        case = Case(speed, 0.279, LONG)
        yield both(slip_frequency, case)
        yield both(third_over_second, case)
    for speed in (5.0, 7.5):
        yield both(_strongest_harmonic, Case(speed, 0.279, LONG))


def constant() -> Iterator[Values]:
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
        yield both(partial(_cycle_ratio, before), after)


def _cycle_ratio(before: Case, material: str, after: Case) -> float:
    return cycle_frequency(material, after) / cycle_frequency(material, before)


def _strongest_harmonic(material: str, case: Case) -> float:
    return strongest_line(material, case) / cycle_frequency(material, case)


def falling_with_interference() -> Iterator[Values]:
    """Fundamental frequency at one interference over that at the next lower one (5.2.1)."""
    for low, high in ((0.178, 0.279), (0.279, 0.381)):
        for support in (LONG, FIXED):
            before, after = Case(1.0, low, support), Case(1.0, high, support)
            yield both(partial(_cycle_ratio, before), after)
