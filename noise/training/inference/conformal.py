"""Conformal calibration of the intervals, and how often they then hold.

For each set of channels, of calibration and of other conditions that are logged, 5 % of the
recordings that no tree has seen are to lie below the interval and 5 % above it; counting one more
than those that do makes it 90 % or more of the next ones (V. Vovk, A. Gammerman, G. Shafer,
*Algorithmic Learning in a Random World*, 2005). Whether there is an interval at all is decided
first, by other counts, so that it is those with one that the final counts hold for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.inference.inputs import KINDS, QUANTITIES, of_channels, segment_features
from noise.inference.model import Inference

_LEAST = 50
"""With fewer recordings than this no interval can be calibrated."""

_BEYOND = 0.05
"""Share of the recordings that lies beyond each end [-]."""


@dataclass(frozen=True, eq=False)
class Runs:
    """Samples as arrays.

    Parameters
    ----------
    tables : ndarray, shape (2, n_runs, n_names)
        Features in the field, and on the rig [unit of each feature].
    scaled : ndarray, shape (n_runs, 3)
        Conditions as `noise.inference.inputs.scaled` gives them.
    """

    tables: NDArray[np.float64]
    scaled: NDArray[np.float64]

    def __getitem__(self, part: slice) -> Runs:
        return Runs(self.tables[:, part], self.scaled[part])


def calibrate_intervals(model: Inference, runs: Runs) -> Inference:
    """Calibrate the intervals of all cases, by those channels that give the narrowest.

    Parameters
    ----------
    model : Inference
        Whose forests are grown.
    runs : Runs
        None of those that they were grown on.

    Returns
    -------
    Inference
    """
    used, outside = model.used.copy(), model.outside.copy()
    widths = np.full(used.shape, np.inf)
    for case in _cases():
        index, calibrated, subset, others = case
        at = (index, subset, calibrated, others)
        values = _distribution(model, runs, *case)
        found = _counts_outside(model, index, values, rounded(runs.scaled[:, index]))
        if found is not None:
            used[at], outside[at] = subset, found
            widths[at] = _mean_width(model, index, values, found)
    for index, calibrated, subset, others in _cases():
        at = (index, subset, calibrated, others)
        parts = [part for part in range(1, subset + 1) if part & subset == part]
        best = min(parts, key=lambda part: widths[index, part, calibrated, others])
        source = (index, best, calibrated, others)
        if used[source] == best:
            used[at], outside[at] = best, outside[source]
    return replace(model, used=used, outside=outside)


def _counts_outside(
    model: Inference, index: int, values: NDArray[np.float32], y: NDArray[np.float32]
) -> NDArray[np.int16] | None:
    first = _beyond(values, y)
    if first is None:
        return None
    narrow = model.is_narrow(index, values, np.array([*first, 0, 0], dtype=np.int16))
    second = _beyond(values[narrow], y[narrow])
    return None if second is None else np.array([*first, *second], dtype=np.int16)


def _mean_width(
    model: Inference, index: int, values: NDArray[np.float32], outside: NDArray[np.int16]
) -> float:
    """Mean width of the intervals; where there is none it is that of the population."""
    low, high = np.quantile(model.prior[index], [0.05, 0.95])
    width = values[:, -1 - outside[3]] - values[:, outside[2]]
    return float(np.mean(np.where(model.is_narrow(index, values, outside), width, high - low)))


def _beyond(values: NDArray[np.float32], y: NDArray[np.float32]) -> tuple[int, int] | None:
    """How many of the lowest and of the highest values to leave out, for 5 % beyond each."""
    n = len(y)
    if n < _LEAST:
        return None
    beyond = int(_BEYOND * (n + 1)) - 1  # one more being counted as such
    # With i values left out below, those are beyond that have no more than i at or below them.
    at_or_below = np.sort((values <= y[:, None]).sum(axis=1))
    at_or_above = np.sort((values >= y[:, None]).sum(axis=1))
    low, high = (max(0, int(counts[beyond]) - 1) for counts in (at_or_below, at_or_above))
    half = (values.shape[1] - 1) // 2
    return min(low, half), min(high, half)


def _distribution(
    model: Inference, runs: Runs, index: int, calibrated: int, subset: int, others: int
) -> NDArray[np.float32]:
    known = np.full_like(runs.scaled, np.nan)
    left = [column for column in range(len(QUANTITIES)) if column != index]
    for bit, column in enumerate(left):
        if others >> bit & 1:
            known[:, column] = runs.scaled[:, column]
    table = of_channels(runs.tables[calibrated], model.names, subset)
    return model.distribution(index, segment_features(table, model.names, known))


def _intervals(
    model: Inference, runs: Runs, index: int, calibrated: int, subset: int, others: int
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
    """Return the ends of the intervals on the quantity's scale, and where there is one."""
    at = (index, subset, calibrated, others)
    outside = model.outside[at]
    values = _distribution(model, runs, index, calibrated, int(model.used[at]), others)
    if outside[0] < 0:
        nothing = np.zeros(len(values), dtype=bool)
        return values[:, 0], values[:, -1], nothing
    narrow = model.is_narrow(index, values, outside)
    return values[:, outside[2]], values[:, -1 - outside[3]], narrow


def interval_coverage(model: Inference, runs: Runs) -> dict[str, dict[str, float | int]]:
    """Count how often intervals hold, as `noise.training.inference.fit.coverage` describes it."""
    found: dict[str, dict[str, float | int]] = {}
    for index, calibrated, subset, others in _cases():
        low, high, narrow = _intervals(model, runs, index, calibrated, subset, others)
        y = rounded(runs.scaled[:, index])
        held = (low <= y) & (y <= high)
        found[_case_name(index, calibrated, subset, others)] = {
            "n": len(y),
            "told": round(float(np.mean(narrow)), 4),
            "covered": round(float(np.mean(held[narrow])), 4) if narrow.any() else 0.0,
        }
    return found


def rounded(y: NDArray[np.float64]) -> NDArray[np.float32]:
    """Round as the leaves' values are, so that what is equal stays equal.

    Parameters
    ----------
    y : ndarray, shape (n,)
        [any unit]

    Returns
    -------
    ndarray of float32, shape (n,)
        [unit of `y`]

    Examples
    --------
    >>> rounded(np.array([0.279])).tolist()
    [0.279052734375]
    """
    return np.asarray(y, dtype=np.float16).astype(np.float32)


def _case_name(index: int, calibrated: int, subset: int, others: int) -> str:
    """Return what a case is called in the card."""
    left = [name for name in QUANTITIES if name != QUANTITIES[index]]
    logged = "+".join(name for bit, name in enumerate(left) if others >> bit & 1) or "none"
    kinds = "+".join(kind for bit, kind in enumerate(KINDS) if subset >> bit & 1)
    return f"{QUANTITIES[index]}/{('field', 'rig')[calibrated]}/{kinds}/{logged}"


def _cases() -> Iterator[tuple[int, int, int, int]]:
    for index in range(len(QUANTITIES)):
        for calibrated in (0, 1):
            for subset in range(1, 1 << len(KINDS)):
                for others in range(4):
                    yield index, calibrated, subset, others
