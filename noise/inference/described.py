"""What the inference looks at: a segment's features, and the conditions that are logged.

Slips follow the shaft's turning, so with the speed logged their number in a radian tells of torque
and stiffness alone; it is a feature of its own because trees are poor at division.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["KINDS", "described", "n_described", "of_subset", "subset_of"]

KINDS = ("pressure", "acceleration", "torque")
"""Kinds of channel that tell of a condition; their subsets are numbered as bits in this order."""

_RATES = (
    "pressure_fundamental",
    "pressure_pulse_rate",
    "acceleration_fundamental",
    "acceleration_pulse_rate",
    "torque_fundamental",
    "torque_slip_rate",
)
"""Features that are numbers of slips in a second."""


def described(
    table: NDArray[np.float64], names: Sequence[str], known: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Join features and logged conditions.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
        Features of segments.
    names : sequence of str
        Of its columns, as `features.recording_feature_names` has them.
    known : ndarray, shape (n, 3)
        Places of `noise.inference.quantities.QUANTITIES`, NaN where not logged.

    Returns
    -------
    ndarray, shape (n, n_described)

    Examples
    --------
    >>> known = np.array([[0.7, 0.279, np.nan]])
    >>> described(np.array([[50.0]]), ["torque_slip_rate"], known).round(2)
    array([[50.  ,  0.7 ,  0.28,   nan, 24.83]])
    """
    rates = [names.index(name) for name in _RATES if name in names]
    return np.concatenate([table, known, table[:, rates] * np.exp(-known[:, :1])], axis=1)


def n_described(names: Sequence[str]) -> int:
    """Return the number of columns of `described`.

    Examples
    --------
    >>> n_described(["torque_slip_rate"])
    5
    """
    return len(names) + 3 + sum(name in names for name in _RATES)


def of_subset(
    table: NDArray[np.float64], names: Sequence[str], subset: int | NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return features without those of channels that are not in a subset, which become NaN.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
    names : sequence of str
    subset : int or ndarray of int, shape (n,)
        One for all samples, or one for each.

    Examples
    --------
    >>> of_subset(np.ones((1, 2)), ["pressure_crest", "torque_mean"], subset_of(["torque"]))
    array([[nan,  1.]])
    """
    bits = np.array([KINDS.index(name.partition("_")[0]) for name in names])
    kept = np.atleast_1d(subset)[:, None] >> bits & 1
    return np.where(kept.astype(bool), table, np.nan)


def subset_of(kinds: Sequence[str]) -> int:
    """Return the number of a subset of `KINDS`.

    Examples
    --------
    >>> subset_of(["pressure", "angle"]), subset_of(KINDS)
    (1, 7)
    """
    return sum(1 << bit for bit, kind in enumerate(KINDS) if kind in kinds)
