"""Training of the classifier: on simulation, made-up background sounds and some real ones.

What a simulated sample is called follows from its physics (`noise.training.classifier.samples`),
never from its features; samples whose name hangs on a bound of the definition are not used. The
classifier has to work with whatever channels there are, so each recording of three channels is
learned several times, with some of them masked.

How probable a name is, and from where on it is said, is not asked of what the trees have seen: the
kinds of body and of background, and the sources of real sounds, are parted into five, and trees
that were grown without one part vote on it. Those votes calibrate, and those votes are scored:
each part by the calibration of the other four. Another set of samples, of kinds that are known, is
scored by the classifier itself.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed

from features.windows.table import HOP, LENGTH
from models.errors import ParameterError
from noise.base.label_names import LABELS
from noise.classifier.model import Classifier, at_sensitivity, has_more_than_sound
from noise.labels.segmentation import NOISES, clearest
from noise.labels.windows import FEATURE_NAMES, describe
from noise.recordings.blocks import RecordingBlocks
from noise.training.classifier.operating_point import (
    false_names,
    fit_calibration,
    fit_threshold,
    scores,
)
from noise.training.classifier.own_samples import N_FOLDS, OwnSample, own_card, parts
from noise.training.classifier.real_sounds import load_real_sounds
from noise.training.classifier.samples import draw, swelling
from noise.training.classifier.surroundings import may_sound
from noise.training.trees import grow_boosted_trees

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from noise.base.trees import BoostedTrees
    from noise.classifier.model import Calibration
    from noise.training.classifier.samples import Drawn

__all__ = ["Sample", "describe_drawn", "draw_sample", "learn", "named", "train"]

N_TRAINING = 4300
"""Samples that are learned from."""

_MADE_UP = 0.6
"""So many sounds that are no bushing's are learned beside each sample: they cost little."""

N_TEST = 480
"""Samples that are scored."""

N_ROUNDS = 220

_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.2
"""How far a window may reach beyond the time for which the label holds [s]."""

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
"""Which channels are left of three; what is most often measured comes first."""

_SENSITIVITIES = (0.5, 1.0, 2.0, 4.0)
"""For which false names are counted [ratio of odds]."""

_SELDOM = 0.4
"""How much the other subsets count."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One training sample.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the windows in which the label holds, by `noise.labels.windows.FEATURE_NAMES`
        [unit of each feature].
    label : str
    ambiguous : bool
        Whether the label hangs on a bound of its definition.
    name : str
        Kind of body or of background, one of `noise.training.classifier.samples.SOURCES`.
    """

    features: NDArray[np.float32]
    label: str
    ambiguous: bool
    name: str = ""
    weight = 1.0


def train(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    n_test: int = N_TEST,
    added: Sequence[OwnSample] = (),
    surroundings: str = "any",
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None = None,
) -> Classifier:
    """Train a classifier; the same seed gives the same classifier.

    Parameters
    ----------
    seed : int
    n_training, n_test : int
        Samples to learn from and to score.
    added : sequence of OwnSample
        Of the user's own recordings, to learn from as well
        (`noise.training.classifier.own_samples`).
    surroundings : str
        What else may sound, of `noise.training.classifier.surroundings.SURROUNDINGS`.
    progress : callable, optional
        ``progress(samples, total)`` passes the samples on and shows how far it is.

    Returns
    -------
    Classifier
        Its card tells the scores on kinds and sources left out, and on kinds that are known.

    Raises
    ------
    ParameterError
        Too few samples to hold every label.

    Examples
    --------
    It takes some fifteen minutes:

    >>> train(seed=1).save("mine.npz")  # doctest: +SKIP
    """
    n_made_up = round(_MADE_UP * n_training)
    total = n_made_up + n_training + n_test
    seeds = np.random.SeedSequence((seed, 1)).spawn(n_made_up)
    seeds += np.random.SeedSequence(seed).spawn(total - n_made_up)
    drawn: Iterable[Sample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_sample)(child, bushings=i >= n_made_up, surroundings=surroundings)
        for i, child in enumerate(seeds)
    )
    samples = list(progress(drawn, total) if progress else drawn)
    real = load_real_sounds()
    heard = [
        sample
        for sample, kind in zip(real.samples, real.kinds, strict=True)
        if may_sound(kind, surroundings)
    ]
    card: dict[str, object] = {
        "seed": seed,
        "surroundings": surroundings,
        "real_sounds": _counts(heard),
        "licences": sorted({f"{s.name}: {real.licences[s.name]}" for s in heard}),
    }
    return learn(samples, n_made_up + n_training, seed=seed, real=heard, added=added, card=card)


def draw_sample(
    seed: np.random.SeedSequence, *, bushings: bool = True, surroundings: str = "any"
) -> Sample:
    """Draw one sample and describe the part of it where its label holds.

    It is no simulated bushing unless `bushings`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings, surroundings=surroundings)
    return describe_drawn(swelling(drawn, np.random.default_rng(other)))


def describe_drawn(drawn: Drawn) -> Sample:
    """Describe the windows of a drawn recording in which its label holds and something sounds."""
    found = describe(RecordingBlocks.of(drawn.recording))
    start = np.arange(len(found.features)) * HOP
    outside = np.maximum(drawn.span[0] - start, 0.0) + np.maximum(
        np.minimum(start + LENGTH, drawn.recording.duration) - drawn.span[1], 0.0
    )
    kept = (outside <= _OUTSIDE) & (found.level > found.level.max() - _QUIET_DB)
    kept[np.argmin(outside - 1e-6 * found.level)] |= not kept.any()
    return Sample(found.features[kept], drawn.label, drawn.ambiguous, drawn.source)


def learn(
    samples: Sequence[Sample],
    n_training: int,
    *,
    seed: int,
    real: Sequence[OwnSample] = (),
    added: Sequence[OwnSample] = (),
    card: Mapping[str, object] | None = None,
) -> Classifier:
    """Learn from the first samples and all recorded sounds, and score on the other samples.

    Raises
    ------
    ParameterError
        Too few training samples to hold every label.
    """
    training, test = (
        [sample for sample in some if not sample.ambiguous]
        for some in (samples[:n_training], samples[n_training:])
    )
    found = {sample.label for sample in training}
    absent = ", ".join(label for label in LABELS if label not in found)
    if absent:
        raise ParameterError(f"{n_training} training samples hold no {absent}; draw more of them")
    said: dict[str, object] = {
        **(card or {}),
        "samples": _counts(training),
        "ambiguous": round(float(np.mean([sample.ambiguous for sample in samples])), 4),
    }
    known: list[Sample | OwnSample] = [*training, *real]
    classifier, left_out = _grown([*known, *added], seed)
    said |= _left_out_scores([*known, *added], left_out, classifier.threshold)
    if added:
        without, _ = _grown(known, seed)
        before = [
            named(without.predict_proba(_mask(s.features, _KINDS)[:, _columns(without)]), without)
            for s in added
        ]
        after = [named(p, classifier) for p in left_out.alone[-len(added) :]]
        said["own"] = own_card(added, np.array(before), np.array(after))
    for name, kinds in (("pressure", _SUBSETS[0]), ("three_channels", _SUBSETS[1])):
        scored = _masked(test, kinds)
        if scored:
            x, group = _windows(scored)
            p = clearest(classifier.predict_proba(x[:, _columns(classifier)]), group)
            said[name] = scores(p, _labels(scored), LABELS.index("unknown"))
    return replace(classifier, card=said)


@dataclass(frozen=True, eq=False)
class _LeftOut:
    """Probabilities of each sound's windows by trees and a calibration that knew none of its part.

    `alone` by its sound alone; `together` with its other channels, None where it has none.
    """

    alone: list[NDArray[np.float64]]
    together: list[NDArray[np.float64] | None]


def _grown(sounds: Sequence[Sample | OwnSample], seed: int) -> tuple[Classifier, _LeftOut]:
    """Grow trees, calibrate them by trees that knew other kinds alone, and find the threshold."""
    part = parts([_source(s, i) for i, s in enumerate(sounds)], [s.label for s in sounds], seed)
    x, y, weight, owner = _masked_rows(sounds)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(x).any(axis=0))
    x = x[:, known]

    def trees_of(rows: NDArray[np.bool_]) -> BoostedTrees:
        held, called, counts = x[rows], y[rows], weight[rows]
        # Bins need one value at least of what none of these has, and trees one row of each label.
        held[0, ~np.isfinite(held).any(axis=0)] = 0.0
        absent = np.setdiff1d(np.arange(len(LABELS)), called)
        counts = counts / np.bincount(called, counts, len(LABELS))[called]
        held = np.concatenate([held, np.repeat(held[:1], absent.size, axis=0)])
        called = np.concatenate([called, absent])
        counts = np.concatenate([counts, np.full(absent.size, 1e-9)])
        return grow_boosted_trees(
            held, called, weight=counts / counts.mean(), n_rounds=N_ROUNDS, seed=seed
        )

    alone: list[NDArray[np.float64]] = [np.empty(0)] * len(sounds)
    together: list[NDArray[np.float64] | None] = [None] * len(sounds)
    for k in range(N_FOLDS):
        trees = trees_of(part[owner] != k)
        for i in np.flatnonzero(part == k).tolist():
            features = sounds[i].features
            kinds = _SUBSETS[0] if isinstance(sounds[i], Sample) else _KINDS
            alone[i] = trees.probabilities(_mask(features, kinds)[:, known])
            if has_more_than_sound(features, FEATURE_NAMES).any():
                together[i] = trees.probabilities(features[:, known])
    labels = _labels(sounds)
    heavy = np.array([s.weight for s in sounds])
    several = np.array([p is not None for p in together])
    calibrations, calibrated = [], []
    for votes, held in ((alone, np.ones(len(sounds), dtype=bool)), (together, several)):
        held = held if held.any() else np.ones(len(sounds), dtype=bool)
        voted = [p if p is not None else alone[i] for i, p in enumerate(votes)]
        calibrations.append(_calibration(voted, labels, heavy, np.flatnonzero(held)))
        without = [
            _calibration(voted, labels, heavy, np.flatnonzero(held & (part != k)))
            for k in range(N_FOLDS)
        ]
        calibrated.append([without[part[i]](p) for i, p in enumerate(voted)])
    left_out = _LeftOut(
        calibrated[0], [p if s else None for p, s in zip(calibrated[1], several, strict=True)]
    )
    threshold = fit_threshold(_real_backgrounds(sounds, left_out))
    names = tuple(name for name, k in zip(FEATURE_NAMES, known, strict=True) if k)
    trees = trees_of(np.ones(y.size, dtype=bool))
    return Classifier(names, trees, (calibrations[0], calibrations[1]), {}, threshold), left_out


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


def _real_backgrounds(
    sounds: Sequence[Sample | OwnSample], left_out: _LeftOut
) -> list[NDArray[np.float64]]:
    return [
        p
        for sound, p in zip(sounds, left_out.alone, strict=True)
        if isinstance(sound, OwnSample) and LABELS.index(sound.label) >= NOISES
    ]


def _left_out_scores(
    sounds: Sequence[Sample | OwnSample], left_out: _LeftOut, threshold: float
) -> dict[str, object]:
    """Scores of kinds and of sources that the trees and the calibration had not known."""
    said: dict[str, object] = {}
    unknown = LABELS.index("unknown")
    for name, votes in (("pressure", left_out.alone), ("three_channels", left_out.together)):
        held = [
            (s, p)
            for s, p in zip(sounds, votes, strict=True)
            if p is not None and isinstance(s, Sample)
        ]
        if held:
            p = np.concatenate([_clearest(p) for _, p in held])
            said[f"{name}_kinds_left_out"] = scores(p, _labels([s for s, _ in held]), unknown)
    heard = [
        (s, p) for s, p in zip(sounds, left_out.alone, strict=True) if isinstance(s, OwnSample)
    ]
    recall = {}
    for label in LABELS[:NOISES]:
        right = [_name(p, threshold) == LABELS.index(label) for s, p in heard if s.label == label]
        if right:
            recall[label] = {"n": len(right), "recall": round(float(np.mean(right)), 4)}
    backgrounds = _real_backgrounds(sounds, left_out)
    if backgrounds:
        said["real_sources_left_out"] = {
            "recall": recall,
            "background_hours": round(sum(map(len, backgrounds)) * HOP / 3600.0, 3),
            "false_names_an_hour": {
                f"{s:g}": round(false_names(backgrounds, at_sensitivity(threshold, s)), 1)
                for s in _SENSITIVITIES
            },
        }
    return said


def named(p: NDArray[np.float64], classifier: Classifier) -> int:
    """Return what a recording's windows are called together, as a column of `LABELS`.

    Parameters
    ----------
    p : ndarray, shape (n_windows, 5)
        Probabilities [-].
    classifier : Classifier
        Whose threshold counts.
    """
    return _name(p, classifier.threshold)


def _name(p: NDArray[np.float64], threshold: float) -> int:
    (whole,) = _clearest(p)
    noise = int(whole[:NOISES].argmax())
    return noise if whole[noise] >= threshold else NOISES + int(whole[NOISES:].argmax())


def _clearest(p: NDArray[np.float64]) -> NDArray[np.float64]:
    return clearest(p, np.zeros(len(p), dtype=np.intp))


def _counts(sounds: Iterable[Sample | OwnSample]) -> dict[str, int]:
    return dict(sorted(Counter(sound.label for sound in sounds).items()))


def _labels(sounds: Sequence[Sample | OwnSample]) -> NDArray[np.int64]:
    return np.array([LABELS.index(sound.label) for sound in sounds], dtype=np.int64)


def _columns(classifier: Classifier) -> list[int]:
    return [FEATURE_NAMES.index(name) for name in classifier.feature_names]


def _masked_rows(
    sounds: Sequence[Sample | OwnSample],
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float64], NDArray[np.intp]]:
    """Windows of all sounds under several masks, their labels and weights, and whose they are."""
    rows, labels, weights, owners = [], [], [], []
    for i, sound in enumerate(sounds):
        several = has_more_than_sound(sound.features, FEATURE_NAMES).any()
        for kinds in _SUBSETS if several else _SUBSETS[:1]:
            n = len(sound.features)
            rows.append(_mask(sound.features, kinds))
            labels += [LABELS.index(sound.label)] * n
            share = 1.0 if kinds in _SUBSETS[:2] else _SELDOM
            weights += [share * sound.weight / n] * n
            owners += [i] * n
    return np.concatenate(rows), np.array(labels), np.array(weights), np.array(owners)


def _masked(samples: Sequence[Sample], kinds: tuple[str, ...]) -> list[Sample]:
    """Return the samples that have these channels, with no others."""
    return [
        replace(sample, features=_mask(sample.features, kinds))
        for sample in samples
        if len(kinds) == 1 or has_more_than_sound(sample.features, FEATURE_NAMES).any()
    ]


def _windows(samples: Sequence[Sample]) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
    """Windows of all samples, and which sample each is of."""
    group = np.repeat(np.arange(len(samples)), [len(s.features) for s in samples])
    return np.concatenate([s.features for s in samples]), group


def _mask(features: NDArray[np.float32], kinds: tuple[str, ...]) -> NDArray[np.float32]:
    kept = [name.partition("_")[0] in kinds for name in FEATURE_NAMES]
    return np.where(kept, features, np.float32(np.nan))
