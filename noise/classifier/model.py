"""The classifier: features of windows in, probabilities of the five labels out.

Trained on simulation alone, it ships with the package (``data/classifier.npz``); how it is
trained is the business of `noise.training.classifier.fit`.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict, dataclass, fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import ParameterError
from noise.base.atomic import atomic
from noise.classifier.calibration import Calibration
from noise.classifier.trees import Trees

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

__all__ = ["LABELS", "Classifier", "load_classifier"]

LABELS = ("creak", "squawk", "squeal", "none", "unknown")
"""The labels, in the order of all tables of probabilities."""

_FORMAT = 2


@dataclass(frozen=True, eq=False)
class Classifier:
    """Boosted trees over named features, with calibrated probabilities.

    Parameters
    ----------
    feature_names : tuple of str
        Features in the order of the trees; of `noise.labels.windows.FEATURE_NAMES`.
    trees : Trees
    calibrations : pair of Calibration
        For sound alone, and for sound with what else was measured.
    card : mapping
        How it was trained: seed, counts, scores.

    Examples
    --------
    >>> shipped = load_classifier()
    >>> missing = np.full((1, len(shipped.feature_names)), np.nan, dtype=np.float32)
    >>> float(shipped.predict_proba(missing).sum().round(6))
    1.0
    """

    feature_names: tuple[str, ...]
    trees: Trees
    calibrations: tuple[Calibration, Calibration]
    card: Mapping[str, object]

    classes = LABELS

    def predict_proba(self, features: NDArray[np.float32]) -> NDArray[np.float64]:
        """Probabilities of `LABELS`.

        Parameters
        ----------
        features : ndarray, shape (n_windows, n_features)
            By `feature_names`; NaN where missing.

        Returns
        -------
        ndarray, shape (n_windows, 5)
            Each row sums to 1.
        """
        votes = self.trees.probabilities(features)
        alone, among_others = (calibration(votes) for calibration in self.calibrations)
        more = has_more_than_sound(features, self.feature_names)
        return np.where(more[:, None], among_others, alone)

    def save(self, path: str | Path) -> None:
        """Write the classifier into an NPZ file, whole or not at all."""
        arrays = {field.name: getattr(self.trees, field.name) for field in fields(Trees)}
        header = {
            "format": _FORMAT,
            "labels": LABELS,
            "feature_names": self.feature_names,
            "calibrations": [asdict(calibration) for calibration in self.calibrations],
            "card": dict(self.card),
        }
        with atomic(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, header=np.array(json.dumps(header)), **arrays)

    def _repr_html_(self) -> str:
        from noise.classifier.card import card_html

        facts = [
            ["labels", ", ".join(LABELS)],
            ["features", f"{len(self.feature_names)} of windows"],
        ]
        return card_html("Classifier", facts, self.card)


def has_more_than_sound(features: NDArray[np.float32], names: Sequence[str]) -> NDArray[np.bool_]:
    """Whether windows have features of other channels than the pressure, shape (n_windows,).

    Examples
    --------
    >>> features = np.array([[1.0, np.nan], [1.0, 2.0]], dtype=np.float32)
    >>> has_more_than_sound(features, ["pressure_range", "torque_mean"]).tolist()
    [False, True]
    """
    others = [i for i, name in enumerate(names) if not name.startswith("pressure_")]
    return np.asarray(np.isfinite(features[:, others]).any(axis=1))


def load_classifier(path: str | Path | None = None) -> Classifier:
    """Load a classifier, by default the one that is shipped.

    Parameters
    ----------
    path : path-like, optional
        NPZ file that `Classifier.save` wrote.

    Returns
    -------
    Classifier

    Raises
    ------
    ParameterError
        If the file is none that `Classifier.save` wrote.

    Examples
    --------
    >>> load_classifier().classes
    ('creak', 'squawk', 'squeal', 'none', 'unknown')
    """
    return _shipped() if path is None else _load(Path(path))


@lru_cache(maxsize=1)
def _shipped() -> Classifier:
    with resources.as_file(resources.files("noise.classifier") / "data" / "classifier.npz") as path:
        return _load(path)


def _load(path: Path) -> Classifier:
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(str(file["header"]))
            trees = Trees(**{field.name: file[field.name] for field in fields(Trees)})
        trees.check()
        highest = int(trees.feature.max(initial=-1))
        if highest >= len(header["feature_names"]) or trees.base.shape != (len(LABELS),):
            raise ValueError("its trees ask for features or labels that it does not name")
        calibrations = header["calibrations"]
        if header["format"] != _FORMAT or tuple(header["labels"]) != LABELS:
            raise ParameterError(
                f"classifier {path}: of format {header['format']!r}, expected {_FORMAT}; "
                f"make it again with `bushing-noise train --out {path.name}`"
            )
        return Classifier(
            feature_names=tuple(header["feature_names"]),
            trees=trees,
            calibrations=(_calibration(calibrations[0]), _calibration(calibrations[1])),
            card=header["card"],
        )
    except FileNotFoundError:
        raise ParameterError(f"classifier {path}: no such file") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(
            f"classifier {path}: no file that `bushing-noise train` wrote ({error})"
        ) from None


def _calibration(stored: Mapping[str, Any]) -> Calibration:
    found = Calibration(float(stored["sharpness"]), tuple(float(w) for w in stored["weights"]))
    if len(found.weights) != len(LABELS):
        raise ValueError("its calibration is not one of its labels")
    return found
