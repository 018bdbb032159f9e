"""Recorded sounds beside the simulated ones: what they are, and what is left out together.

The user's own windows are such sounds, and those that are stored with the program
(`noise.training.classifier.fit`). Each counts as several simulated samples: it is rare, and
it is what the classifier is wanted for. All of them are learned from, and all of them are scored,
by trees that were grown without any sound of the same source.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from noise.base.labels import LABELS
from noise.labels.segmentation import NOISES
from noise.labels.windows import has_window_channel, window_features

if TYPE_CHECKING:
    from noise.training.classifier.own_recordings import OwnWindow


OWN_WEIGHT = 5.0
"""Simulated samples that an own window counts as."""

N_FOLDS = 5
"""Parts, each of which is left out once."""

TOO_FEW = 5
"""Fewer sources of a label tell nothing of how well it is known."""


@dataclass(frozen=True, eq=False)
class OwnSample:
    """A recorded sound to learn from: of the user's a window of at most a second.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the windows that the classifier sees in it, by `noise.labels.windows.FEATURE_NAMES`
        [unit of each feature].
    label : str
        One of `noise.classifier.LABELS`.
    name : str
        Source that it comes from, of the user's the file; sounds of one source are left out
        together.
    weight : float
        Simulated samples that it counts as [-].
    kind : str
        What sounds, as its file is called; empty where it may sound anywhere.
    varied : bool
        Whether it is a variation of another sound, by which nothing is calibrated or scored.
    """

    features: NDArray[np.float32]
    label: str
    name: str
    weight: float = OWN_WEIGHT
    kind: str = ""
    varied: bool = False


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
        if has_window_channel(blocks):
            features = window_features(blocks).features
            if np.isfinite(features).any():
                samples.append(OwnSample(features, window.label, window.name))
                continue
        refused.setdefault(window.name, f"{window.name}: has nothing to learn from in it")
    return samples, list(refused.values())


def parts(names: Sequence[str], labels: Sequence[str], seed: int) -> NDArray[np.int64]:
    """Part sounds into `N_FOLDS`, sounds of one source together and each label spread over them.

    Parameters
    ----------
    names, labels : sequence of str
        Source and label of each sound.
    seed : int

    Returns
    -------
    ndarray of int, shape (n_sounds,)
        Part of each.

    Examples
    --------
    >>> parts(["a", "a", "b", "c"], ["creak", "creak", "creak", "none"], seed=0).tolist()
    [1, 1, 0, 2]
    """
    counts: dict[str, Counter[str]] = {}
    for name, label in zip(names, labels, strict=True):
        counts.setdefault(name, Counter())[label] += 1
    sources = sorted(counts)
    np.random.default_rng([seed, 2]).shuffle(sources)
    sources.sort(key=lambda name: counts[name].most_common(1)[0][0])  # stable: in groups
    part = {name: i % N_FOLDS for i, name in enumerate(sources)}
    return np.array([part[name] for name in names], dtype=np.int64)


def own_card(
    samples: Sequence[OwnSample], before: NDArray[np.intp], after: NDArray[np.intp]
) -> dict[str, object]:
    """Return what the card says of the user's recordings.

    Parameters
    ----------
    samples : sequence of OwnSample
    before, after : ndarray of int, shape (n_samples,)
        Columns of their labels by trees that were grown without any of the user's recordings, and
        by trees that were grown without those of the same part. Calibration and thresholds are the
        new ones for both.
    """
    y = np.array([LABELS.index(sample.label) for sample in samples])
    files = [{s.name for s in samples if s.label == label} for label in LABELS]
    labels = {
        label: {
            "files": len(files[i]),
            "windows": int(np.sum(y == i)),
            "enough": len(files[i]) >= TOO_FEW,
            "recall_before": _share(before[y == i] == i),
            "recall": _share(after[y == i] == i),
            "false_names_before": int(np.sum((before == i) & (y != i))),
            "false_names": int(np.sum((after == i) & (y != i))),
        }
        for i, label in enumerate(LABELS)
        if files[i] or np.any(after == i)
    }
    return {
        "weight": OWN_WEIGHT,
        "files": len({sample.name for sample in samples}),
        "noises": int(np.sum(y < NOISES)),
        "labels": labels,
    }


def _share(right: NDArray[np.bool_]) -> float | None:
    return round(float(np.mean(right)), 4) if right.size else None
