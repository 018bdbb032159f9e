"""Training of the inference of conditions, on simulation alone.

Three sets of runs that share no draw: one grows the forests, one calibrates the intervals, and one
is counted for the card. The features of a run's channels do not depend on
one another, so one run stands for all subsets of its channels and of what is logged; the forests
see some of them, drawn at random, and the intervals are calibrated for each.

Conformal calibration of the intervals, and how often they then hold.

For each set of channels, of calibration and of other conditions that are logged, 5 % of the
recordings that no tree has seen are to lie below the interval and 5 % above it; counting one more
than those that do makes it 90 % or more of the next ones (V. Vovk, A. Gammerman, G. Shafer,
*Algorithmic Learning in a Random World*, 2005). Whether there is an interval at all is decided
first, by other counts, so that it is those with one that the final counts hold for.
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
    """Yield quantity, calibrated or not, subset of channels, and others that are logged."""
    return itertools.product(range(len(QUANTITIES)), (0, 1), range(1, 1 << len(KINDS)), range(4))


N_TRAINING = 1800
"""Runs that grow the forests."""

N_CALIBRATION = 1600
"""Runs that calibrate the intervals."""

N_TEST = 200
"""Runs that are counted."""

N_TREES = 50
LEAST_LEAF = 5

_TIMES = 4
"""Subsets of channels and of logged conditions that a recording is learned with."""

_SHARE = 0.4
"""Of the samples that a tree is grown on."""

_PRESSURE_ALONE = 0.35
"""Share of those with the sound alone; the others keep any subset of the channels."""


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
        Runs to learn from, to calibrate on and to count.
    progress : callable, optional
        ``progress(samples, total)`` passes the samples on and shows how far it is.

    Returns
    -------
    Inference
        Its card tells how often the intervals held on the last of the three sets.

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
    """Count how often intervals hold, and how often there is one.

    Parameters
    ----------
    model : Inference
    samples : iterable of RunSample
        Not those that it was trained on.

    Returns
    -------
    dict of str to dict
        By quantity, recording, channels and what is logged, such as ``speed/rig/pressure/none``:
        ``n`` samples, share ``told`` of them with an interval, share ``covered`` of those told.
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
