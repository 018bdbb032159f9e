"""Calibration, thresholds and scores of the classifier, from left-out votes.

The six numbers of a calibration minimise the log loss of the clearest windows of each sample. The
threshold of each noise limits its false names on real backgrounds of the same surroundings. False
names are counted on sources that did not determine the thresholds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import chi2

from features.windows.table import HOP
from noise.classifier.model import Calibration, Thresholds, at_sensitivity
from noise.labels.segmentation import NOISES, clearest, labelled_stretches

FALSE_NAMES_AN_HOUR = np.array([15.0, 8.0, 20.0])
"""Maximum number of false creaks, squawks and squeals in real backgrounds per hour [1/h], chosen so
that real creaks and squeals of other sources are named."""

_LEAST, _MOST = 0.25, 0.97
"""Range of the thresholds [-]."""

_PRIOR = 20.0
"""Strength of the prior of no change, in recordings."""


def fit_calibration(
    votes: NDArray[np.float64],
    group: NDArray[np.intp],
    y: NDArray[np.int64],
    weight: NDArray[np.float64] | None = None,
) -> Calibration:
    """Return the calibration with the lowest log loss.

    Parameters
    ----------
    votes : ndarray, shape (n_windows, n_labels)
        Votes [-]; each row sums to 1.
    group : ndarray of int, shape (n_windows,)
        Recording of each window: 0, 1, 2 ...
    y : ndarray of int, shape (n_recordings,)
        Label of each recording.
    weight : ndarray, shape (n_recordings,), optional
        Weights [-]; equal by default.

    Returns
    -------
    Calibration

    Examples
    --------
    >>> votes = np.array([[0.8, 0.2], [0.3, 0.7]] * 20)
    >>> found = fit_calibration(votes, np.arange(40), np.array([0, 1] * 20))
    >>> found.sharpness > 1.0
    True
    """
    labels = votes.shape[1]
    rows = np.arange(y.size)
    weight = np.ones(y.size) if weight is None else weight

    def calibration(x: NDArray[np.float64]) -> Calibration:
        return Calibration(float(np.exp(x[0])), tuple(np.exp(x[1:]).tolist()))

    def loss(x: NDArray[np.float64]) -> float:
        p = clearest(calibration(x)(votes), group)[rows, y]
        return float(np.average(-np.log(p), weights=weight) + _PRIOR / y.size * np.mean(x**2))

    bounds = [(-2.0, 2.0)] * (labels + 1)
    return calibration(minimize(loss, np.zeros(labels + 1), method="L-BFGS-B", bounds=bounds).x)


def fit_thresholds(
    backgrounds: Sequence[NDArray[np.float64]],
) -> tuple[float, float, float]:
    """Return the lowest thresholds with at most `FALSE_NAMES_AN_HOUR`.

    Parameters
    ----------
    backgrounds : sequence of ndarray, shape (n_windows, n_labels)
        Probabilities of the windows of each background sound [-].

    Returns
    -------
    tuple of 3 floats
        Minimum probabilities of creak, squawk and squeal [-].

    Examples
    --------
    >>> clear, creaky = [0.0, 0.0, 0.0, 0.1, 0.9], [0.7, 0.0, 0.0, 0.0, 0.3]
    >>> found = fit_thresholds([np.array([clear] * 900), *[np.array([creaky] * 9)] * 9])
    >>> np.round(found, 2).tolist()
    [0.7, 0.25, 0.25]
    """
    hours = HOP * max(1, sum(map(len, backgrounds))) / 3600.0
    # One false name in a short time is not significant.
    most = np.maximum(FALSE_NAMES_AN_HOUR, 1.0 / hours)
    limits = np.append(np.arange(_LEAST, _MOST, 0.01), _MOST)
    low, high = np.zeros(NOISES, dtype=int), np.full(NOISES, limits.size - 1)
    while (low < high).any():  # bisection: higher thresholds give fewer names
        middle = (low + high) // 2
        few = false_names(backgrounds, limits[middle]) <= most
        low, high = np.where(few, low, np.minimum(middle + 1, high)), np.where(few, middle, high)
    creak, squawk, squeal = limits[low].tolist()
    return creak, squawk, squeal


def false_names(
    backgrounds: Sequence[NDArray[np.float64]], thresholds: Sequence[float]
) -> NDArray[np.float64]:
    """Return the rate of false names in background sounds.

    Parameters
    ----------
    backgrounds : sequence of ndarray, shape (n_windows, n_labels)
        Probabilities of the windows of each background sound [-].
    thresholds : sequence of 3 floats
        Minimum probability of each noise [-].

    Returns
    -------
    ndarray, shape (3,)
        Rates of creak, squawk and squeal [1/h].

    Examples
    --------
    >>> hour = np.tile([0.7, 0.0, 0.0, 0.0, 0.3], (14_400, 1))
    >>> false_names([hour], [0.6, 0.5, 0.5]).tolist()
    [1.0, 0.0, 0.0]
    """
    names = [labelled_stretches(p, thresholds)[1] for p in backgrounds]
    counts = np.bincount(np.concatenate([*names, np.arange(0)]), minlength=NOISES)[:NOISES]
    return np.asarray(counts * 3600.0 / (HOP * max(1, sum(map(len, backgrounds)))))


@dataclass(frozen=True, eq=False)
class Background:
    """Left-out probabilities of a real background sound.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        Probabilities [-].
    part : int
        Part of the cross-fitting.
    """

    probabilities: NDArray[np.float64]
    part: int


def false_name_rates(
    backgrounds: Sequence[Background],
    thresholds: Mapping[int, Thresholds],
    sensitivities: Sequence[float],
) -> dict[str, dict[str, float]]:
    """Return rates of false names on sources that did not determine the thresholds.

    Parameters
    ----------
    backgrounds : sequence of Background
    thresholds : mapping of int to tuple of 3 floats
        Thresholds by part, determined by the other parts [-].
    sensitivities : sequence of float
        Factors on the odds of a noise [-].

    Returns
    -------
    dict
        By sensitivity: number of ``names`` in ``hours``, their rate ``an_hour`` [1/h], and the
        95 % interval of a Poisson count from ``low`` to ``high`` [1/h].

    Examples
    --------
    >>> other = [0.0, 0.0, 0.0, 0.1, 0.9]
    >>> quiet = [Background(np.array([other] * 7200), part) for part in (0, 1)]
    >>> false_name_rates(quiet, {0: (0.5, 0.5, 0.5), 1: (0.4, 0.5, 0.5)}, [1.0])
    {'1': {'names': 0, 'hours': 1.0, 'an_hour': 0.0, 'low': 0.0, 'high': 3.7}}
    """
    names = dict.fromkeys(sensitivities, 0)
    for part, chosen in thresholds.items():
        own = [b.probabilities for b in backgrounds if b.part == part]
        for sensitivity in sensitivities:
            limits = at_sensitivity(chosen, sensitivity)
            labels = [labelled_stretches(p, limits)[1] for p in own]
            names[sensitivity] += int(sum(np.sum(one < NOISES) for one in labels))
    hours = HOP * max(1, sum(len(b.probabilities) for b in backgrounds)) / 3600.0
    return {
        f"{sensitivity:g}": {
            "names": n,
            "hours": round(hours, 3),
            "an_hour": round(n / hours, 1),
            "low": round(float(chi2.ppf(0.025, 2 * n)) / 2.0 / hours, 1) if n else 0.0,
            "high": round(float(chi2.ppf(0.975, 2 * n + 2)) / 2.0 / hours, 1),
        }
        for sensitivity, n in names.items()
    }


def scores(p: NDArray[np.float64], y: NDArray[np.int64], unknown: int) -> dict[str, object]:
    """Return scores of the probabilities of recordings.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
        [-]
    y : ndarray of int, shape (n,)
    unknown : int
        Label of background sounds, which comes after the noises and ``none``.

    Returns
    -------
    dict
        ``confusion`` has a row for each true label.

    Examples
    --------
    >>> found = scores(np.eye(3)[[0, 1, 2, 0]], np.array([0, 1, 2, 2]), 2)
    >>> found["accuracy"], found["confusion"]
    (0.75, [[1, 0, 0], [0, 1, 0], [1, 0, 1]])
    """
    from sklearn.metrics import confusion_matrix, f1_score

    names = p.argmax(axis=1)
    certainty = p.max(axis=1)
    bins = np.minimum((10.0 * certainty).astype(int), 9)
    right = names == y
    ece = sum(
        np.mean(bins == b) * abs(np.mean(right[bins == b]) - np.mean(certainty[bins == b]))
        for b in np.unique(bins)
    )
    others = names[y == unknown]
    false = float(np.mean(others < unknown - 1)) if others.size else 0.0
    return {
        "n": int(y.size),
        "accuracy": round(float(np.mean(right)), 4),
        "macro_f1": round(float(f1_score(y, names, average="macro", zero_division=0.0)), 4),
        "expected_calibration_error": round(float(ece), 4),
        "strangers_named": round(false, 4),
        "confusion": confusion_matrix(y, names, labels=np.arange(p.shape[1])).tolist(),
    }
