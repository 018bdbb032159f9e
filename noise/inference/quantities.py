"""The conditions that are inferred, each on the scale that it is inferred on.

Speed and support stiffness count by their logarithm, interference as it is. The bolted clamp is
infinitely stiff, so it stands at the upper end of its scale as a place of its own: an interval that
reaches it reads "from 5000 Nm/rad up to the bolted clamp".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED
from noise.training.inference.population import INTERFERENCE_RANGE, SPEED_RANGE, SUPPORT_RANGE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.condition import Condition

__all__ = ["FIXED_PLACE", "QUANTITIES", "places", "value_at"]

QUANTITIES = ("speed", "interference", "support_stiffness")
"""Fields of `models.condition.Condition`, in the order of all arrays."""

FIXED_PLACE = 10.0
"""Of the bolted clamp among logarithms that end at 9.2."""


@dataclass(frozen=True)
class _Scale:
    low: float
    high: float
    logarithmic: bool


_SCALES = {
    "speed": _Scale(*SPEED_RANGE, True),
    "interference": _Scale(*INTERFERENCE_RANGE, False),
    "support_stiffness": _Scale(*SUPPORT_RANGE, True),
}


def places(condition: Condition) -> NDArray[np.float64]:
    """Where a condition stands on the three scales; NaN where it is not known.

    Examples
    --------
    >>> from models.condition import Condition
    >>> places(Condition(speed=-1.0, interference=0.279e-3, support_stiffness=FIXED)).tolist()
    [0.0, 0.279, 10.0]
    """
    speed, interference, support = (getattr(condition, name) for name in QUANTITIES)
    return np.array(
        [
            math.log(abs(speed)) if speed else math.nan,
            math.nan if interference is None else 1e3 * interference,
            math.nan if not support else min(math.log(support), FIXED_PLACE),
        ]
    )


def value_at(name: str, place: float) -> float:
    """Return the value at a place on a quantity's scale, in SI units; within its stated range.

    Examples
    --------
    >>> value_at("interference", 0.279), value_at("support_stiffness", FIXED_PLACE)
    (0.000279, inf)
    """
    scale = _SCALES[name]
    if name == "support_stiffness" and place >= FIXED_PLACE:
        return FIXED
    value = math.exp(place) if scale.logarithmic else 1e-3 * place
    return min(max(value, scale.low), scale.high)
