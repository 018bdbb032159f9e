"""Corrections by the order of the app against as many at random, learned from as the app does."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import repeat
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed, dump, load

from noise.app.labels.next_check import NextCheck
from noise.app.labels.segment_features import mean_features
from noise.base.label_names import LABELS
from noise.batch import Job
from noise.labels import classified, segments
from noise.labels.label_display import naming_row
from noise.labels.labelling import segment_cells
from noise.labels.windows import Described, Page
from noise.training.classifier import cross_fitting
from noise.training.classifier.described_samples import draw_sample
from noise.training.classifier.masked_rows import mask
from noise.training.classifier.own_samples import OwnSample

__all__ = [
    "at_random",
    "by_next_to_check",
    "errors",
    "labels_of",
    "learned",
    "rounds",
    "said",
    "simulated",
    "sound_alone",
]

_MADE_UP = 0.6
_WEIGHT = 4.0
"""Of a real background that is known at the start, as of those that are stored."""


def simulated(keep: Path, n: int):
    """Draw what `noise.training.classifier.fit.train` draws, or take it from where it was kept."""
    if keep.is_file():
        return load(keep)
    made_up = round(_MADE_UP * n)
    seeds = [*np.random.SeedSequence((0, 1)).spawn(made_up), *np.random.SeedSequence(0).spawn(n)]
    drawn = Parallel(n_jobs=-1)(
        delayed(draw_sample)(seed, bushings=i >= made_up) for i, seed in enumerate(seeds)
    )
    dump(drawn, keep)
    return drawn


def sound_alone(samples):
    """Return samples without other channels than sound, which the folders do not have."""
    kept = [replace(one, features=mask(one.features, ("pressure",))) for one in samples]
    return [one for one in kept if np.isfinite(one.features).any()]


@contextmanager
def rounds(n: int):
    """Grow so many trees of each label, instead of as many as `train` does."""
    before, cross_fitting._N_ROUNDS = cross_fitting._N_ROUNDS, n
    try:
        yield
    finally:
        cross_fitting._N_ROUNDS = before


def learned(samples, known, corrected, start=None):
    """Return the classifier that ``train --add`` makes of samples, backgrounds and corrections.

    With a start its trees alone are grown anew: calibration and thresholds stay.
    """
    real = [
        OwnSample(clip.described.features[clip.loud], clip.label, clip.source, _WEIGHT)
        for clip in known
    ]
    added = [sample for clip in corrected for sample in clip.correction]
    kept = [sample for sample in samples if not sample.ambiguous]
    sounds = [*kept, *real, *added]
    if start is not None:
        return cross_fitting.with_trees_of(start, sounds, seed=0)
    return cross_fitting.grown(sounds, 0, repeat(None))[0]


class OnePage:
    """A recording that was described before, as its pages would have it."""

    def __init__(self, described: Described) -> None:
        self._described = described
        self.cells = described.cells

    def __iter__(self):
        yield Page(0, self._described.features, self._described.level, self._described.frames)


def labels_of(clips, classifier):
    """Return the rows of each recording, as `label` would write them."""
    described = {id(clip.blocks): clip.described for clip in clips}
    before, classified.Pages = classified.Pages, lambda blocks: OnePage(described[id(blocks)])
    try:
        return [
            [
                segment_cells(one) | {"label_source": "classifier"}
                for one in segments._label(clip.blocks, classifier, "all")
            ]
            for clip in clips
        ]
    finally:
        classified.Pages = before


def errors(clips, rows) -> dict[str, float]:
    """Shares of recordings that are named wrongly, and of probability that goes elsewhere.

    ``all`` counts recordings, ``mean`` and ``probability`` are means over the labels, so that a few
    noises among many others count as much as they.
    """
    naming = [naming_row(of_one) for of_one in rows]
    told = list(zip(clips, naming, strict=True))
    wrong = np.array([not clip.right(row["label"]) for clip, row in told])
    elsewhere = np.array(
        [1.0 - sum(row[f"p_{name}"] for name in LABELS if clip.right(name)) for clip, row in told]
    )
    label = np.array([clip.label for clip in clips])
    there = [name for name in LABELS if (label == name).any()]
    each = {name: float(wrong[label == name].mean()) for name in there}
    return {
        "all": float(wrong.mean()),
        "mean": float(np.mean(list(each.values()))),
        "probability": float(np.mean([elsewhere[label == name].mean() for name in there])),
        **each,
    }


class _AllDescribed:
    """What is asked for is known at once, as to somebody who takes seconds to listen."""

    def __init__(self) -> None:
        self._known = {}

    def ask(self, wanted) -> None:
        for one in wanted:
            if one not in self._known:
                self._known[one] = _mean_features(*one)

    def known(self):
        return self._known


@cache
def _mean_features(path, channel, start, end):
    return mean_features(Path(path), channel, start, end)


def said(clip, rows):
    """Return a recording's rows as a person leaves them who says what it is."""
    return [
        row
        | {"label_source": "human"}
        | ({} if clip.right(str(row["label"])) else {"label": clip.label})
        for row in rows
    ]


def by_next_to_check(clips, rows, n: int):
    """Return the recordings that "Next to check" asks for, one after the other."""
    jobs = [Job(i, clip.path, clip.path.name) for i, clip in enumerate(clips)]
    check, rows, found, last = NextCheck(jobs, _AllDescribed()), list(rows), [], None
    while len(found) < n and (last := check.next(rows, last)["id"]) is not None:
        rows[last] = said(clips[last], rows[last])
        found.append(clips[last])
    return found


def at_random(clips, seed: int, n: int):
    """Return recordings at random."""
    order = np.random.default_rng([seed, 4]).permutation(len(clips))
    return [clips[i] for i in order[:n].tolist()]
