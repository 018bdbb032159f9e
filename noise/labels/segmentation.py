"""Segmentation of a recording: the Viterbi path of labels, and when each change happens.

Neighbouring windows share half of what they hold, so each speaks for itself by half only; and a
noise seldom changes into another within a second. The best path under both is Viterbi's.

Windows tell what is heard but not when it began. Between two of different labels lies one change at
most, and it is where the short frames before and after it differ most: the split with the largest
sum of squares between its two sides, the classical change of mean.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from features.windows.blocks import FRAME_RATE, RATE
from features.windows.frames import FRAME, FRAME_COLUMNS
from features.windows.table import HOP

NOISES = 3
"""The first labels are the noises."""

_NONE = NOISES
"""The label after them is ``none``."""

_CLEAREST = 0.25
"""Share of a stretch's windows that its name is heard from [-]."""

QUIET = 30.0
"""A window that lies farther below the loudest of its stretch does not name it [dB]: what is heard
in it is echo, the end of a fade or a codec's rest, which a trim or another format changes."""

_OWN_SHARE = 0.5
"""Of a window in what it holds [-]."""

_CHANGE = 0.3
"""How likely a change of label from one window to the next is, relative to none [-]: with less, a
squeal of two windows is lost among those beside it."""

_OVER_REST = 3.0
"""Odds that a name needs over those that it has in the rest of the recording [ratio]."""

_LEAST_REST = 4
"""Fewer windows are no rest to compare with."""

_LEAST = 1e-4
"""Probability that none falls below [-]."""

_SPREADS = {"flatness": 6.0, "peak_share": 0.25, "second": 10.0, "flux": 0.3, "voiced": 0.3}
"""By how much frames of one noise differ in what is compared beside the bands."""

_BAND_SPREAD = 8.0
_BAND_RANGE = 50.0
"""Spread of a band's level, and how far below the loudest it counts [dB]."""

_CONTEXT = 0.75
"""How far to either side the frames are compared [s]."""

_REACH = 0.4
"""How far from the middle between two windows the change may lie [s]: a noise is heard in a window
that holds little of it."""

_LEAD = 0.5 * FRAME / RATE - 0.5 / FRAME_RATE
"""From a frame's place in the row to the moment halfway between its middle and the one before."""


def viterbi_path(probabilities: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the label of each window on the likeliest path.

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
    """Return the stretches of the Viterbi path, each called what is heard where it is clearest.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]; each row sums to 1; noises first, ``unknown`` last.
    thresholds : sequence of 3 floats, optional
        Probability [-] from which each noise is named, as of `named`. By default the likeliest
        label is said.
    level : ndarray, shape (n_windows,), optional
        Of each window [dB]; without it none is taken for `QUIET`.

    Returns
    -------
    edges : ndarray of int, shape (n_stretches + 1,)
        First window of each stretch, and the number of windows.
    names : ndarray of int, shape (n_stretches,)
        Columns of their labels, of which neighbours differ.
    audible : ndarray, shape (n_stretches, n_labels)
        Probabilities [-] where each is clearest.

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
    # A noise too short to leave the path of `none` is no longer than it is heard.
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
    """Take back the names of stretches that are hardly likelier there than in what has no name.

    What hums or clicks all through a recording is a part of its background.
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
    """Whether each window has a say in what its stretch is called."""
    # At the border of `none` half a window is of what lies beside it.
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
    """Return probabilities where each group is clearest: of all of it where no window speaks."""
    speaking = speaking | ~np.isin(group, group[speaking])
    return clearest(probabilities[speaking], group[speaking])


def named(p: NDArray[np.float64], thresholds: Sequence[float]) -> NDArray[np.intp]:
    """Name what is probable enough: a noise from its own threshold on.

    Parameters
    ----------
    p : ndarray, shape (n, n_labels)
        [-]; noises first, ``unknown`` last.
    thresholds : sequence of 3 floats
        Probability [-] from which each noise is named: one that is taken for others more easily
        has to be surer.

    Returns
    -------
    ndarray of int, shape (n,)
        Columns of `p`: the likeliest noise that reaches its threshold, else the likeliest of the
        others; ``unknown`` where a noise is likeliest and not probable enough.

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
    """Mean over the quarter of each group's windows that sounds most like a noise.

    A creak is short, and pauses: in the mean over all that was recorded with it, it is lost.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]
    group : ndarray of int, shape (n_windows,)
        0, 1, 2 ..., none of which is without a window.

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
    """Find when each change between two windows happens.

    Parameters
    ----------
    frames : ndarray of float32, shape (n_frames, n_columns)
        As `features.windows.table.WindowTable` has them.
    changes : ndarray of int, shape (n_changes,)
        Window after which each change is; rising.

    Returns
    -------
    ndarray, shape (n_changes,)
        [s], rising.

    Examples
    --------
    >>> frames = np.zeros((200, 20), dtype=np.float32)
    >>> frames[90:] = 30.0
    >>> change_points(frames, np.array([2])).round(2).tolist()
    [0.91]
    """
    # Halfway from the middle of one window to that of the next.
    middles = (changes + 1.5) * HOP
    times = []
    for i, middle in enumerate(middles.tolist()):
        low = 0.5 * (middles[i - 1] + middle) if i else 0.0
        high = 0.5 * (middles[i + 1] + middle) if i + 1 < middles.size else np.inf
        first = _change(frames, middle, float(low), float(high))
        # Once more with as much on either side of it.
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
    # In digital silence they tell of nothing but what the resampling left there.
    others[energy < energy.max(initial=-300.0) - _BAND_RANGE] = 0.0
    return np.concatenate([bands / np.sqrt(bands.shape[1] / 4.0), others], axis=1)
