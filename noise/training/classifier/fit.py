"""Training of the classifier: on simulation, made-up background sounds and some real ones.

What a simulated sample is called follows from its physics (`noise.training.classifier.samples`),
never from its features; samples whose name hangs on a bound of the definition are not used. What
calibrates, and what is scored, was left out of what the trees were grown of
(`noise.training.classifier.cross_fitting`). Another set of samples, of kinds that are known, is
scored by the classifier itself.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed

from models.errors import ParameterError
from noise.base.labels import LABELS
from noise.batch.pool import ending_with_this
from noise.classifier.model import Classifier
from noise.labels.segmentation import clearest
from noise.labels.windows import columns_of
from noise.training.classifier.cross_fitting import grown, left_out_scores, named, with_trees_of
from noise.training.classifier.described_samples import Sample, draw_sample
from noise.training.classifier.kept_samples import load_samples, save_samples
from noise.training.classifier.masked_rows import (
    KINDS,
    SUBSETS,
    columns_of_labels,
    mask,
    masked,
    windows_of,
)
from noise.training.classifier.operating_point import scores
from noise.training.classifier.own_samples import N_FOLDS, OwnSample, own_card
from noise.training.classifier.real_sounds import load_real_sounds
from noise.training.classifier.surroundings import may_sound

N_TRAINING = 4300
"""Samples that are learned from."""

_MADE_UP = 0.6
"""So many sounds that are no bushing's are learned beside each sample: they cost little."""

N_TEST = 480
"""Samples that are scored."""


def train(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    n_test: int = N_TEST,
    added: Sequence[OwnSample] = (),
    surroundings: str = "any",
    keep: Path | None = None,
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None = None,
    growing: Callable[[Iterable[int], int], Iterable[int]] | None = None,
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
    keep : Path, optional
        File that keeps the simulated samples (`noise.training.classifier.kept_samples`): they are
        taken from it where it holds those of the same call by the same program.
    progress : callable, optional
        ``progress(samples, total)`` passes the samples on and shows how far it is.
    growing : callable, optional
        The same of the fits of trees, which take some minutes.

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
    call = (seed, n_training, n_test, surroundings)
    samples = None if keep is None else load_samples(keep, call)
    if samples is None:
        samples = _drawn(seed, n_made_up, total, surroundings, progress)
        if keep is not None:
            save_samples(keep, call, samples)
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
    return learn(
        samples,
        n_made_up + n_training,
        seed=seed,
        real=heard,
        added=added,
        card=card,
        growing=growing,
    )


def _drawn(
    seed: int,
    n_made_up: int,
    total: int,
    surroundings: str,
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None,
) -> list[Sample]:
    seeds = np.random.SeedSequence((seed, 1)).spawn(n_made_up)
    seeds += np.random.SeedSequence(seed).spawn(total - n_made_up)
    draw = ending_with_this(draw_sample)
    drawn: Iterable[Sample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw)(seeds[i], bushings=i >= n_made_up, surroundings=surroundings)
        for i in range(total)
    )
    return list(progress(drawn, total) if progress else drawn)


def learn(
    samples: Sequence[Sample],
    n_training: int,
    *,
    seed: int,
    real: Sequence[OwnSample] = (),
    added: Sequence[OwnSample] = (),
    card: Mapping[str, object] | None = None,
    growing: Callable[[Iterable[int], int], Iterable[int]] | None = None,
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
    n_fits = N_FOLDS + 1 + bool(added)
    fits = iter(growing(range(n_fits), n_fits) if growing else range(n_fits))
    classifier, left_out = grown([*known, *added], seed, fits)
    said |= left_out_scores([*known, *added], left_out, classifier.thresholds)
    if added:
        next(fits, None)
        without = with_trees_of(classifier, known, seed)
        before = [
            named(without.predict_proba(mask(s.features, KINDS)[:, columns_of(without)]), without)
            for s in added
        ]
        after = [named(p, classifier) for p in left_out.alone[-len(added) :]]
        said["own"] = own_card(added, np.array(before), np.array(after))
    next(fits, None)  # the bar is at its end
    for name, kinds in (("pressure", SUBSETS[0]), ("three_channels", SUBSETS[1])):
        scored = masked(test, kinds)
        if scored:
            x, group = windows_of(scored)
            p = clearest(classifier.predict_proba(x[:, columns_of(classifier)]), group)
            said[name] = scores(p, columns_of_labels(scored), LABELS.index("unknown"))
    return replace(classifier, card=said)


def _counts(sounds: Iterable[Sample | OwnSample]) -> dict[str, int]:
    return dict(sorted(Counter(sound.label for sound in sounds).items()))
