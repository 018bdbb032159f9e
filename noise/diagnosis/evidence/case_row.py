"""Row of a case: its numbers' differences from the rig file's, over what they scatter by.

From the numbers of its recordings a case becomes one row, of which the posterior is computed. Each
number of a recording becomes its difference from the rig file's simulation, in units of what it
scatters by on this bench: what simulated repeats differ by (over all conditions of the case, since
a few of one say little), and what gains and hammer tests of quiet benches add to that (`scale`).
Over the recordings of a case these things count: how large the difference is in the middle, in its
own unit and in that, how sure it is, how it spreads, where it is largest, whether it grows with
speed, and how much repeats of one condition differ; beside them what was measured, and what bench
it was.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.diagnosis.evidence.bench_context import CONTEXT
from noise.diagnosis.evidence.summary import CaseTable

PARTS = ("middle", "sure", "spread", "largest", "with_speed", "repeats", "as_is")
"""Of each number's differences over the recordings of a case, in the order of the row."""

_COUNTS = ("recordings", "rate", "conditions")

MISSING = -999.0
"""Stands for what a case does not show; a tree splits it off."""

LARGEST = 1e4
"""Larger numbers are all alike; assumed."""

_LEAST_SCALE = 1e-3
_LEAST_SHARE = 1e-2
"""A number that hardly scatters has at least this share of its size as its scale; assumed, as is
the least scale of any number."""

_OWN = 1.0 / 3.0
"""How much the scatter at a recording's own condition counts, beside that at all conditions;
assumed."""


def evidence_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names of the columns of `evidence`.

    Parameters
    ----------
    names : sequence of str
        Of the numbers that count.

    Returns
    -------
    tuple of str
        Part and number, part by part; how many recordings and conditions there are, and their
        rate; the bench; and the typical size of each number's difference.

    Examples
    --------
    >>> evidence_names(["torque_offset"])[0]
    'middle:torque_offset'
    """
    parts = (f"{part}:{name}" for part in PARTS for name in names)
    return (*parts, *_COUNTS, *CONTEXT, *(f"typical:{name}" for name in names))


def aligned(table: CaseTable, names: Sequence[str]) -> tuple[Array, ...]:
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
    columns = _columns(table.names, tuple(names))
    known = columns >= 0

    def chosen(rows: Array) -> Array:
        filled = np.full((len(rows), columns.size), np.nan)
        filled[:, known] = rows[:, columns[known]]
        return filled

    return chosen(table.measured), chosen(table.nominal), chosen(table.scatter)


@lru_cache(maxsize=64)
def _columns(of_table: tuple[str, ...], names: tuple[str, ...]) -> NDArray[np.int64]:
    """Return where names stand in a table; -1 where it has none of that name."""
    place = {name: i for i, name in enumerate(of_table)}
    return np.array([place.get(name, -1) for name in names], dtype=np.int64)


def scale_of(tables: Sequence[CaseTable], names: Sequence[str]) -> Array:
    """Scatter of each number about its nominal value that simulated repeats do not have.

    Parameters
    ----------
    tables : sequence of CaseTable
        Cases without a cause, of quiet benches: what noise does on others, repeats have as well.
    names : sequence of str

    Returns
    -------
    ndarray, shape (n_names,)
        Half of what lies between the 16th and the 84th percentile, less what repeats differ by
        [unit of the number].
    """
    rows = [aligned(table, names) for table in tables]
    away = np.concatenate([measured - nominal for measured, nominal, _ in rows])
    levels = np.concatenate([measured for measured, _, _ in rows])
    repeats = np.concatenate([_pooled(scatter) for _, _, scatter in rows])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that no case has
        low, high = np.nanpercentile(away, [16.0, 84.0], axis=0)
        typical = np.nanmedian(np.abs(levels), axis=0)
        expected = np.nanmedian(repeats, axis=0)
    beyond = np.maximum((0.5 * (high - low)) ** 2 - np.nan_to_num(expected) ** 2, 0.0)
    least = _LEAST_SHARE * np.nan_to_num(typical, nan=1.0) + _LEAST_SCALE
    return np.asarray(np.maximum(np.nan_to_num(np.sqrt(beyond), nan=1.0), least))


def evidence(table: CaseTable, names: Sequence[str], scale: Array) -> NDArray[np.float32]:
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
        By `evidence_names`; `MISSING` where undefined; differences over scatter [-], but
        ``middle`` and ``as_is`` in the unit of the number.
    """
    measured, nominal, scatter = aligned(table, names)
    away = measured - nominal
    expected = np.sqrt(_pooled(scatter) ** 2 + scale**2)
    z = away / expected
    speed = np.abs(np.array([c.speed for c in table.conditions], dtype=np.float64))
    fast, slow = speed >= np.median(speed), speed <= np.median(speed)
    size = np.where(np.isfinite(z), np.abs(z), -1.0)
    largest = np.take_along_axis(z, size.argmax(axis=0)[None], axis=0)[0]
    groups = _conditions(table)
    with np.errstate(invalid="ignore", over="ignore"):  # numbers without bounds
        parts = [
            _middle(away),
            standard_errors(z),
            np.sqrt(_mean(np.square(z - _mean(z)))),
            largest,
            _mean(z[fast]) - _mean(z[slow]),
            _between_repeats(groups, measured / expected),
            _middle(measured),
        ]
        typical = _middle(z)
    bench = [table.bench.get(name, np.nan) for name in CONTEXT]
    counts = [len(measured), table.rate, len(groups)]
    row = np.concatenate([*parts, counts, bench, typical])
    row = np.nan_to_num(row, nan=MISSING, posinf=LARGEST, neginf=-LARGEST)
    return np.asarray(np.clip(row, -LARGEST, LARGEST * 100.0), dtype=np.float32)


def deviations(table: CaseTable, names: Sequence[str], scale: Array) -> Array:
    """Differences of a case from its nominal numbers, over what they scatter by.

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
    return np.asarray((measured - nominal) / np.sqrt(_pooled(scatter) ** 2 + scale**2))


def standard_errors(deviation: Array) -> Array:
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


def _pooled(scatter: Array) -> Array:
    """Scatter of repeats, drawn towards that over all recordings of a case; 0 where unknown."""
    square = np.square(scatter)
    everywhere = np.nan_to_num(_mean(square))
    own = np.where(np.isnan(square), everywhere, square)
    return np.asarray(np.sqrt(_OWN * own + (1.0 - _OWN) * everywhere))


def _mean(rows: Array) -> Array:
    """Mean of each column over what is known; NaN where nothing is."""
    known = ~np.isnan(rows)
    count = known.sum(axis=0)
    total = np.where(known, rows, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _middle(rows: Array) -> Array:
    """Median of each column over what is known; NaN where nothing is."""
    ordered = np.sort(rows, axis=0)  # what is unknown comes last
    count = (~np.isnan(rows)).sum(axis=0)
    low, high = np.maximum(count - 1, 0) // 2, count // 2
    high = np.minimum(high, len(rows) - 1)
    column = np.arange(rows.shape[1])
    return np.asarray(0.5 * (ordered[low, column] + ordered[high, column]))


def _conditions(table: CaseTable) -> list[list[int]]:
    """Return the recordings of each condition."""
    groups: dict[tuple[float | None, ...], list[int]] = {}
    for i, c in enumerate(table.conditions):
        groups.setdefault((c.speed, c.interference, c.support_stiffness), []).append(i)
    return list(groups.values())


def _between_repeats(groups: Sequence[Sequence[int]], values: Array) -> Array:
    """Root mean square difference of recordings of one condition."""
    pairs = [pair for group in groups for pair in itertools.combinations(group, 2)]
    if not pairs:
        return np.full(values.shape[1], np.nan)
    one, other = np.array(pairs).T
    return np.asarray(np.sqrt(_mean(np.square(values[one] - values[other]))))
