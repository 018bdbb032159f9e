"""The course of labels that the windows' probabilities speak for, without flicker.

Neighbouring windows share half of what they hear, so each speaks for itself by half only; and a
noise seldom changes into another within a second. The best course under both is Viterbi's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["likeliest_course", "named_course"]

_OWN_SHARE = 0.5
"""Of a window in what it hears."""

_CHANGE = 0.15
"""How likely a change of label from one window to the next is, relative to none."""

_LEAST = 1e-4


def likeliest_course(probabilities: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the likeliest label of each window.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)

    Returns
    -------
    ndarray of int, shape (n_windows,)

    Examples
    --------
    >>> flickering = np.array([[0.9, 0.1]] * 4 + [[0.4, 0.6]] + [[0.9, 0.1]] * 4)
    >>> likeliest_course(flickering).tolist()
    [0, 0, 0, 0, 0, 0, 0, 0, 0]
    """
    n, labels = probabilities.shape
    spoken = _OWN_SHARE * np.log(np.maximum(probabilities, _LEAST))
    change = np.log(_CHANGE)
    origin = np.empty((n, labels), dtype=np.intp)
    score = spoken[0]
    for i in range(1, n):
        best = int(score.argmax())
        changed = score[best] + change
        origin[i] = np.where(score >= changed, np.arange(labels), best)
        score = np.maximum(score, changed) + spoken[i]
    course = np.empty(n, dtype=np.intp)
    course[-1] = score.argmax()
    for i in range(n - 1, 0, -1):
        course[i - 1] = origin[i, course[i]]
    return course


def named_course(
    probabilities: NDArray[np.float64],
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return segments of the likeliest course, each called what its windows are together.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)

    Returns
    -------
    edges : ndarray of int, shape (n_segments + 1,)
        First window of each segment, and the number of windows.
    names : ndarray of int, shape (n_segments,)
        Labels, of which neighbours differ.

    Examples
    --------
    >>> edges, names = named_course(np.array([[0.9, 0.1]] * 4 + [[0.1, 0.9]] * 6))
    >>> edges.tolist(), names.tolist()
    ([0, 4, 10], [0, 1])
    """
    n = len(probabilities)
    changes = np.flatnonzero(np.diff(likeliest_course(probabilities))) + 1
    edges = np.concatenate([[0], changes, [n]])
    sums = np.add.reduceat(probabilities, edges[:-1], axis=0)
    names = sums.argmax(axis=1)
    first = np.concatenate([[True], names[1:] != names[:-1]])
    return np.concatenate([edges[:-1][first], [n]]), names[first]
