"""Calibration of the votes: probabilities, and how few background sounds are called a noise.

Six numbers are fitted on samples that no tree saw, for the mean over a recording's windows to have
the smallest log loss. The weights of the noises are lowered further until no more than
`FALSE_NAMES` of the background sounds are named one as files are: by the longest segment that is
not ``none``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from noise.classifier.model import Calibration
from noise.labels.segmentation import labelled_stretches

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FALSE_NAMES", "file_name", "fit_calibration", "means_of_groups", "scores"]

FALSE_NAMES = 0.03
"""Of the background sounds in the calibration set [-] may be called a noise at most."""

_NOISES = 3
"""The first labels are the noises; what follows is none of them."""

_LOWEST = -2.0
"""Logarithm of a weight that no noise falls below."""

_PRIOR = 20.0
"""So many recordings weigh as much as the wish that the six numbers change nothing."""


def fit_calibration(
    votes: NDArray[np.float64], group: NDArray[np.int64], y: NDArray[np.int64], unknown: int
) -> Calibration:
    """Fit a calibration.

    Parameters
    ----------
    votes : ndarray, shape (n_windows, n_labels)
        [-]; each row sums to 1.
    group : ndarray of int, shape (n_windows,)
        Recording of each window.
    y : ndarray of int, shape (n_recordings,)
        Label of each recording.
    unknown : int
        Label of the background sounds.

    Returns
    -------
    Calibration

    Examples
    --------
    >>> votes = np.array([[0.8, 0.2], [0.3, 0.7]] * 20)
    >>> found = fit_calibration(votes, np.arange(40), np.array([0, 1] * 20), 1)
    >>> found.sharpness > 1.0
    True
    """
    labels = votes.shape[1]
    rows = np.arange(y.size)

    def calibration(x: NDArray[np.float64]) -> Calibration:
        return Calibration(float(np.exp(x[0])), tuple(np.exp(x[1:]).tolist()))

    def loss(x: NDArray[np.float64]) -> float:
        p = means_of_groups(calibration(x)(votes), group)[rows, y]
        return float(-np.mean(np.log(p)) + _PRIOR / y.size * np.mean(x**2))

    bounds = [(-2.0, 2.0)] * (labels + 1)
    x = minimize(loss, np.zeros(labels + 1), method="L-BFGS-B", bounds=bounds).x
    others = np.flatnonzero(y == unknown)
    windows = [votes[group == other] for other in others.tolist()]
    noises = np.arange(min(_NOISES, labels))
    noises = noises[noises != unknown]
    while windows and x[1 + noises].min() >= _LOWEST:
        found = calibration(x)
        named = [file_name(found(other), _NOISES) for other in windows]
        if np.mean(np.isin(named, noises)) <= FALSE_NAMES:
            break
        x[1 + noises] -= 0.05
    return calibration(x)


def file_name(p: NDArray[np.float64], none: int) -> int:
    """Label of a file by its windows: that of the longest segment that is not `none`.

    Parameters
    ----------
    p : ndarray, shape (n_windows, n_labels)
        Probabilities [-].
    none : int
        Label that names no file but where there is no other.

    Returns
    -------
    int

    Examples
    --------
    >>> file_name(np.array([[0.9, 0.0, 0.1]] * 4 + [[0.0, 0.9, 0.1]] * 8), none=1)
    0
    """
    edges, names = labelled_stretches(p)
    length = np.where(names == none, 0, np.diff(edges))
    return int(names[length.argmax()])


def means_of_groups(p: NDArray[np.float64], group: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mean of the rows of each group 0, 1, 2 ..., none of which is empty.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
        [-]
    group : ndarray of int, shape (n,)

    Returns
    -------
    ndarray, shape (n_groups, n_labels)
        [-]

    Examples
    --------
    >>> means_of_groups(np.array([[1.0], [3.0], [5.0]]), np.array([0, 0, 1])).tolist()
    [[2.0], [5.0]]
    """
    sums = np.zeros((int(group.max()) + 1, p.shape[1]))
    np.add.at(sums, group, p)
    return np.asarray(sums / np.bincount(group)[:, None])


def scores(p: NDArray[np.float64], y: NDArray[np.int64], unknown: int) -> dict[str, object]:
    """Score the probabilities of recordings.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
        [-]
    y : ndarray of int, shape (n,)
    unknown : int
        The label of background sounds, which follows those of all noises and ``none``.

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

    found = p.argmax(axis=1)
    certainty = p.max(axis=1)
    bins = np.minimum((10.0 * certainty).astype(int), 9)
    right = found == y
    ece = sum(
        np.mean(bins == b) * abs(np.mean(right[bins == b]) - np.mean(certainty[bins == b]))
        for b in np.unique(bins)
    )
    others = found[y == unknown]
    false = float(np.mean(others < unknown - 1)) if others.size else 0.0
    return {
        "n": int(y.size),
        "accuracy": round(float(np.mean(right)), 4),
        "macro_f1": round(float(f1_score(y, found, average="macro", zero_division=0.0)), 4),
        "expected_calibration_error": round(float(ece), 4),
        "strangers_named": round(false, 4),
        "confusion": confusion_matrix(y, found, labels=np.arange(p.shape[1])).tolist(),
    }
