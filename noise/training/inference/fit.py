"""Training of the inference of conditions, on simulation alone.

Three sets of runs that share no draw: one grows the forests, one calibrates the intervals, and one
is counted for the card. The features of a run's channels do not depend on
one another, so one run stands for all subsets of its channels and of what is logged; the forests
see some of them, drawn at random, and the intervals are calibrated for each.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from features.table import recording_feature_names, recording_features
from noise.inference.inputs import KINDS, QUANTITIES, of_channels, scaled, segment_features
from noise.inference.model import Inference
from noise.training.inference.conformal import Runs, calibrate_intervals, interval_coverage, rounded
from noise.training.inference.population import draw_audible_run
from noise.training.trees import PER_LEAF, grow_quantile_forest

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


@dataclass(frozen=True, eq=False)
class RunSample:
    """Features of one audible run, and what made it.

    Parameters
    ----------
    label : str
    scaled : ndarray, shape (3,)
        Its condition, as `noise.inference.inputs.scaled` gives it.
    features : tuple of (mapping of str to float)
        In the field, and on the rig [unit of each feature].
    """

    label: str
    scaled: NDArray[np.float64]
    features: tuple[Mapping[str, float], Mapping[str, float]]


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


def draw_run_sample(seed: np.random.SeedSequence) -> RunSample:
    """Draw one audible run and take its features."""
    run = draw_audible_run(np.random.default_rng(seed))
    features = recording_features(run.field), recording_features(run.rig)
    return RunSample(run.label, scaled(run.condition), features)


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
    return interval_coverage(model, _as_arrays(list(samples), model.names))


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
                table_seen = of_channels(table, names, subsets)
                rows.append(segment_features(table_seen, names, known))
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
