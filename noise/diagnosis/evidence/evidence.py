"""A case as one row of numbers, from which the posterior is computed.

Each number of a recording becomes its difference from the rig file's simulation, in units of the
scatter that repeats have (`scale`, from cases without a cause). Over the recordings of a case six
things count: how large the difference is in the middle, how sure it is, how it spreads, where it
is largest, whether it grows with speed, and how much repeats of one condition differ.
"""

from __future__ import annotations

import itertools
import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.diagnosis.evidence.summary import CaseTable

__all__ = [
    "LARGEST", "MISSING", "PARTS", "aligned", "deviations", "evidence", "evidence_names",
    "scale_of", "standard_errors",
]  # fmt: skip

PARTS = ("middle", "sure", "spread", "largest", "with_speed", "repeats", "as_is")
"""Of each number's differences over the recordings of a case, in the order of the row."""

MISSING = -999.0
"""Stands for what a case does not show; a tree splits it off."""

LARGEST = 1e4
"""Larger numbers are all alike."""

_LEAST_SCALE = 1e-3
_LEAST_SHARE = 1e-2
"""A number that hardly scatters has at least this share of its size as its scale."""


def evidence_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names of the columns of `evidence`.

    Parameters
    ----------
    names : sequence of str
        Of the numbers that count.

    Returns
    -------
    tuple of str
        Part and number, part by part; then how many recordings there are and their rate.

    Examples
    --------
    >>> evidence_names(["torque_offset"])[0]
    'middle:torque_offset'
    """
    return (*(f"{part}:{name}" for part in PARTS for name in names), "recordings", "rate")


def aligned(table: CaseTable, names: Sequence[str]) -> tuple[NDArray[np.float64], ...]:
    """Numbers of a case in the order of names.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str

    Returns
    -------
    measured, nominal, scatter : ndarray, shape (n_recordings, n_names)
        NaN where the case has none of that name [unit of the
        number].

    Examples
    --------
    >>> from noise.diagnosis.evidence.summary import CaseTable
    >>> one = np.ones((1, 1))
    >>> table = CaseTable(("a",), one, one, one, (), 30e3)
    >>> aligned(table, ["b", "a"])[0].tolist()
    [[nan, 1.0]]
    """
    place = {name: i for i, name in enumerate(table.names)}
    found = [place.get(name, -1) for name in names]
    known = np.array(found) >= 0
    columns = np.array(found)[known]

    def chosen(rows: NDArray[np.float64]) -> NDArray[np.float64]:
        filled = np.full((len(rows), len(found)), np.nan)
        filled[:, known] = rows[:, columns]
        return filled

    return chosen(table.measured), chosen(table.nominal), chosen(table.scatter)


def scale_of(tables: Sequence[CaseTable], names: Sequence[str]) -> NDArray[np.float64]:
    """Scatter of each number about its nominal value.

    Parameters
    ----------
    tables : sequence of CaseTable
        Cases without a cause.
    names : sequence of str

    Returns
    -------
    ndarray, shape (n_names,)
        Half of what lies between the 16th and the 84th percentile [unit of the number].
    """
    away, levels = [], []
    for table in tables:
        measured, nominal, _ = aligned(table, names)
        away.append(measured - nominal)
        levels.append(measured)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that no case has
        low, high = np.nanpercentile(np.concatenate(away), [16.0, 84.0], axis=0)
        typical = np.nanmedian(np.abs(np.concatenate(levels)), axis=0)
    least = _LEAST_SHARE * np.nan_to_num(typical, nan=1.0) + _LEAST_SCALE
    return np.asarray(np.maximum(np.nan_to_num(0.5 * (high - low), nan=1.0), least))


def evidence(
    table: CaseTable, names: Sequence[str], scale: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Return a case as one row.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str
        Of the numbers that count.
    scale : ndarray, shape (n_names,)
        As `scale_of` gives it.

    Returns
    -------
    ndarray of float32, shape (n_columns,)
        By `evidence_names`; `MISSING` where undefined; differences over scatter [-].
    """
    measured, nominal, _ = aligned(table, names)
    away = measured - nominal
    z = deviations(table, names, scale)
    speed = np.array([c.speed for c in table.conditions], dtype=np.float64)
    fast, slow = speed >= np.median(speed), speed <= np.median(speed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that no recording has
        size = np.where(np.isfinite(z), np.abs(z), -1.0)
        largest = np.take_along_axis(z, size.argmax(axis=0)[None], axis=0)[0]
        parts = [
            np.nanmedian(away, axis=0),
            standard_errors(z),
            np.nanstd(z, axis=0),
            largest,
            np.nanmean(z[fast], axis=0) - np.nanmean(z[slow], axis=0),
            _between_repeats(table, measured) / scale,
            np.nanmedian(measured, axis=0),
        ]
    row = np.concatenate([*parts, [len(measured), table.rate]])
    row = np.nan_to_num(row, nan=MISSING, posinf=LARGEST, neginf=-LARGEST)
    return np.asarray(np.clip(row, -LARGEST, LARGEST * 100.0), dtype=np.float32)


def deviations(
    table: CaseTable, names: Sequence[str], scale: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Differences of a case from its nominal numbers, over the scatter of repeats.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str
        Of the numbers that count.
    scale : ndarray, shape (n_names,)
        As `scale_of` gives it.

    Returns
    -------
    ndarray, shape (n_recordings, n_names)
        In standard deviations [-]; NaN where a number is unknown.
    """
    measured, nominal, scatter = aligned(table, names)
    return np.asarray(
        (measured - nominal) / np.sqrt(np.nan_to_num(scatter, nan=0.0) ** 2 + scale**2)
    )


def standard_errors(deviation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over recordings, in units of its standard error.

    Parameters
    ----------
    deviation : ndarray, shape (n_recordings, n_names)
        In standard deviations [-].

    Returns
    -------
    ndarray, shape (n_names,)
        [-], 0 where nothing is known.

    Examples
    --------
    >>> standard_errors(np.array([[1.0, np.nan], [1.0, np.nan], [1.0, np.nan], [1.0, np.nan]]))
    array([2., 0.])
    """
    count = np.isfinite(deviation).sum(axis=0)
    return np.asarray(np.nansum(deviation, axis=0) / np.sqrt(np.maximum(count, 1)))


def _between_repeats(table: CaseTable, measured: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root mean square difference of recordings of one condition."""
    groups: dict[tuple[float | None, ...], list[int]] = {}
    for i, c in enumerate(table.conditions):
        groups.setdefault((c.speed, c.interference, c.support_stiffness), []).append(i)
    differences = [
        measured[i] - measured[j]
        for group in groups.values()
        for i, j in itertools.combinations(group, 2)
    ]
    if not differences:
        return np.full(measured.shape[1], np.nan)
    return np.asarray(np.sqrt(np.nanmean(np.square(differences), axis=0)))
