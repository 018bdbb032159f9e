"""Segmentation of a recording: Viterbi path of labels, and times of their changes.

Neighbouring windows overlap by half, so each counts by half, and a noise seldom changes into
another within a second. Viterbi's algorithm finds the most probable path under both assumptions.

The time of a change between two windows with different labels is found in the short frames: it is
the split with the largest between-group sum of squares, as in classical change-point detection.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from features.windows.blocks import FRAME_RATE, RATE
from features.windows.frames import FRAME, FRAME_COLUMNS
from features.windows.table import HOP

NOISES = 3
"""Number of noises, which are the first labels."""

_NONE = NOISES
"""Column of the label ``none``."""

_CLEAREST = 0.25
"""Share of the windows of a stretch that determine its label [-]."""

QUIET = 30.0
"""Level below the loudest window of a stretch beyond which a window does not count for the label
[dB]: it contains echo, the end of a fade or codec artefacts."""

_OWN_SHARE = 0.5
"""Weight of a window, because of the overlap [-]."""

_CHANGE = 0.3
"""Probability of a change of label between windows, relative to no change [-]: with less, a squeal
of two windows is missed."""

_OVER_REST = 3.0
"""Minimum odds of a noise, relative to its odds in the rest of the recording [-]."""

_LEAST_REST = 4
"""Minimum number of windows of the rest."""

_LEAST = 1e-4
"""Lower limit of probabilities [-]."""

_SPREADS = {"flatness": 6.0, "peak_share": 0.25, "second": 10.0, "flux": 0.3, "voiced": 0.3}
"""Scatter of the frame features that are compared beside the bands, within one noise."""

_BAND_SPREAD = 8.0
_BAND_RANGE = 50.0
"""Scatter of the level of a band, and its range below the loudest level [dB]."""

_CONTEXT = 0.75
"""Duration on either side in which frames are compared [s]."""

_REACH = 0.4
"""Maximum distance of the change from the middle between two windows [s]: a short part of a noise
can determine the label of a window."""

_LEAD = 0.5 * FRAME / RATE - 0.5 / FRAME_RATE
"""Offset from the start of a frame to the middle between it and the frame before [s]."""


def viterbi_path(probabilities: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the label of each window on the most probable path.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]; each row sums to 1.

    Returns
    -------
    ndarray of int, shape (n_windows,)
        Columns of `probabilities`.

    Examples
    --------
    >>> flickering = np.array([[0.9, 0.1]] * 4 + [[0.4, 0.6]] + [[0.9, 0.1]] * 4)
    >>> viterbi_path(flickering).tolist()
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
    path = np.empty(n, dtype=np.intp)
    path[-1] = score.argmax()
    for i in range(n - 1, 0, -1):
        path[i - 1] = origin[i, path[i]]
    return path


def labelled_stretches(
    probabilities: NDArray[np.float64],
    thresholds: Sequence[float] | None = None,
    level: NDArray[np.floating] | None = None,
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Return the stretches of the Viterbi path, each with the label of its clearest windows.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]; each row sums to 1; noises first, ``unknown`` last.
    thresholds : sequence of 3 floats, optional
        Minimum probability of each noise [-], as in `named`. By default the most probable label is
        taken.
    level : ndarray, shape (n_windows,), optional
        Level of each window [dB]; without it, no window is excluded as `QUIET`.

    Returns
    -------
    edges : ndarray of int, shape (n_stretches + 1,)
        First window of each stretch, and the number of windows.
    names : ndarray of int, shape (n_stretches,)
        Columns of their labels; neighbours differ.
    audible : ndarray, shape (n_stretches, n_labels)
        Probabilities of their clearest windows [-].

    Examples
    --------
    >>> creak, none = [0.8, 0.0, 0.0, 0.2, 0.0], [0.1, 0.0, 0.0, 0.9, 0.0]
    >>> edges, names, _ = labelled_stretches(np.array([none] * 4 + [creak] * 6))
    >>> edges.tolist(), names.tolist()
    ([0, 4, 10], [3, 0])
    >>> labelled_stretches(np.array([none] * 4 + [creak] * 6), [0.85, 0.5, 0.5])[1].tolist()
    [3, 4]
    """
    n = len(probabilities)
    path = viterbi_path(probabilities)
    group = np.concatenate([[0], np.cumsum(np.diff(path) != 0)])
    speaking = _speaking(path, group, level)
    p = _where_clearest(probabilities, group, speaking)
    if thresholds is None:
        names = p.argmax(axis=1)[group]
    else:
        names = _over_the_rest(named(p, thresholds), p, probabilities, group)[group]
    # A noise in a path of `none` is cut to the windows in which it is more probable.
    noise = probabilities[np.arange(n), names]
    outside = (path == _NONE) & (names < NOISES) & (noise < probabilities[:, _NONE])
    for stretch in np.unique(group[outside]).tolist():
        own = group == stretch
        audible = np.flatnonzero(own & ~outside)
        if audible.size:
            own[audible[0] : audible[-1] + 1] = False
            names[own] = _NONE
    first = np.concatenate([[True], names[1:] != names[:-1]])
    edges = np.concatenate([np.flatnonzero(first), [n]])
    return edges, names[first], _where_clearest(probabilities, np.cumsum(first) - 1, speaking)


def _over_the_rest(
    names: NDArray[np.intp],
    p: NDArray[np.float64],
    probabilities: NDArray[np.float64],
    group: NDArray[np.intp],
) -> NDArray[np.intp]:
    """Return names without noises that are hardly more probable than in the rest of the recording.

    A hum or click throughout a recording belongs to its background.
    """
    rest = probabilities[names[group] >= NOISES, :NOISES]
    if len(rest) < _LEAST_REST:
        return names
    usual = np.clip(np.median(rest, axis=0), _LEAST, 1.0 - _LEAST)
    own = np.clip(p[:, :NOISES], _LEAST, 1.0 - _LEAST)
    over = own / (1.0 - own) / (usual / (1.0 - usual))
    noise = names < NOISES
    few = noise & (over[np.arange(names.size), np.where(noise, names, 0)] < _OVER_REST)
    return np.where(few, p.shape[1] - 1, names)


def _speaking(
    path: NDArray[np.intp], group: NDArray[np.intp], level: NDArray[np.floating] | None
) -> NDArray[np.bool_]:
    """Whether each window counts for the label of its stretch."""
    # Half of a window at the border of `none` belongs to its neighbour.
    other = np.concatenate([[False], np.diff(path) != 0, [False]])
    speaking: NDArray[np.bool_] = (path != _NONE) | ~(other[:-1] | other[1:])
    if level is None:
        return speaking
    loudest = np.full(group[-1] + 1, -np.inf)
    np.maximum.at(loudest, group, np.where(speaking, level, -np.inf))
    speaking &= level >= loudest[group] - QUIET
    return speaking


def _where_clearest(
    probabilities: NDArray[np.float64], group: NDArray[np.intp], speaking: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return probabilities of the clearest windows that count, else of all windows, by group."""
    speaking = speaking | ~np.isin(group, group[speaking])
    return clearest(probabilities[speaking], group[speaking])


def named(p: NDArray[np.float64], thresholds: Sequence[float]) -> NDArray[np.intp]:
    """Return labels by probability, with a threshold for each noise.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
        Probabilities [-]; noises first, ``unknown`` last.
    thresholds : sequence of 3 floats
        Minimum probability of each noise [-].

    Returns
    -------
    ndarray of int, shape (n,)
        Columns of `p`: the most probable noise that reaches its threshold, else the most probable
        other label; ``unknown`` if the most probable label is a noise below its threshold.

    Examples
    --------
    >>> p = np.array([[0.6, 0.1, 0.2, 0.0, 0.1], [0.2, 0.1, 0.6, 0.1, 0.0]])
    >>> named(p, [0.5, 0.7, 0.7]).tolist()
    [0, 4]
    """
    names, noises = p.argmax(axis=1), p[:, :NOISES]
    names[names < NOISES] = p.shape[1] - 1
    enough = np.where(noises >= np.asarray(thresholds), noises, -1.0)
    reached: NDArray[np.intp] = np.where(enough.max(axis=1) > -1.0, enough.argmax(axis=1), names)
    return reached


def clearest(probabilities: NDArray[np.float64], group: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return mean probabilities of the quarter of each group's windows that is most like a noise.

    A creak is short and has pauses, so it would be lost in the mean of all windows.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]
    group : ndarray of int, shape (n_windows,)
        Group of each window: 0, 1, 2 ..., each with one window at least.

    Returns
    -------
    ndarray, shape (n_groups, n_labels)
        [-]

    Examples
    --------
    >>> creak, other = [0.9, 0.0, 0.0, 0.0, 0.1], [0.1, 0.0, 0.0, 0.0, 0.9]
    >>> clearest(np.array([creak, other, other, other, other]), np.array([0, 0, 0, 0, 1]))[:, 0]
    array([0.9, 0.1])
    """
    counts = np.bincount(group)
    taken = np.maximum(1, np.round(_CLEAREST * counts)).astype(int)
    order = np.lexsort((-probabilities[:, :NOISES].max(axis=1), group))
    rank = np.arange(group.size) - np.repeat(np.cumsum(counts) - counts, counts)
    retained = order[rank < taken[group[order]]]
    sums = np.zeros((counts.size, probabilities.shape[1]))
    np.add.at(sums, group[retained], probabilities[retained])
    return np.asarray(sums / taken[:, None])


def change_points(frames: NDArray[np.float32], changes: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the times of changes of label.

    Parameters
    ----------
    frames : ndarray of float32, shape (n_frames, n_columns)
        As `features.windows.table.WindowTable` has them.
    changes : ndarray of int, shape (n_changes,)
        Window before each change; increasing.

    Returns
    -------
    ndarray, shape (n_changes,)
        Times, increasing [s].

    Examples
    --------
    >>> frames = np.zeros((200, 20), dtype=np.float32)
    >>> frames[90:] = 30.0
    >>> change_points(frames, np.array([2])).round(2).tolist()
    [0.91]
    """
    # Middle between the centres of two windows.
    middles = (changes + 1.5) * HOP
    times = []
    for i, middle in enumerate(middles.tolist()):
        low = 0.5 * (middles[i - 1] + middle) if i else 0.0
        high = 0.5 * (middles[i + 1] + middle) if i + 1 < middles.size else np.inf
        first = _change(frames, middle, float(low), float(high))
        # Repeated with the same duration on either side.
        times.append(_change(frames, first, float(low), float(high)))
    return np.array(times)


def _change(frames: NDArray[np.float32], middle: float, low: float, high: float) -> float:
    first = max(0, round((max(low, middle - _CONTEXT) - _LEAD) * FRAME_RATE))
    last = min(len(frames), round((min(high, middle + _CONTEXT) - _LEAD) * FRAME_RATE))
    allowed = np.arange(
        max(first + 2, round((middle - _REACH - _LEAD) * FRAME_RATE)),
        min(last - 2, round((middle + _REACH - _LEAD) * FRAME_RATE)) + 1,
    )
    if not allowed.size:
        return middle
    x = _comparable(frames[first:last])
    sums = np.cumsum(x, axis=0)
    before = allowed - first
    after = len(x) - before
    left = sums[before - 1] / before[:, None]
    right = (sums[-1] - sums[before - 1]) / after[:, None]
    between = before * after / len(x) * ((left - right) ** 2).sum(axis=1)
    return float(allowed[between.argmax()]) / FRAME_RATE + _LEAD


def _comparable(frames: NDArray[np.float32]) -> NDArray[np.float64]:
    bands = frames[:, len(FRAME_COLUMNS) :].astype(np.float64)
    bands = np.maximum(bands, bands.max(initial=-300.0) - _BAND_RANGE) / _BAND_SPREAD
    columns = [FRAME_COLUMNS.index(name) for name in _SPREADS]
    others = frames[:, columns] / np.array(list(_SPREADS.values()))
    energy = frames[:, FRAME_COLUMNS.index("energy")]
    # In digital silence they describe only artefacts of resampling.
    others[energy < energy.max(initial=-300.0) - _BAND_RANGE] = 0.0
    return np.concatenate([bands / np.sqrt(bands.shape[1] / 4.0), others], axis=1)
