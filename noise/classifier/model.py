"""Classifier that gives the probabilities of the five labels from features of windows.

The shipped one (``data/classifier.npz``) is trained on simulation and some real sounds by
`noise.training.classifier.fit`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.show import short_repr
from noise.base.labels import LABELS, SURROUNDINGS
from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import BoostedTrees

CLASSIFIER = ModelKind(
    "classifier", 6, "bushing-noise train --out", ("noise.classifier", "classifier.npz")
)

Thresholds = tuple[float, float, float]
"""Minimum probabilities of creak, squawk and squeal [-]."""

_FLOOR = 1e-3
"""Share added to the votes, the resolution of a few hundred trees [-]."""


@dataclass(frozen=True)
class Calibration:
    """Calibration from votes of trees to probabilities.

    Parameters
    ----------
    sharpness : float
        Exponent; above 1, probabilities are more extreme [-].
    weights : tuple of float
        Weights of the labels [-].

    Examples
    --------
    >>> Calibration(2.0, (1.0, 1.0, 1.0))(np.array([[0.5, 0.25, 0.25]])).round(2).tolist()
    [[0.67, 0.17, 0.17]]
    """

    sharpness: float
    weights: tuple[float, ...]

    def __call__(self, votes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return probabilities; each row sums to 1."""
        p = (votes + _FLOOR) ** self.sharpness * np.array(self.weights)
        return np.asarray(p / p.sum(axis=1, keepdims=True))


@short_repr
@dataclass(frozen=True, eq=False)
class Classifier:
    """Boosted trees over named features, with calibrated probabilities.

    Parameters
    ----------
    feature_names : tuple of str
        Features of the trees, a subset of `noise.labels.windows.FEATURE_NAMES`.
    trees : BoostedTrees
    calibrations : pair of Calibration
        For sound alone, and for sound with other channels.
    card : mapping
        Summary of the training: seed, counts, scores.
    thresholds : mapping of str to tuple of 3 floats
        By `noise.base.labels.SURROUNDINGS`: minimum probabilities of creak, squawk and squeal [-];
        below them the label is ``unknown``.

    Examples
    --------
    >>> shipped = load_classifier()
    >>> missing = np.full((1, len(shipped.feature_names)), np.nan, dtype=np.float32)
    >>> float(shipped.predict_proba(missing).sum().round(6))
    1.0
    """

    feature_names: tuple[str, ...]
    trees: BoostedTrees
    calibrations: tuple[Calibration, Calibration]
    card: Mapping[str, object]
    thresholds: Mapping[str, Thresholds] = field(
        default_factory=lambda: dict.fromkeys(SURROUNDINGS, (0.5, 0.5, 0.5))
    )

    classes = LABELS

    def predict_proba(self, features: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the probabilities of `LABELS`.

        Parameters
        ----------
        features : ndarray, shape (n_windows, n_features)
            By `feature_names` [unit of each feature]; NaN where missing.

        Returns
        -------
        ndarray, shape (n_windows, 5)
            [-]; each row sums to 1.
        """
        votes = self.trees.probabilities(features)
        alone, among_others = (calibration(votes) for calibration in self.calibrations)
        more = has_more_than_sound(features, self.feature_names)
        return np.where(more[:, None], among_others, alone)

    def sensitive(self, sensitivity: float) -> Classifier:
        """Return a classifier with thresholds for another sensitivity.

        Parameters
        ----------
        sensitivity : float
            Factor on the odds of a noise [-]; above 1, more noises and more false names result.

        Examples
        --------
        >>> shipped = load_classifier()
        >>> shipped.sensitive(2.0).thresholds["car"] < shipped.thresholds["car"]
        True
        """
        others = {
            name: at_sensitivity(thresholds, sensitivity)
            for name, thresholds in self.thresholds.items()
        }
        return replace(self, thresholds=others)

    def save(self, path: str | Path) -> None:
        """Write the classifier to an NPZ file atomically.

        Raises
        ------
        ParameterError
            The file cannot be written.
        """
        header = {
            "labels": LABELS,
            "feature_names": self.feature_names,
            "calibrations": [asdict(calibration) for calibration in self.calibrations],
            "thresholds": dict(self.thresholds),
            "card": dict(self.card),
        }
        save_model(path, CLASSIFIER, header, self.trees.arrays())


def at_sensitivity(thresholds: Thresholds, sensitivity: float) -> Thresholds:
    """Return the thresholds for another sensitivity [-].

    Parameters
    ----------
    thresholds : tuple of 3 floats
        Thresholds at a sensitivity of 1 [-].
    sensitivity : float
        Factor on the odds of a noise [-].

    Examples
    --------
    >>> np.round(at_sensitivity((0.75, 0.75, 0.5), 3.0), 2).tolist()
    [0.5, 0.5, 0.25]
    """
    creak, squawk, squeal = (1.0 / (1.0 + sensitivity * (1.0 / p - 1.0)) for p in thresholds)
    return creak, squawk, squeal


def has_more_than_sound(features: NDArray[np.float32], names: Sequence[str]) -> NDArray[np.bool_]:
    """Whether each window has features of other channels than pressure, shape (n_windows,).

    Examples
    --------
    >>> features = np.array([[1.0, np.nan], [1.0, 2.0]], dtype=np.float32)
    >>> has_more_than_sound(features, ["pressure_flux", "torque_mean"]).tolist()
    [False, True]
    """
    others = [i for i, name in enumerate(names) if not name.startswith("pressure_")]
    return np.asarray(np.isfinite(features[:, others]).any(axis=1))


def load_classifier(path: str | Path | None = None) -> Classifier:
    """Load a classifier, by default the shipped one.

    Parameters
    ----------
    path : path-like, optional
        NPZ file of `Classifier.save`.

    Returns
    -------
    Classifier

    Raises
    ------
    ParameterError
        The file was not written by `Classifier.save`.

    Examples
    --------
    >>> load_classifier().classes
    ('creak', 'squawk', 'squeal', 'none', 'unknown')
    """
    return load_model(path, CLASSIFIER, _built)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Classifier:
    trees = BoostedTrees.of_arrays(arrays)
    trees.check(len(header["feature_names"]))
    sound, all_channels = (_calibration(stored) for stored in header["calibrations"])
    if tuple(header["labels"]) != LABELS or trees.base.shape != (len(LABELS),):
        raise ValueError("its labels are others")
    thresholds = {}
    for name in SURROUNDINGS:
        creak, squawk, squeal = (float(p) for p in header["thresholds"][name])
        if not all(0.0 < p < 1.0 for p in (creak, squawk, squeal)):
            raise ValueError("a threshold of it is no probability")
        thresholds[name] = (creak, squawk, squeal)
    names = tuple(header["feature_names"])
    return Classifier(names, trees, (sound, all_channels), header["card"], thresholds)


def _calibration(stored: Mapping[str, Any]) -> Calibration:
    weights = tuple(float(w) for w in stored["weights"])
    if len(weights) != len(LABELS):
        raise ValueError("its calibration is not one of its labels")
    return Calibration(float(stored["sharpness"]), weights)
