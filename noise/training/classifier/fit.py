"""Training of the classifier, on simulation and on made-up background sounds alone.

Three sets that share no draw: one grows the trees, one calibrates its probabilities, and one is
scored and written into the card. What a sample is called follows from its physics
(`noise.training.classifier.samples`), never from its features; samples whose name hangs on a bound
of the definition are in none of the three. The classifier has to work with whatever channels there
are, so each recording of three channels is learned several times, with some of them masked. The
user's own recordings are learned beside the simulated ones, and neither calibrate nor change the
score.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed

from features.windows.table import HOP, LENGTH
from models.errors import ParameterError
from noise.base.label_names import LABELS
from noise.classifier.model import Classifier, has_more_than_sound
from noise.labels.windows import FEATURE_NAMES, describe
from noise.recordings.blocks import RecordingBlocks
from noise.training.classifier.operating_point import fit_calibration, means_of_groups, scores
from noise.training.classifier.own_samples import OWN_WEIGHT, own_card, split_files
from noise.training.classifier.samples import draw, swelling
from noise.training.trees import grow_boosted_trees

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from noise.training.classifier.own_samples import OwnSample
    from noise.training.classifier.samples import Drawn

__all__ = ["Sample", "describe_drawn", "draw_sample", "learn", "train"]

N_TRAINING = 4300
"""Samples that grow the trees."""

_MADE_UP = 0.6
"""So many sounds that are no bushing's are learned beside each sample: they cost little."""

N_CALIBRATION = 600
"""Samples that calibrate its probabilities."""

N_TEST = 480
"""Samples that are scored."""

N_ROUNDS = 220

_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.1
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
    """

    features: NDArray[np.float32]
    label: str
    ambiguous: bool


def train(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    n_calibration: int = N_CALIBRATION,
    n_test: int = N_TEST,
    added: Sequence[OwnSample] = (),
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None = None,
) -> Classifier:
    """Train a classifier; the same seed gives the same classifier.

    Parameters
    ----------
    seed : int
    n_training, n_calibration, n_test : int
        Samples to learn from, to calibrate on and to score.
    added : sequence of OwnSample
        Of the user's own recordings, to learn from as well
        (`noise.training.classifier.own_samples`).
    progress : callable, optional
        ``progress(samples, total)`` passes the samples on and shows how far it is.

    Returns
    -------
    Classifier
        Its card tells the scores on the last of the three sets and, where recordings were added,
        on those of them that were held out.

    Raises
    ------
    ParameterError
        Too few samples to hold every label.

    Examples
    --------
    It takes some ten minutes:

    >>> train(seed=1).save("mine.npz")  # doctest: +SKIP
    """
    n_made_up = round(_MADE_UP * n_training)
    total = n_made_up + n_training + n_calibration + n_test
    seeds = np.random.SeedSequence((seed, 1)).spawn(n_made_up)
    seeds += np.random.SeedSequence(seed).spawn(total - n_made_up)
    drawn: Iterable[Sample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_sample)(child, bushings=i >= n_made_up) for i, child in enumerate(seeds)
    )
    samples = list(progress(drawn, total) if progress else drawn)
    return learn(samples, n_made_up + n_training, n_calibration, seed=seed, added=added)


def draw_sample(seed: np.random.SeedSequence, *, bushings: bool = True) -> Sample:
    """Draw one sample and describe the part of it where its label holds.

    It is no simulated bushing unless `bushings`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings)
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
    return Sample(found.features[kept], drawn.label, drawn.ambiguous)


def learn(
    samples: Sequence[Sample],
    n_training: int,
    n_calibration: int,
    *,
    seed: int,
    added: Sequence[OwnSample] = (),
) -> Classifier:
    """Learn from the first samples, calibrate on the next, and score on what is left.

    Raises
    ------
    ParameterError
        Too few training samples to hold every label.
    """
    found = {sample.label for sample in samples[:n_training]}
    absent = ", ".join(label for label in LABELS if label not in found)
    if absent:
        raise ParameterError(f"{n_training} training samples hold no {absent}; draw more of them")
    limits = (0, n_training, n_training + n_calibration, len(samples))
    training, calibration, test = (
        [sample for sample in samples[first:last] if not sample.ambiguous]
        for first, last in pairwise(limits)
    )
    card: dict[str, object] = {
        "seed": seed,
        "samples": dict(sorted(Counter(sample.label for sample in training).items())),
        "ambiguous": round(float(np.mean([sample.ambiguous for sample in samples])), 4),
    }
    classifier = _grown(training, (), calibration, seed)
    if added:
        learned, held = split_files(added, seed)
        without, classifier = classifier, _grown(training, learned, calibration, seed)
        before, after = (_of_recordings(c, held) for c in (without, classifier))
        card["own"] = own_card(learned, held, before, after)
    for name, kinds in (("pressure", _SUBSETS[0]), ("three_channels", _SUBSETS[1])):
        scored = _masked(test, kinds)
        if scored:
            y = np.array([LABELS.index(sample.label) for sample in scored])
            card[name] = scores(_of_recordings(classifier, scored), y, LABELS.index("unknown"))
    return replace(classifier, card=card)


def _grown(
    training: Sequence[Sample], own: Sequence[OwnSample], calibration: Sequence[Sample], seed: int
) -> Classifier:
    """Grow trees and calibrate them."""
    x, y, weight = _masked_rows(training, own)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(x).any(axis=0))
    names = tuple(name for name, k in zip(FEATURE_NAMES, known, strict=True) if k)
    trees = grow_boosted_trees(x[:, known], y, weight=weight, n_rounds=N_ROUNDS, seed=seed)
    calibrations = []
    for kinds in _SUBSETS[:2]:
        kept = _masked(calibration, kinds)
        x, group = _windows(kept)
        labels = np.array([LABELS.index(sample.label) for sample in kept], dtype=np.int64)
        votes = trees.probabilities(x[:, known])
        calibrations.append(fit_calibration(votes, group, labels, LABELS.index("unknown")))
    return Classifier(names, trees, (calibrations[0], calibrations[1]), {})


def _masked_rows(
    samples: Sequence[Sample], own: Sequence[OwnSample]
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float64]]:
    """Windows of all samples under several masks, their labels, and weights of balanced labels."""
    rows, labels, weights = [], [], []
    everything: tuple[Sample | OwnSample, ...] = (*samples, *own)
    for sample in everything:
        several = has_more_than_sound(sample.features, FEATURE_NAMES).any()
        counts = 1.0 if isinstance(sample, Sample) else OWN_WEIGHT
        for kinds in _SUBSETS if several else _SUBSETS[:1]:
            n = len(sample.features)
            rows.append(_mask(sample.features, kinds))
            labels += [LABELS.index(sample.label)] * n
            share = 1.0 if kinds in _SUBSETS[:2] else _SELDOM
            weights += [share * counts / n] * n
    y, weight = np.array(labels), np.array(weights)
    weight /= np.bincount(y, weight)[y]
    return np.concatenate(rows), y, weight / weight.mean()


def _masked(samples: Sequence[Sample], kinds: tuple[str, ...]) -> list[Sample]:
    """Return the samples that have these channels, with no others."""
    return [
        replace(sample, features=_mask(sample.features, kinds))
        for sample in samples
        if len(kinds) == 1 or has_more_than_sound(sample.features, FEATURE_NAMES).any()
    ]


def _of_recordings(
    classifier: Classifier, samples: Sequence[Sample] | Sequence[OwnSample]
) -> NDArray[np.float64]:
    """Mean probabilities of each sample's windows, shape (n_samples, 5)."""
    if not samples:
        return np.empty((0, len(LABELS)))
    x, group = _windows(samples)
    columns = [FEATURE_NAMES.index(name) for name in classifier.feature_names]
    return means_of_groups(classifier.predict_proba(x[:, columns]), group)


def _windows(
    samples: Sequence[Sample] | Sequence[OwnSample],
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Windows of all samples, and which sample each is of."""
    none = np.empty((0, len(FEATURE_NAMES)), dtype=np.float32)
    group = np.repeat(np.arange(len(samples)), [len(s.features) for s in samples])
    return np.concatenate([none, *(s.features for s in samples)]), group


def _mask(features: NDArray[np.float32], kinds: tuple[str, ...]) -> NDArray[np.float32]:
    kept = [name.partition("_")[0] in kinds for name in FEATURE_NAMES]
    return np.where(kept, features, np.float32(np.nan))
