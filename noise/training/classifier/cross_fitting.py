"""Cross-fitting of the classifier: trees, calibration, thresholds and scores by left-out sources.

Kinds of bodies and backgrounds and sources of real sounds are divided into five parts, and trees
grown without a part give votes for it. These votes calibrate the classifier and are scored, each
part with the calibration of the other four.

The classifier has to work with any subset of channels, so each recording of three channels is
learned several times, with some channels masked. A few dozen real sounds of friction have no effect
among thousands of simulated ones, so trees are also grown on the real sounds alone, and a share of
their log odds is added.

The six numbers of a calibration minimise the log loss of the clearest windows of each sound. The
threshold of each noise limits its false names on real backgrounds of the same surroundings. False
names are counted on sources that did not determine the thresholds.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import chi2

from features.windows.table import HOP
from noise.base.arrays import Array
from noise.base.labels import LABELS, SURROUNDINGS
from noise.base.trees import BoostedTrees
from noise.classifier.model import (
    Calibration,
    Classifier,
    Thresholds,
    at_sensitivity,
    has_more_than_sound,
)
from noise.labels.segmentation import NOISES, clearest, labelled_stretches, named
from noise.labels.windows import FEATURE_NAMES
from noise.training.classifier.background_sounds import BACKGROUND_SOUNDS
from noise.training.classifier.samples import Sample
from noise.training.trees import grow_boosted_trees

N_FOLDS = 5
"""Number of parts of the cross-fitting."""

_N_ROUNDS, _REAL_ROUNDS = 220, 50
"""Trees per class, for all sounds and for the real sounds alone."""

_REAL_SHARE = 0.3
"""Share of the log odds of the real sounds' trees [-]; chosen on left-out sources."""

_KINDS = ("pressure", "acceleration", "torque")
_SUBSETS = (
    ("pressure",),
    _KINDS,
    ("pressure", "acceleration"),
    ("pressure", "torque"),
    ("acceleration", "torque"),
    ("acceleration",),
    ("torque",),
)
"""Subsets of channels that are learned; the most frequent ones come first."""

FALSE_NAMES_AN_HOUR = np.array([15.0, 8.0, 20.0])
"""Maximum number of false creaks, squawks and squeals in real backgrounds per hour [1/h], chosen so
that real creaks and squeals of other sources are named."""


class Rows(NamedTuple):
    """Training rows: windows of sounds under several masks of their channels.

    Parameters
    ----------
    x : ndarray of float32, shape (n_rows, n_features)
        By `noise.labels.windows.FEATURE_NAMES` [unit of each feature].
    y : ndarray of int, shape (n_rows,)
        Columns of `LABELS`.
    weight : ndarray, shape (n_rows,)
        Weights [-].
    real : ndarray of bool, shape (n_rows,)
        Whether each row is of a real sound.
    owner : ndarray of int, shape (n_rows,)
        Index of the sound of each row.
    """

    x: NDArray[np.float32]
    y: NDArray[np.int64]
    weight: Array
    real: NDArray[np.bool_]
    owner: NDArray[np.intp]

    @classmethod
    def of(cls, sounds: Sequence[Sample]) -> Rows:
        """Return the rows of sounds."""
        x, counts, weight, owner = [], [], [], []
        for i, sound in enumerate(sounds):
            several = has_more_than_sound(sound.features, FEATURE_NAMES).any()
            for subset in _SUBSETS if several else _SUBSETS[:1]:
                x.append(masked(sound.features, subset))
                counts.append(len(sound.features))
                share = 1.0 if subset in _SUBSETS[:2] else 0.4
                weight.append(share * sound.weight / len(sound.features))
                owner.append(i)
        owners = np.repeat(owner, counts)
        real = np.array([sound.real for sound in sounds])
        labels = columns_of_labels(sounds)
        return cls(
            np.concatenate(x), labels[owners], np.repeat(weight, counts), real[owners], owners
        )

    def part(
        self, rows: NDArray[np.bool_], columns: NDArray[np.bool_] | slice = slice(None)
    ) -> Rows:
        """Return a selection of rows and columns."""
        x = self.x[rows][:, columns]
        return Rows(x, self.y[rows], self.weight[rows], self.real[rows], self.owner[rows])


def masked(features: NDArray[np.float32], kinds: Sequence[str] = _KINDS) -> NDArray[np.float32]:
    """Return features in which those of channels outside `kinds` are NaN."""
    retained = [name.partition("_")[0] in kinds for name in FEATURE_NAMES]
    return np.where(retained, features, np.float32(np.nan))


def columns_of_labels(sounds: Sequence[Sample]) -> NDArray[np.int64]:
    """Return the labels of sounds as columns of `LABELS`."""
    return np.array([LABELS.index(sound.label) for sound in sounds], dtype=np.int64)


def parts(sounds: Sequence[Sample], seed: int) -> NDArray[np.int64]:
    """Return the part of each sound: sources are whole, and labels are spread over all parts.

    Each bushing and each quiet place is a source.

    Returns
    -------
    ndarray of int, shape (n_sounds,)
    """
    alone = ("bushing", "quiet")
    names = [f"{s.source} {i}" if s.source in alone else s.source for i, s in enumerate(sounds)]
    labels: dict[str, Counter[str]] = {}
    for name, sound in zip(names, sounds, strict=True):
        labels.setdefault(name, Counter())[sound.label] += 1
    sources = sorted(labels)
    np.random.default_rng([seed, 2]).shuffle(sources)
    sources.sort(key=lambda name: labels[name].most_common(1)[0][0])  # stable: in groups
    part = {name: i % N_FOLDS for i, name in enumerate(sources)}
    return np.array([part[name] for name in names], dtype=np.int64)


class LeftOut(NamedTuple):
    """Probabilities of each sound by trees and a calibration without its part.

    Parameters
    ----------
    alone : list of ndarray, shape (n_windows, 5)
        Probabilities by the sound alone [-].
    together : list of ndarray, shape (n_windows, 5)
        Probabilities by all channels [-]; None without other channels.
    part : ndarray of int, shape (n_sounds,)
        Part of each sound.
    """

    alone: list[Array]
    together: list[Array | None]
    part: NDArray[np.int64]


def cross_fitted(sounds: Sequence[Sample], seed: int) -> tuple[Classifier, LeftOut]:
    """Train a classifier: trees, calibrations and thresholds.

    Parameters
    ----------
    sounds : sequence of Sample
    seed : int

    Returns
    -------
    classifier : Classifier
    left_out : LeftOut
        Left-out probabilities of the sounds.
    """
    part, rows = parts(sounds, seed), Rows.of(sounds)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(rows.x).any(axis=0))
    growing = Parallel(n_jobs=-1, return_as="generator")(
        delayed(_summed_trees)(rows.part(part[rows.owner] != k, known), seed, _N_ROUNDS)
        for k in range(N_FOLDS + 1)  # the last fit has all rows
    )
    alone: list[Array] = [np.empty(0)] * len(sounds)
    together: list[Array | None] = [None] * len(sounds)
    for k, trees in enumerate(growing):
        for i in np.flatnonzero(part == k).tolist():
            features = sounds[i].features
            sound = masked(features, _KINDS if sounds[i].real else _SUBSETS[0])
            alone[i] = trees.probabilities(sound[:, known])
            if has_more_than_sound(features, FEATURE_NAMES).any():
                together[i] = trees.probabilities(features[:, known])
    labels = columns_of_labels(sounds)
    weight = np.array([s.weight for s in sounds])
    counts = np.array([not s.varied for s in sounds])
    several = np.array([p is not None for p in together])
    calibrations, calibrated = [], []
    for votes, chosen in ((alone, counts), (together, several & counts)):
        chosen = chosen if chosen.any() else counts
        voted = [alone[i] if p is None else p for i, p in enumerate(votes)]
        calibrations.append(_calibration(voted, labels, weight, chosen))
        without = [
            _calibration(voted, labels, weight, chosen & (part != k)) for k in range(N_FOLDS)
        ]
        calibrated.append([without[part[i]](p) for i, p in enumerate(voted)])
    left_out = LeftOut(
        calibrated[0],
        [p if s else None for p, s in zip(calibrated[1], several, strict=True)],
        part,
    )
    backgrounds = real_backgrounds(sounds, left_out)
    thresholds = {name: _thresholds(backgrounds, name) for name in SURROUNDINGS}
    names = tuple(name for name, k in zip(FEATURE_NAMES, known, strict=True) if k)
    return Classifier(names, trees, (calibrations[0], calibrations[1]), {}, thresholds), left_out


def _summed_trees(rows: Rows, seed: int, n_rounds: int) -> BoostedTrees:
    """Return trees of all rows with a share of the trees of real sounds added."""
    trees = _trees(rows, seed, n_rounds)
    unknown = LABELS.index("unknown")
    known = np.unique(rows.y[rows.real])
    if known.min(initial=unknown) >= NOISES or unknown not in known:
        return trees
    own = _trees(rows.part(rows.real), seed, _REAL_ROUNDS)
    # A label without real sounds has the trees of `unknown`.
    columns = np.arange(len(LABELS))
    alike = np.where(np.isin(columns, known), columns, unknown)
    chosen = [np.flatnonzero(own.classes == k) for k in alike]
    n = len(trees.feature)
    return BoostedTrees(
        roots=np.concatenate([trees.roots, *(own.roots[c] + n for c in chosen)]),
        classes=np.concatenate([trees.classes, np.repeat(columns, list(map(len, chosen)))]).astype(
            np.int16
        ),
        feature=np.concatenate([trees.feature, own.feature]),
        threshold=np.concatenate([trees.threshold, own.threshold]),
        children=np.concatenate([trees.children, own.children + np.int32(n)]),
        missing_left=np.concatenate([trees.missing_left, own.missing_left]),
        value=np.concatenate([trees.value, _REAL_SHARE * own.value]),
        base=trees.base + _REAL_SHARE * own.base[alike],
    )


def _trees(rows: Rows, seed: int, n_rounds: int) -> BoostedTrees:
    """Return trees grown on rows with balanced labels."""
    x, y = rows.x.copy(), rows.y
    # scikit-learn needs one value of each feature and one row of each label.
    x[0, ~np.isfinite(x).any(axis=0)] = 0.0
    absent = np.setdiff1d(np.arange(len(LABELS)), y)
    weight = rows.weight / np.bincount(y, rows.weight, len(LABELS))[y]
    x = np.concatenate([x, np.repeat(x[:1], absent.size, axis=0)])
    weight = np.concatenate([weight, np.full(absent.size, 1e-9)])
    y = np.concatenate([y, absent])
    return grow_boosted_trees(x, y, weight=weight / weight.mean(), n_rounds=n_rounds, seed=seed)


def _calibration(
    votes: Sequence[Array], labels: NDArray[np.int64], weight: Array, chosen: NDArray[np.bool_]
) -> Calibration:
    windows = [p for p, one in zip(votes, chosen, strict=True) if one]
    group = np.repeat(np.arange(len(windows)), [len(p) for p in windows])
    return fit_calibration(np.concatenate(windows), group, labels[chosen], weight[chosen])


def may_sound(kind: str, surroundings: str) -> bool:
    """Whether a kind of sound may occur in some surroundings.

    Parameters
    ----------
    kind : str
        Name of a synthetic background sound, or a file name that contains a kind.
    surroundings : str
        One of `noise.base.labels.SURROUNDINGS`.

    Examples
    --------
    >>> may_sound("dog", "car"), may_sound("001_Dogbark_1-59513", "rig"), may_sound("horn", "car")
    (False, False, True)
    """
    kind = kind.lower()
    if surroundings == "any":
        return True
    if kind in BACKGROUND_SOUNDS:
        return surroundings in BACKGROUND_SOUNDS[kind]["surroundings"]
    elsewhere = tuple(
        word
        for name, row in BACKGROUND_SOUNDS.items()
        if surroundings not in row["surroundings"]
        for word in (name.partition("_")[0], *row.get("also", ()))
    )
    return not any(word.startswith(elsewhere) for word in (kind, *re.split(r"[^a-z]+", kind)))


def real_backgrounds(sounds: Sequence[Sample], left_out: LeftOut) -> dict[str, list[Background]]:
    """Return the real background sounds by the surroundings in which they may occur."""
    strangers = [
        (sound.kind, Background(p, int(part)))
        for sound, p, part in zip(sounds, left_out.alone, left_out.part, strict=True)
        if sound.real and LABELS.index(sound.label) >= NOISES
    ]
    return {
        name: [background for kind, background in strangers if may_sound(kind, name)]
        for name in SURROUNDINGS
    }


def _thresholds(
    backgrounds: Mapping[str, Sequence[Background]], surroundings: str, without: int = -1
) -> Thresholds:
    """Return the thresholds for some surroundings by backgrounds of all parts but one.

    Those of a rig alone determine its threshold of a squawk, those of any place all others.
    Backgrounds of the surroundings alone are too few: their thresholds give false names for 11 of
    219 sounds of left-out sources in a car, and for 11 of 175 at a rig; these give 4 and 5.
    """
    creak, squawk, squeal = fit_thresholds(
        [b.probabilities for b in backgrounds["any"] if b.part != without]
    )
    if surroundings == "rig":
        own = [b.probabilities for b in backgrounds["rig"] if b.part != without]
        squawk = fit_thresholds(own)[1]
    return creak, squawk, squeal


def left_out_scores(
    sounds: Sequence[Sample], left_out: LeftOut, thresholds: Mapping[str, Thresholds]
) -> dict[str, object]:
    """Return scores of the left-out sounds for the card of the classifier.

    Parameters
    ----------
    sounds : sequence of Sample
    left_out : LeftOut
        Left-out probabilities of the sounds.
    thresholds : mapping of str to tuple of 3 floats
        Minimum probability of each noise by surroundings [-].

    Returns
    -------
    dict
        For the card.
    """
    card: dict[str, object] = {}
    for name, votes in (("pressure", left_out.alone), ("three_channels", left_out.together)):
        voted = [(s, p) for s, p in zip(sounds, votes, strict=True) if p is not None and not s.real]
        if voted:
            card[f"{name}_kinds_left_out"] = _scores(voted)
    recall = {}
    for k, label in enumerate(LABELS[:NOISES]):
        right = [
            named_as(p, thresholds["any"]) == k
            for s, p in zip(sounds, left_out.alone, strict=True)
            if s.real and s.label == label and not s.varied
        ]
        if right:
            recall[label] = {"n": len(right), "recall": round(float(np.mean(right)), 4)}
    backgrounds = real_backgrounds(sounds, left_out)
    return card | {
        "real_sources_left_out": recall,
        "false_names": {
            name: false_name_rates(
                of_place,
                {k: _thresholds(backgrounds, name, k) for k in {b.part for b in of_place}},
                (0.5, 1.0, 2.0, 4.0),
            )
            for name, of_place in backgrounds.items()
            if of_place
        },
    }


def _scores(voted: Sequence[tuple[Sample, Array]]) -> dict[str, float]:
    """Return scores of sounds, each with the probabilities of its windows."""
    from sklearn.metrics import f1_score

    p = np.concatenate([_clearest(of_windows) for _, of_windows in voted])
    y = columns_of_labels([sample for sample, _ in voted])
    names, certainty = p.argmax(axis=1), p.max(axis=1)
    right, bins = names == y, np.minimum((10.0 * certainty).astype(int), 9)
    gaps = [
        np.mean(bins == b) * abs(np.mean(right[bins == b]) - np.mean(certainty[bins == b]))
        for b in np.unique(bins)
    ]
    others = names[y == LABELS.index("unknown")]
    scores = {
        "n": y.size,
        "accuracy": np.mean(right),
        "macro_f1": f1_score(y, names, average="macro", zero_division=0.0),
        "expected_calibration_error": np.sum(gaps),
        "strangers_named": np.mean(others < NOISES) if others.size else 0.0,
    }
    return {name: round(float(score), 4) for name, score in scores.items()}


def named_as(p: Array, thresholds: Sequence[float]) -> int:
    """Return the label of a recording as a column of `LABELS`.

    Parameters
    ----------
    p : ndarray, shape (n_windows, 5)
        Probabilities of its windows [-].
    thresholds : sequence of 3 floats
        Minimum probability of each noise [-].
    """
    return int(named(_clearest(p), thresholds)[0])


def _clearest(p: Array) -> Array:
    return clearest(p, np.zeros(len(p), dtype=np.intp))


def fit_calibration(
    votes: Array, group: NDArray[np.intp], y: NDArray[np.int64], weight: Array | None = None
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

    def calibration(x: Array) -> Calibration:
        return Calibration(float(np.exp(x[0])), tuple(np.exp(x[1:]).tolist()))

    def loss(x: Array) -> float:
        p = clearest(calibration(x)(votes), group)[rows, y]
        return float(np.average(-np.log(p), weights=weight) + 20.0 / y.size * np.mean(x**2))

    bounds = [(-2.0, 2.0)] * (labels + 1)
    return calibration(minimize(loss, np.zeros(labels + 1), method="L-BFGS-B", bounds=bounds).x)


def fit_thresholds(backgrounds: Sequence[Array]) -> tuple[float, float, float]:
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
    limits = np.append(np.arange(0.25, 0.97, 0.01), 0.97)
    low, high = np.zeros(NOISES, dtype=int), np.full(NOISES, limits.size - 1)
    while (low < high).any():  # bisection: higher thresholds give fewer names
        middle = (low + high) // 2
        few = false_names(backgrounds, limits[middle]) <= most
        low, high = np.where(few, low, np.minimum(middle + 1, high)), np.where(few, middle, high)
    creak, squawk, squeal = limits[low].tolist()
    return creak, squawk, squeal


def false_names(backgrounds: Sequence[Array], thresholds: Sequence[float]) -> Array:
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


class Background(NamedTuple):
    """Left-out probabilities of a real background sound.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]
    part : int
        Part of the cross-fitting.
    """

    probabilities: Array
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
