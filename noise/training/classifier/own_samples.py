"""The user's own windows beside the simulated samples: how much they count, and how they score.

A window of one's own counts as five simulated samples: it is rare, and it is what the classifier is
wanted for. A third of the files is held out, never windows of one file on both sides, since windows
of one file are nearly the same sample; on it the classifier is scored with the others and without.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.base.label_names import LABELS
from noise.labels.windows import can_be_described, describe
from noise.recordings.blocks import RecordingBlocks

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from noise.training.classifier.own_recordings import OwnWindow

__all__ = ["OWN_WEIGHT", "OwnSample", "own_card", "own_samples", "split_files"]

OWN_WEIGHT = 5.0
"""Simulated samples that an own window counts as."""

_EVERY = 3
"""One file of so many is held out."""


@dataclass(frozen=True, eq=False)
class OwnSample:
    """What the user's own recordings teach: a window of at most a second.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the windows that the classifier sees in it, by `noise.labels.windows.FEATURE_NAMES`
        [unit of each feature].
    label : str
        One of `noise.classifier.LABELS`.
    name : str
        File that it comes from.
    """

    features: NDArray[np.float32]
    label: str
    name: str


def own_samples(windows: Iterable[OwnWindow]) -> tuple[list[OwnSample], list[str]]:
    """Take the features of windows.

    Returns
    -------
    samples : list of OwnSample
    refusals : list of str
        One line for each file with a window that nothing can be learned from.
    """
    samples: list[OwnSample] = []
    refused: dict[str, str] = {}
    for window in windows:
        blocks = RecordingBlocks.of(window.recording)
        if can_be_described(blocks):
            features = describe(blocks).features
            if np.isfinite(features).any():
                samples.append(OwnSample(features, window.label, window.name))
                continue
        refused.setdefault(window.name, f"{window.name}: has nothing to learn from in it")
    return samples, list(refused.values())


def split_files(samples: Sequence[OwnSample], seed: int) -> tuple[list[OwnSample], list[OwnSample]]:
    """Part the files into those that are learned from and a third that is scored.

    Each label has its share on both sides as far as it goes.

    Examples
    --------
    >>> one = np.zeros((1, 2), dtype=np.float32)
    >>> runs = [OwnSample(one, "creak", f"{run}.wav") for run in range(6) for _ in range(4)]
    >>> learned, held = split_files(runs, seed=0)
    >>> len(learned), len(held), {s.name for s in learned} & {s.name for s in held}
    (16, 8, set())
    """
    rng = np.random.default_rng([seed, 2])
    counts: dict[str, Counter[str]] = {}
    for sample in samples:
        counts.setdefault(sample.name, Counter())[sample.label] += 1
    names = sorted(counts)
    rng.shuffle(names)
    names.sort(key=lambda name: counts[name].most_common(1)[0][0])  # stable: in groups
    held = set(names[_EVERY - 1 :: _EVERY])
    return (
        [sample for sample in samples if sample.name not in held],
        [sample for sample in samples if sample.name in held],
    )


def own_card(
    learned: Sequence[OwnSample],
    held: Sequence[OwnSample],
    before: NDArray[np.float64],
    after: NDArray[np.float64],
) -> dict[str, object]:
    """Return what the card says of the user's recordings.

    Parameters
    ----------
    learned, held : sequence of OwnSample
    before, after : ndarray, shape (n_held, 5)
        Probabilities of those held out from the classifier without the others and with them.
    """
    y = np.array([LABELS.index(sample.label) for sample in held])
    right = [
        round(float(np.mean(p.argmax(axis=1) == y)), 4) if held else None for p in (before, after)
    ]
    return {
        "weight": OWN_WEIGHT,
        "windows": dict(Counter(sample.label for sample in learned)),
        "files": len({sample.name for sample in learned}),
        "held_out_windows": dict(Counter(sample.label for sample in held)),
        "held_out_files": len({sample.name for sample in held}),
        "accuracy_before": right[0],
        "accuracy_after": right[1],
    }
