"""Stated conditions against what torque and angle say themselves: speed, its sign, their order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

from noise.diagnosis.bench.levels import factor_words, unit_of

if TYPE_CHECKING:
    from models.rig import Rig
    from noise.diagnosis.bench.levels import Levels
    from noise.diagnosis.case import Case


_SPEED = 0.2
"""Difference of logarithms of the speed that is stated and that of the angle; a speed that is read
off a dial errs by 3 %, and a fluctuating one evens out [-]; assumed."""

_STILL = 0.05
"""Share of the stated speed below which an angle does not turn [-]; assumed."""

_ERRORS = {"speed": 0.05, "torque": 0.2}
"""Differences of logarithms between a recording and its condition that count as one [-];
assumed."""

_SHUFFLED = 3.0
"""Mean of such differences from which conditions do not belong to their recordings [-];
assumed."""

_SORTED = 1.0
"""Mean of such differences below which another order fits [-]; assumed."""


def wrong_speed(levels: Sequence[Levels]) -> str:
    """Say whether the angle turns otherwise than stated; empty if it does not."""
    ratios = np.array([one.turned / one.speed for one in levels if one.turned is not None])
    if not ratios.size:
        return ""
    stated = float(np.median([abs(one.speed) for one in levels if one.turned is not None]))
    if words := speed_words(float(np.median(ratios)), stated):
        return words
    far = int(np.count_nonzero(np.abs(np.log(np.abs(ratios) + 1e-12)) > 2.0 * _SPEED))
    if not far:
        return ""
    return f"the angle turns at another speed than stated in {far} of {ratios.size} recordings"


def speed_words(ratio: float, stated: float) -> str:
    """Say what is wrong with a speed, by that of the angle; empty if nothing is.

    Parameters
    ----------
    ratio : float
        Speed of the angle over the one that is stated [-].
    stated : float
        [rad/s]

    Examples
    --------
    >>> speed_words(57.3, 2.0), speed_words(1.03, 2.0)
    ('channel angle looks like degrees, not rad (factor 57)', '')
    """
    if not ratio:
        return "channel angle does not turn"
    if abs(np.log(abs(ratio))) < _SPEED:
        turned = "channel angle turns against the stated speed: the sign of either is wrong"
        return turned if ratio < 0.0 else ""
    if unit := unit_of("angle", ratio):
        return f"channel angle looks like {unit}, not rad (factor {max(ratio, 1 / ratio):.2g})"
    if unit := unit_of("speed", 1.0 / ratio):
        return f"the stated speed looks like {unit}, not rad/s (factor {max(ratio, 1 / ratio):.2g})"
    turns = f"{ratio * stated:.2g} rad/s where {stated:.2g} rad/s is stated"
    if ratio < _STILL:
        return f"channel angle does not turn as stated: {turns}"
    return f"the stated speed is {factor_words(1.0 / ratio)}: the angle turns at {turns}"


def shuffled_conditions(case: Case, levels: Sequence[Levels]) -> str:
    """Say whether the conditions are those of each other's recordings; empty if they are not."""
    seen: list[tuple[float, float]] = []
    stated: list[tuple[float, float]] = []
    for one, recording in zip(levels, case.recordings, strict=True):
        if one.turned is None or one.torque is None or not one.turned or not one.torque:
            return ""
        kinetic = _kinetic(case.rig, recording.condition.interference)
        stated.append((np.log(abs(one.speed)), np.log(kinetic)))
        seen.append((np.log(abs(one.turned)), np.log(abs(one.torque) * kinetic)))
    x, y = np.array(seen), np.array(stated)
    x = x - np.median(x - y, axis=0)  # a wrong unit or gain is no wrong order
    size = np.array(list(_ERRORS.values()))
    cost = (np.minimum(np.abs(x[:, None, :] - y[None, :, :]) / size, 20.0)).sum(axis=2)
    rows, columns = linear_sum_assignment(cost)
    before, after = float(np.trace(cost)) / len(x), float(cost[rows, columns].mean())
    if before < _SHUFFLED or after > _SORTED:
        return ""
    moved = [case.names[i] for i, j in zip(rows, columns, strict=True) if cost[i, i] > cost[i, j]]
    return (
        f"conditions look shuffled among the recordings: speed and torque of {', '.join(moved)} "
        "are those stated of others"
    )


def _kinetic(rig: Rig, interference: float | None) -> float:
    assert interference is not None  # `usable` made it so
    return rig.fit(interference).kinetic_torque
