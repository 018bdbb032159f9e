"""Slip frequencies as a second measure, which no candidate is fitted to.

Conclusion 3: with beams the slip frequency never exceeds the first torsional mode, 250 or 310 Hz.
5.2.1: at 0.381 mm it rises by 10 to 25 Hz with each 2.5 rad/s. With the clamp fixed, at 1 rad/s and
0.279 mm, the harmonics at 620 and 930 Hz make it 155 Hz. All three are errors of a logarithm, those
of the first two nil where they hold. Slips are those that the torque shows (`sim.analysis.slips`),
or else its periods, since a contact that creeps knows no end of stick. Where nothing repeats
although the rig vibrated, the error counts as log 2.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.thesis.repetition import repetition_rate
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import motion_slips
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["RISES", "SLIPS", "SLIP_CELLS", "slip_errors", "slip_reading_error"]

_MODES = {2214.0: 250.0, 3745.0: 310.0}
"""First torsional mode by support stiffness, measured [Hz]."""

_THIN_SPEEDS = (1.0, 2.5, 5.0)
_THICK_SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0)
_FIXED_FREQUENCY = 155.0
_RISE = (10.0, 25.0)
"""For each 2.5 rad/s [Hz]."""

_SECONDS, _RATE = 1.5, 30e3
_MISSING = math.log(2.0)
_RESOLUTION = 1.0 / 0.23
"""Of a spectrum of the thesis's runs [Hz]."""

SLIP_CELLS = (
    *(
        f"{mm:g} mm, {support:g} Nm/rad, {speed:g} rad/s: at most {mode:g} Hz"
        for mm, speeds in ((0.279, _THIN_SPEEDS), (0.381, _THICK_SPEEDS))
        for support, mode in _MODES.items()
        for speed in speeds
    ),
    "0.279 mm, fixed, 1 rad/s: 155 Hz",
    *(
        f"0.381 mm, {support:g} Nm/rad, {low:g} to {high:g} rad/s: 10 to 25 Hz each 2.5 rad/s"
        for support in _MODES
        for low, high in pairwise(_THICK_SPEEDS)
    ),
)
"""What each error is about."""

SLIPS, RISES = slice(0, 17), slice(17, len(SLIP_CELLS))
"""Bounds and the number, by which candidates are judged; and the rises, which are only shown. A
drop of 6.94 Nm that truly sticks at all speeds cannot rise so slowly: the torque rises by k_EFF
times speed times time."""


def slip_errors(rig: Rig) -> NDArray[np.float64]:
    """Errors of the slip frequencies, shape (n_slip_cells,), in the order of `SLIP_CELLS`."""
    bounds: list[float] = []
    rises: list[float] = []
    for interference, speeds in ((0.279e-3, _THIN_SPEEDS), (0.381e-3, _THICK_SPEEDS)):
        for support, mode in _MODES.items():
            rates = [_slip_rate(rig, interference, support, speed) for speed in speeds]
            bounds += [
                _MISSING if rate is None else max(0.0, math.log(rate / mode)) for rate in rates
            ]
            if speeds is _THICK_SPEEDS:
                steps = zip(pairwise(speeds), pairwise(rates), strict=True)
                rises += [_rise_error((high - low) / 2.5, *pair) for (low, high), pair in steps]
    fixed = _slip_rate(rig, 0.279e-3, math.inf, 1.0)
    number = _MISSING if fixed is None else math.log(fixed / _FIXED_FREQUENCY)
    return np.array([*bounds, number, *rises])


def slip_reading_error() -> NDArray[np.float64]:
    """Return the standard error that the resolution of the spectra alone makes of each cell.

    Examples
    --------
    >>> slip_reading_error().size == len(SLIP_CELLS)
    True
    """
    one = _RESOLUTION / math.sqrt(12.0)
    modes = [one / mode for n in (3, 5) for mode in _MODES.values() for _ in range(n)]
    rises = [
        math.sqrt(2.0) * one / mode for mode in _MODES.values() for _ in pairwise(_THICK_SPEEDS)
    ]
    return np.array([*modes, one / _FIXED_FREQUENCY, *rises])


def _slip_rate(rig: Rig, interference: float, support: float, speed: float) -> float | None:
    """Slips a second, or periods of the torque [Hz]."""
    try:
        motion = simulate_motion(
            rig,
            ConstantSpeed(speed),
            interference=interference,
            support_stiffness=support,
            seconds=_SECONDS,
            rate=_RATE,
        )
    except ParameterError:
        return None
    last = motion.since(motion.torque.size // 4)
    if float(last.torque.std()) <= LEAST_OSCILLATION * abs(float(last.torque.mean())):
        return None
    found = repetition_rate(motion_slips(last), last.torque, _RATE)
    return None if math.isnan(found) else found


def _rise_error(steps: float, before: float | None, after: float | None) -> float:
    """Distance of a frequency from where the rise must bring it, on a logarithmic scale.

    Examples
    --------
    >>> _rise_error(1.0, 100.0, 115.0), round(_rise_error(1.0, 100.0, 250.0), 2)
    (0.0, 0.69)
    """
    if before is None or after is None:
        return _MISSING
    low, high = (before + steps * rise for rise in _RISE)
    return max(0.0, math.log(after / high)) + min(0.0, math.log(after / low))
