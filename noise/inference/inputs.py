"""Inputs of the inference: scaled conditions and features of segments.

Speed and support stiffness are scaled by their logarithm, the interference is not. The bolted clamp
has infinite stiffness, so it is a separate point at the upper end of the scale: an interval that
reaches it reads "from 5000 Nm/rad up to the bolted clamp".

With a logged speed, the number of slips per radian depends on torque and stiffness alone. It is a
feature of its own because trees approximate quotients poorly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED, Condition

MATERIAL = "fluorocarbon"
"""Material of the bushings for which the intervals hold."""

SPEED_RANGE = (0.1, 15.0)
"""Range of the speed of the shaft [rad/s]; includes that of the thesis; assumed."""

INTERFERENCE_RANGE = (0.15e-3, 0.42e-3)
"""Range of the interference [m]; includes the 0.178 to 0.381 mm of the thesis; assumed."""

SUPPORT_RANGE = (1e3, 1e4)
"""Range of the support stiffness [Nm/rad]; includes the 2214 and 3745 of the thesis; assumed."""

SHORTEST, LONGEST = 0.25, 1.0
"""Minimum and maximum duration of a described stretch [s]; assumed."""

RATES = (16_000, 22_050, 30_000, 44_100, 48_000)
"""Sampling rates of recordings in training [Hz]."""

QUANTITIES = ("speed", "interference", "support_stiffness")
"""Fields of `models.condition.Condition`, in the order of all arrays."""

KINDS = ("pressure", "acceleration", "torque")
"""Kinds of channel with features, in the order of the bits that number their subsets."""

_SLIPS_A_SECOND = (
    "pressure_fundamental",
    "pressure_pulse_rate",
    "acceleration_fundamental",
    "acceleration_pulse_rate",
    "torque_fundamental",
    "torque_slip_rate",
)
"""Features that are slip rates [Hz]."""

_FIXED = 10.0
"""Scaled support stiffness of the bolted clamp; others end at 9.2 [-]; assumed."""


_RANGES = {
    "speed": SPEED_RANGE, "interference": INTERFERENCE_RANGE, "support_stiffness": SUPPORT_RANGE,
}  # fmt: skip


def scaled(condition: Condition) -> NDArray[np.float64]:
    """Return a condition on the scales of `QUANTITIES`.

    Parameters
    ----------
    condition : Condition

    Returns
    -------
    ndarray, shape (3,)
        Logarithm of the speed in rad/s [-], interference [mm], logarithm of the support stiffness
        in Nm/rad [-]; NaN if unknown.

    Examples
    --------
    >>> from models.condition import Condition
    >>> scaled(Condition(speed=-1.0, interference=0.279e-3, support_stiffness=FIXED)).tolist()
    [0.0, 0.279, 10.0]
    """
    speed, interference, support = (getattr(condition, name) for name in QUANTITIES)
    return np.array(
        [
            math.log(abs(speed)) if speed else math.nan,
            math.nan if interference is None else 1e3 * interference,
            math.nan if not support else min(math.log(support), _FIXED),
        ]
    )


def unscaled(name: str, point: float) -> float:
    """Return the value of a scaled quantity, limited to its range.

    Parameters
    ----------
    name : str
        One of `QUANTITIES`.
    point : float
        Scaled value, as from `scaled` [-] or [mm].

    Returns
    -------
    float
        [rad/s], [m] or [Nm/rad]

    Examples
    --------
    >>> unscaled("interference", 0.279), unscaled("support_stiffness", 10.0)
    (0.000279, inf)
    """
    low, high = _RANGES[name]
    if name == "support_stiffness" and point >= _FIXED:
        return FIXED
    value = 1e-3 * point if name == "interference" else math.exp(point)
    return min(max(value, low), high)


def segment_features(
    table: NDArray[np.float64], names: Sequence[str], known: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return features of segments joined with logged conditions and slips per radian.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
        Features of segments [unit of each feature].
    names : sequence of str
        Names of the columns, as from `features.table.recording_feature_names`.
    known : ndarray, shape (n, 3)
        Conditions as from `scaled` [-, mm, -], NaN if not logged.

    Returns
    -------
    ndarray, shape (n, n_segment_features)
        [unit of each feature]

    Examples
    --------
    >>> known = np.array([[0.7, 0.279, np.nan]])
    >>> segment_features(np.array([[50.0]]), ["torque_slip_rate"], known).round(2)
    array([[50.  ,  0.7 ,  0.28,   nan, 24.83]])
    """
    rates = [names.index(name) for name in _SLIPS_A_SECOND if name in names]
    return np.concatenate([table, known, table[:, rates] * np.exp(-known[:, :1])], axis=1)


def n_segment_features(names: Sequence[str]) -> int:
    """Return the number of columns of `segment_features`.

    Examples
    --------
    >>> n_segment_features(["torque_slip_rate"])
    5
    """
    return len(names) + 3 + sum(name in names for name in _SLIPS_A_SECOND)


def of_channels(
    table: NDArray[np.float64], names: Sequence[str], subset: int | NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return features in which those of channels outside a subset are NaN.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
        [unit of each feature]
    names : sequence of str
    subset : int or ndarray of int, shape (n,)
        Number from `subset_of`, one for all samples or one for each.

    Returns
    -------
    ndarray, shape (n, n_names)
        [unit of each feature]

    Examples
    --------
    >>> of_channels(np.ones((1, 2)), ["pressure_crest", "torque_mean"], subset_of(["torque"]))
    array([[nan,  1.]])
    """
    bits = np.array([KINDS.index(name.partition("_")[0]) for name in names])
    retained = np.atleast_1d(subset)[:, None] >> bits & 1
    return np.where(retained.astype(bool), table, np.nan)


def subset_of(kinds: Sequence[str]) -> int:
    """Return the number of a subset of `KINDS`.

    Examples
    --------
    >>> subset_of(["pressure", "angle"]), subset_of(KINDS)
    (1, 7)
    """
    return sum(1 << bit for bit, kind in enumerate(KINDS) if kind in kinds)


def others_of(known: NDArray[np.float64], index: int) -> int:
    """Return the number, 0 to 3, of the set of other quantities that are logged.

    Parameters
    ----------
    known : ndarray, shape (3,)
        Condition as from `scaled` [-, mm, -].
    index : int
        Index of the inferred quantity.

    Examples
    --------
    >>> others_of(np.array([np.nan, 0.279, np.nan]), 0)
    1
    """
    others = np.delete(known, index)
    return sum(1 << bit for bit, point in enumerate(others) if not np.isnan(point))
