"""Cross-fitting: what trees say of sounds of kinds and sources that they were grown without.

How probable a name is, and from where on it is said, is not asked of what the trees have seen: the
kinds of body and of background, and the sources of real sounds, are parted into five, and trees
that were grown without one part vote on it. Those votes calibrate, and those votes are scored:
each part by the calibration of the other four.

A few dozen real sounds of friction are lost among thousands of simulated ones, so trees are grown
of the real sounds alone as well, and a share of their log odds is added.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from noise.base.labels import LABELS, SURROUNDINGS
from noise.base.processes import ending_with_parent
from noise.base.trees import BoostedTrees
from noise.classifier.model import Calibration, Classifier, Thresholds, has_more_than_sound
from noise.labels.segmentation import NOISES, clearest, named as labels_named
from noise.labels.windows import FEATURE_NAMES, columns_of
from noise.training.classifier.described_samples import Sample
from noise.training.classifier.masked_rows import (
    KINDS,
    SUBSETS,
    columns_of_labels,
    mask,
    masked_rows,
)
from noise.training.classifier.operating_point import (
    Background,
    false_name_rates,
    fit_calibration,
    fit_thresholds,
    scores,
)
from noise.training.classifier.own_samples import N_FOLDS, OwnSample, parts
from noise.training.classifier.surroundings import may_sound
from noise.training.trees import grow_boosted_trees

_N_ROUNDS, _REAL_ROUNDS = 220, 50
"""Trees a class: of all sounds, and of the real ones alone."""

_REAL_SHARE = 0.3
"""Of the log odds of the real sounds' trees that is added [-]; by sources left out."""

_CHOSEN_BY = {
    "any": ("any", "any", "any"),
    "car": ("any", "any", "any"),
    "rig": ("any", "rig", "any"),
}
"""Backgrounds by which the thresholds of creak, squawk and squeal are chosen for some surroundings.
Few sounds choose badly: of sounds of unseen sources that may be heard there, thresholds chosen by
these alone name 11 of 219 in a car, and 11 of 175 at a rig; those chosen so name 3 and 4."""

_SENSITIVITIES = (0.5, 1.0, 2.0, 4.0)
"""For which false names are counted [ratio of odds]."""


@dataclass(frozen=True, eq=False)
class LeftOut:
    """What trees and a calibration say of each sound that knew none of its part.

    Parameters
    ----------
    alone : list of ndarray, shape (n_windows, 5)
        Probabilities of the windows, by the sound alone [-].
    together : list of ndarray, shape (n_windows, 5)
        The same with its other channels [-]; None where it has none.
    part : ndarray of int, shape (n_sounds,)
        What was left out together.
    """

    alone: list[NDArray[np.float64]]
    together: list[NDArray[np.float64] | None]
    part: NDArray[np.int64]


def grown(
    sounds: Sequence[Sample | OwnSample], seed: int, fits: Iterator[object]
) -> tuple[Classifier, LeftOut]:
    """Grow trees, calibrate them by trees that knew other kinds alone, and find the thresholds.

    Parameters
    ----------
    sounds : sequence of Sample or OwnSample
    seed : int
    fits : iterator
        Gone on with as each fit begins, of which there are `N_FOLDS` and one: a progress bar.

    Returns
    -------
    classifier : Classifier
    left_out : LeftOut
        Of the same sounds.
    """
    part = parts([_source(s, i) for i, s in enumerate(sounds)], [s.label for s in sounds], seed)
    x, y, weight, owner = masked_rows(sounds)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(x).any(axis=0))
    x = x[:, known]
    real = np.array([isinstance(sound, OwnSample) for sound in sounds])[owner]
    grow = ending_with_parent(_summed_trees)
    growing = Parallel(n_jobs=-1, return_as="generator")(
        delayed(grow)(x[rows], y[rows], weight[rows], real[rows], seed, _N_ROUNDS)
        for rows in (part[owner] != k for k in range(N_FOLDS + 1))  # the last has all
    )
    alone: list[NDArray[np.float64]] = [np.empty(0)] * len(sounds)
    together: list[NDArray[np.float64] | None] = [None] * len(sounds)
    for k, trees in enumerate(growing):
        next(fits, None)
        for i in np.flatnonzero(part == k).tolist():
            features = sounds[i].features
            kinds = SUBSETS[0] if isinstance(sounds[i], Sample) else KINDS
            alone[i] = trees.probabilities(mask(features, kinds)[:, known])
            if has_more_than_sound(features, FEATURE_NAMES).any():
                together[i] = trees.probabilities(features[:, known])
    labels = columns_of_labels(sounds)
    heavy = np.array([s.weight for s in sounds])
    counts = np.array([not (isinstance(s, OwnSample) and s.varied) for s in sounds])
    several = np.array([p is not None for p in together])
    calibrations, calibrated = [], []
    for votes, held in ((alone, counts), (together, several & counts)):
        held = held if held.any() else counts
        voted = [p if p is not None else alone[i] for i, p in enumerate(votes)]
        calibrations.append(_calibration(voted, labels, heavy, np.flatnonzero(held)))
        without = [
            _calibration(voted, labels, heavy, np.flatnonzero(held & (part != k)))
            for k in range(N_FOLDS)
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


def with_trees_of(
    classifier: Classifier, sounds: Sequence[Sample | OwnSample], seed: int
) -> Classifier:
    """Return a classifier with trees that were grown of other sounds, all else as it is.

    Parameters
    ----------
    classifier : Classifier
    sounds : sequence of Sample or OwnSample
    seed : int
    """
    x, y, weight, owner = masked_rows(sounds)
    real = np.array([isinstance(sound, OwnSample) for sound in sounds])[owner]
    trees = _summed_trees(x[:, columns_of(classifier)], y, weight, real, seed, _N_ROUNDS)
    return replace(classifier, trees=trees, card={})


def _summed_trees(
    x: NDArray[np.float32],
    y: NDArray[np.int64],
    weight: NDArray[np.float64],
    real: NDArray[np.bool_],
    seed: int,
    n_rounds: int,
) -> BoostedTrees:
    """Grow trees of all rows, and add a share of what trees of the real ones say."""
    trees = _trees(x, y, weight, seed, n_rounds)
    unknown = LABELS.index("unknown")
    known = np.unique(y[real])
    if known.min(initial=unknown) >= NOISES or unknown not in known:
        return trees
    own = _trees(x[real], y[real], weight[real], seed, _REAL_ROUNDS)
    # A label of which there is no real sound is as likely as `unknown`.
    alike = np.where(np.isin(np.arange(len(LABELS)), known), np.arange(len(LABELS)), unknown)
    chosen = [np.flatnonzero(own.classes == k) for k in alike]
    n = len(trees.feature)
    return BoostedTrees(
        roots=np.concatenate([trees.roots, *(own.roots[c] + n for c in chosen)]),
        classes=np.concatenate(
            [trees.classes, np.repeat(np.arange(len(LABELS)), list(map(len, chosen)))]
        ).astype(np.int16),
        feature=np.concatenate([trees.feature, own.feature]),
        threshold=np.concatenate([trees.threshold, own.threshold]),
        children=np.concatenate([trees.children, own.children + np.int32(n)]),
        missing_left=np.concatenate([trees.missing_left, own.missing_left]),
        value=np.concatenate([trees.value, _REAL_SHARE * own.value]),
        base=trees.base + _REAL_SHARE * own.base[alike],
    )


def _trees(
    x: NDArray[np.float32],
    y: NDArray[np.int64],
    weight: NDArray[np.float64],
    seed: int,
    n_rounds: int,
) -> BoostedTrees:
    """Grow trees of rows whose labels are balanced."""
    x = x.copy()
    # Bins need one value at least of what none of these has, and trees one row of each label.
    x[0, ~np.isfinite(x).any(axis=0)] = 0.0
    absent = np.setdiff1d(np.arange(len(LABELS)), y)
    weight = weight / np.bincount(y, weight, len(LABELS))[y]
    x = np.concatenate([x, np.repeat(x[:1], absent.size, axis=0)])
    y = np.concatenate([y, absent])
    weight = np.concatenate([weight, np.full(absent.size, 1e-9)])
    return grow_boosted_trees(x, y, weight=weight / weight.mean(), n_rounds=n_rounds, seed=seed)


def _source(sound: Sample | OwnSample, i: int) -> str:
    """Return what is left out together: a kind of body or background, a source of recordings."""
    return f"{sound.name} {i}" if sound.name in ("bushing", "quiet") else sound.name


def _calibration(
    votes: Sequence[NDArray[np.float64]],
    labels: NDArray[np.int64],
    weight: NDArray[np.float64],
    held: NDArray[np.intp],
) -> Calibration:
    group = np.repeat(np.arange(held.size), [len(votes[i]) for i in held])
    return fit_calibration(
        np.concatenate([votes[i] for i in held]), group, labels[held], weight[held]
    )


def real_backgrounds(
    sounds: Sequence[Sample | OwnSample], left_out: LeftOut
) -> dict[str, list[Background]]:
    """Return the real sounds that are no noise, by the surroundings in which they may be heard.

    Parameters
    ----------
    sounds : sequence of Sample or OwnSample
    left_out : LeftOut
        Of these sounds.
    """
    strangers = [
        (sound.kind, Background(p, int(part)))
        for sound, p, part in zip(sounds, left_out.alone, left_out.part, strict=True)
        if isinstance(sound, OwnSample) and LABELS.index(sound.label) >= NOISES
    ]
    return {
        name: [background for kind, background in strangers if may_sound(kind, name)]
        for name in SURROUNDINGS
    }


def _thresholds(
    backgrounds: Mapping[str, Sequence[Background]], surroundings: str, without: int = -1
) -> Thresholds:
    """Find the thresholds for some surroundings by backgrounds that are not of one part."""
    fitted = {
        name: fit_thresholds([b.probabilities for b in backgrounds[name] if b.part != without])
        for name in set(_CHOSEN_BY[surroundings])
    }
    creak, squawk, squeal = (fitted[n][i] for i, n in enumerate(_CHOSEN_BY[surroundings]))
    return creak, squawk, squeal


def left_out_scores(
    sounds: Sequence[Sample | OwnSample], left_out: LeftOut, thresholds: Mapping[str, Thresholds]
) -> dict[str, object]:
    """Scores of kinds and of sources that the trees and the calibration had not known.

    Parameters
    ----------
    sounds : sequence of Sample or OwnSample
    left_out : LeftOut
        Of these sounds.
    thresholds : mapping of str to tuple of 3 floats
        By surroundings: probability [-] from which each noise is named.

    Returns
    -------
    dict
        For the card.
    """
    said: dict[str, object] = {}
    for name, votes in (("pressure", left_out.alone), ("three_channels", left_out.together)):
        held = [
            (s, p)
            for s, p in zip(sounds, votes, strict=True)
            if p is not None and isinstance(s, Sample)
        ]
        if held:
            said[f"{name}_kinds_left_out"] = _scores(held)
    recall = {}
    for label in LABELS[:NOISES]:
        right = [
            _name(p, thresholds["any"]) == LABELS.index(label)
            for s, p in zip(sounds, left_out.alone, strict=True)
            if isinstance(s, OwnSample) and s.label == label and not s.varied
        ]
        if right:
            recall[label] = {"n": len(right), "recall": round(float(np.mean(right)), 4)}
    said["real_sources_left_out"] = recall
    backgrounds = real_backgrounds(sounds, left_out)
    said["false_names"] = {
        name: false_name_rates(
            found,
            {part: _thresholds(backgrounds, name, part) for part in {b.part for b in found}},
            _SENSITIVITIES,
        )
        for name, found in backgrounds.items()
        if found
    }
    return said


def unlearned_scores(classifier: Classifier, samples: Sequence[Sample]) -> dict[str, object]:
    """Scores of samples that were not learned, by their sound alone and by three channels.

    Parameters
    ----------
    classifier : Classifier
    samples : sequence of Sample

    Returns
    -------
    dict
        For the card.
    """
    columns = columns_of(classifier)
    several = [s for s in samples if has_more_than_sound(s.features, FEATURE_NAMES).any()]
    return {
        name: _scores(
            [(s, classifier.predict_proba(mask(s.features, kinds)[:, columns])) for s in scored]
        )
        for name, kinds, scored in (
            ("pressure", SUBSETS[0], samples),
            ("three_channels", SUBSETS[1], several),
        )
        if scored
    }


def _scores(voted: Sequence[tuple[Sample, NDArray[np.float64]]]) -> dict[str, object]:
    """Scores of samples, each with the probabilities of its windows."""
    p = np.concatenate([_clearest(of_windows) for _, of_windows in voted])
    return scores(p, columns_of_labels([sample for sample, _ in voted]), LABELS.index("unknown"))


def named(p: NDArray[np.float64], classifier: Classifier) -> int:
    """Return what a recording's windows are called together, as a column of `LABELS`.

    Parameters
    ----------
    p : ndarray, shape (n_windows, 5)
        Probabilities [-].
    classifier : Classifier
        Whose thresholds count.
    """
    return _name(p, classifier.thresholds["any"])


def _name(p: NDArray[np.float64], thresholds: Sequence[float]) -> int:
    return int(labels_named(_clearest(p), thresholds)[0])


def _clearest(p: NDArray[np.float64]) -> NDArray[np.float64]:
    return clearest(p, np.zeros(len(p), dtype=np.intp))
