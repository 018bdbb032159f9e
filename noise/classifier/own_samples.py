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

from features.registry import recording_features
from models.errors import ParameterError
from noise.classifier.model import LABELS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from noise.classifier.own_recordings import OwnWindow

__all__ = ["OWN_WEIGHT", "OwnSample", "as_arrays", "own_card", "own_samples", "split_files"]

OWN_WEIGHT = 5.0
"""Simulated samples that an own window counts as."""

_EVERY = 3
"""One file of so many is held out."""


@dataclass(frozen=True, eq=False)
class OwnSample:
    """Features of a window of the user's, its label, and the file that it comes from."""

    features: Mapping[str, float]
    label: str
    name: str


def own_samples(windows: Iterable[OwnWindow]) -> tuple[list[OwnSample], list[str]]:
    """Take the features of windows.

    Returns
    -------
    samples : list of OwnSample
    refusals : list of str
        One line for each file with a window that can't be analysed.
    """
    samples: list[OwnSample] = []
    refused: dict[str, str] = {}
    for window in windows:
        try:
            features = recording_features(window.recording)
        except ParameterError as error:
            refused.setdefault(window.name, f"{window.name}: {error}")
            continue
        if any(np.isfinite(value) for value in features.values()):
            samples.append(OwnSample(features, window.label, window.name))
        else:
            refused.setdefault(window.name, f"{window.name}: has nothing to learn from in it")
    return samples, list(refused.values())


def split_files(samples: Sequence[OwnSample], seed: int) -> tuple[list[OwnSample], list[OwnSample]]:
    """Part the files into those that are learned from and a third that is scored.

    Each label has its share on both sides as far as it goes.

    Examples
    --------
    >>> runs = [OwnSample({}, "creak", f"{run}.wav") for run in range(6) for _ in range(4)]
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


def as_arrays(
    samples: Sequence[OwnSample], names: Sequence[str]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return features, shape (n, n_names), and labels by their place in `LABELS`.

    Examples
    --------
    >>> x, y = as_arrays([OwnSample({"torque_mean": 3.0}, "squeal", "a.wav")], ["torque_mean"])
    >>> x.tolist(), y.tolist()
    ([[3.0]], [2])
    """
    x = np.array([[s.features.get(name, np.nan) for name in names] for s in samples], dtype=float)
    y = np.array([LABELS.index(sample.label) for sample in samples], dtype=np.int64)
    return x.reshape(len(samples), len(names)), y


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
    _, y = as_arrays(held, ())
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
