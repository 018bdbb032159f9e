"""Rows of features that trees are grown of: every sound under several masks of its channels.

The classifier has to work with whatever channels there are, so each recording of three channels is
learned several times, with some of them masked.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.base.labels import LABELS
from noise.classifier.model import has_more_than_sound
from noise.labels.windows import FEATURE_NAMES

if TYPE_CHECKING:
    from noise.training.classifier.described_samples import Sample
    from noise.training.classifier.own_samples import OwnSample


KINDS = ("pressure", "acceleration", "torque")
SUBSETS = (
    ("pressure",),
    KINDS,
    ("pressure", "acceleration"),
    ("pressure", "torque"),
    ("acceleration", "torque"),
    ("acceleration",),
    ("torque",),
)
"""Which channels are left of three; what is most often measured comes first."""

_SELDOM = 0.4
"""How much the other subsets count."""


def masked_rows(
    sounds: Sequence[Sample | OwnSample],
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float64], NDArray[np.intp]]:
    """Rows of all sounds under several masks.

    Parameters
    ----------
    sounds : sequence of Sample or OwnSample

    Returns
    -------
    features : ndarray of float32, shape (n_rows, n_features)
        Of windows, by `noise.labels.windows.FEATURE_NAMES` [unit of each feature].
    labels : ndarray of int, shape (n_rows,)
        Columns of `LABELS`.
    weights : ndarray, shape (n_rows,)
        How much each counts [-].
    owners : ndarray of int, shape (n_rows,)
        Which of the sounds each is of.
    """
    rows, labels, weights, owners = [], [], [], []
    for i, sound in enumerate(sounds):
        several = has_more_than_sound(sound.features, FEATURE_NAMES).any()
        for kinds in SUBSETS if several else SUBSETS[:1]:
            n = len(sound.features)
            rows.append(mask(sound.features, kinds))
            labels += [LABELS.index(sound.label)] * n
            share = 1.0 if kinds in SUBSETS[:2] else _SELDOM
            weights += [share * sound.weight / n] * n
            owners += [i] * n
    return np.concatenate(rows), np.array(labels), np.array(weights), np.array(owners)


def mask(features: NDArray[np.float32], kinds: tuple[str, ...]) -> NDArray[np.float32]:
    """Return features with those of other kinds of channel than `kinds` missing.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `noise.labels.windows.FEATURE_NAMES` [unit of each feature].
    kinds : tuple of str

    Returns
    -------
    ndarray of float32, shape (n_windows, n_features)
        [unit of each feature]
    """
    kept = [name.partition("_")[0] in kinds for name in FEATURE_NAMES]
    return np.where(kept, features, np.float32(np.nan))


def columns_of_labels(sounds: Sequence[Sample | OwnSample]) -> NDArray[np.int64]:
    """Return the columns of `LABELS` that sounds belong to.

    Parameters
    ----------
    sounds : sequence of Sample or OwnSample

    Returns
    -------
    ndarray of int, shape (n_sounds,)
    """
    return np.array([LABELS.index(sound.label) for sound in sounds], dtype=np.int64)
