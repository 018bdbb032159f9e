"""Training of the inference of conditions, on simulation alone.

Three independent sets of runs grow the forests, calibrate the intervals and test them. The features
of the channels of a run do not depend on one another, so one run represents all subsets of its
channels and logged conditions; the forests learn random subsets, and the intervals are calibrated
for each subset.

Calibration is conformal: for each set of channels, calibration and other logged conditions, 5 % of
the recordings of the second set lie below the interval and 5 % above it, and counting one more
gives a coverage of at least 90 % (V. Vovk, A. Gammerman, G. Shafer, *Algorithmic Learning in a
Random World*, 2005). Whether an interval is reported is decided first, by separate counts, so that
the final counts hold for recordings with an interval.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from features.table import recording_feature_names
from noise.inference.inputs import KINDS, QUANTITIES, of_channels, segment_features
from noise.inference.model import Inference
from noise.training.inference.population import RunSample, draw_run_sample
from noise.training.trees import PER_LEAF, grow_quantile_forest

_LEAST = 50
"""Minimum number of recordings for the calibration of an interval."""

_BEYOND = 0.05
"""Share of the recordings beyond each end of the interval [-]."""


@dataclass(frozen=True, eq=False)
class Runs:
    """Features and conditions of runs as arrays.

    Parameters
    ----------
    tables : ndarray, shape (2, n_runs, n_names)
        Features in the field, and on the rig [unit of each feature].
    scaled : ndarray, shape (n_runs, 3)
        Conditions as from `noise.inference.inputs.scaled` [-, mm, -].
    """

    tables: NDArray[np.float64]
    scaled: NDArray[np.float64]

    def __getitem__(self, part: slice) -> Runs:
        return Runs(self.tables[:, part], self.scaled[part])


def calibrate_intervals(model: Inference, runs: Runs) -> Inference:
    """Return a model with calibrated intervals, using the channels with the narrowest intervals.

    Parameters
    ----------
    model : Inference
        Model with trained forests.
    runs : Runs
        Runs that were not used to grow the forests.

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
        counts = _counts_outside(model, index, values, rounded(runs.scaled[:, index]))
        if counts is not None:
            used[at], outside[at] = subset, counts
            widths[at] = _mean_width(model, index, values, counts)
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
    """Return the mean width of the intervals, with that of the population for those missing."""
    low, high = np.quantile(model.prior[index], [0.05, 0.95])
    width = values[:, -1 - outside[3]] - values[:, outside[2]]
    return float(np.mean(np.where(model.is_narrow(index, values, outside), width, high - low)))


def _beyond(values: NDArray[np.float32], y: NDArray[np.float32]) -> tuple[int, int] | None:
    """Return the numbers of lowest and highest values outside of the interval, for 5 % each."""
    n = len(y)
    if n < _LEAST:
        return None
    beyond = int(_BEYOND * (n + 1)) - 1  # conformal: one more counts as beyond
    # With i values left out below, recordings with at most i values at or below them are beyond.
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


def rounded(y: NDArray[np.float64]) -> NDArray[np.float32]:
    """Round to the precision of the values of the leaves.

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
    """Return the name of a case in the card."""
    left = [name for name in QUANTITIES if name != QUANTITIES[index]]
    logged = "+".join(name for bit, name in enumerate(left) if others >> bit & 1) or "none"
    kinds = "+".join(kind for bit, kind in enumerate(KINDS) if subset >> bit & 1)
    return f"{QUANTITIES[index]}/{('field', 'rig')[calibrated]}/{kinds}/{logged}"


def _cases() -> Iterator[tuple[int, int, int, int]]:
    """Yield quantity, calibration, subset of channels, and set of other logged conditions."""
    return itertools.product(range(len(QUANTITIES)), (0, 1), range(1, 1 << len(KINDS)), range(4))


N_TRAINING = 1800
"""Number of runs to grow the forests."""

N_CALIBRATION = 1600
"""Number of runs to calibrate the intervals."""

N_TEST = 200
"""Number of runs to test the intervals."""

N_TREES = 50
LEAST_LEAF = 5

_TIMES = 4
"""Random subsets of channels and logged conditions per recording."""

_SHARE = 0.4
"""Share of the samples per tree."""

_PRESSURE_ALONE = 0.35
"""Share of subsets with the sound alone; others are any subset of the channels."""


def train_inference(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    n_calibration: int = N_CALIBRATION,
    n_test: int = N_TEST,
    progress: Callable[[Iterable[RunSample], int], Iterable[RunSample]] | None = None,
) -> Inference:
    """Train the inference of conditions; the same seed gives the same model.

    Parameters
    ----------
    seed : int
    n_training, n_calibration, n_test : int
        Numbers of runs to train, to calibrate and to test.
    progress : callable, optional
        ``progress(samples, total)`` yields the samples and shows the progress.

    Returns
    -------
    Inference
        Its card has the coverage of the intervals on the test runs.

    Examples
    --------
    It takes minutes:

    >>> train_inference(seed=1).save("conditions.npz")  # doctest: +SKIP
    """
    total = n_training + n_calibration + n_test
    children = np.random.SeedSequence(seed).spawn(total)
    drawn: Iterable[RunSample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_run_sample)(child) for child in children
    )
    samples = list(progress(drawn, total) if progress else drawn)
    names = tuple(
        name
        for name in recording_feature_names()
        if any(np.isfinite(sample.features[1][name]) for sample in samples[:n_training])
    )
    runs = _as_arrays(samples, names)
    grown = _grown(runs[:n_training], names, seed)
    calibrated = calibrate_intervals(grown, runs[n_training : n_training + n_calibration])
    tested = coverage(calibrated, samples[n_training + n_calibration :])
    card = {
        "seed": seed,
        "samples": dict(Counter(sample.label for sample in samples[:n_training])),
        "test": tested,
    }
    return replace(calibrated, card=card)


def coverage(model: Inference, samples: Iterable[RunSample]) -> dict[str, dict[str, float | int]]:
    """Return the coverage of the intervals, and how often there is one.

    Parameters
    ----------
    model : Inference
    samples : iterable of RunSample
        Samples that were not used in training.

    Returns
    -------
    dict of str to dict
        By quantity, recording, channels and what is logged, such as ``speed/rig/pressure/none``:
        number ``n`` of samples, share ``told`` with an interval, and share ``covered`` of these.
    """
    runs = _as_arrays(list(samples), model.names)
    counts: dict[str, dict[str, float | int]] = {}
    for index, calibrated, subset, others in _cases():
        at = (index, subset, calibrated, others)
        outside, y = model.outside[at], rounded(runs.scaled[:, index])
        values = _distribution(model, runs, index, calibrated, int(model.used[at]), others)
        if outside[0] < 0:
            narrow = np.zeros(len(values), dtype=bool)
        else:
            narrow = model.is_narrow(index, values, outside)
        held = (values[:, outside[2]] <= y) & (y <= values[:, -1 - outside[3]])
        counts[_case_name(index, calibrated, subset, others)] = {
            "n": len(y),
            "told": round(float(np.mean(narrow)), 4),
            "covered": round(float(np.mean(held[narrow])), 4) if narrow.any() else 0.0,
        }
    return counts


def _as_arrays(samples: list[RunSample], names: tuple[str, ...]) -> Runs:
    tables = [
        [[sample.features[calibrated][name] for name in names] for sample in samples]
        for calibrated in (0, 1)
    ]
    return Runs(np.array(tables), np.array([sample.scaled for sample in samples]))


def _grown(runs: Runs, names: tuple[str, ...], seed: int) -> Inference:
    rng = np.random.default_rng([seed, 1])
    n = len(runs.scaled)
    forests = []
    for index in range(len(QUANTITIES)):
        rows = []
        for table in runs.tables:
            for _ in range(_TIMES):
                subsets = np.where(
                    rng.random(n) < _PRESSURE_ALONE, 1, rng.integers(1, 1 << len(KINDS), n)
                )
                known = np.where(rng.random((n, 3)) < 0.5, runs.scaled, np.nan)
                known[:, index] = np.nan
                partial = of_channels(table, names, subsets)
                rows.append(segment_features(partial, names, known))
        forests.append(
            grow_quantile_forest(
                np.concatenate(rows),
                np.tile(runs.scaled[:, index], len(rows)),
                n_trees=N_TREES,
                least_leaf=LEAST_LEAF,
                share=_SHARE,
                seed=seed,
            )
        )
    prior = rounded(np.quantile(runs.scaled, np.linspace(0.0, 1.0, PER_LEAF), axis=0).T)
    cases = (len(QUANTITIES), 1 << len(KINDS), 2, 4)
    used = np.zeros(cases, dtype=np.int16)
    outside = np.full((*cases, 4), -1, dtype=np.int16)
    return Inference(names, tuple(forests), prior, used, outside, {})
