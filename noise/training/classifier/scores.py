"""Scores of a classifier: accuracy, F1, calibration error, background sounds called a noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["scores"]


def scores(p: NDArray[np.float64], y: NDArray[np.int64], unknown: int) -> dict[str, object]:
    """Score the probabilities of recordings.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
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
