"""Samples to learn from: what was drawn, described where its label holds and something sounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from features.windows.table import HOP, LENGTH
from models.blocks import RecordingBlocks
from noise.labels.windows import describe
from noise.training.classifier.samples import Drawn, draw, swelling

_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.2
"""How far a window may reach beyond the time for which the label holds [s]."""


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
