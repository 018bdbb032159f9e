"""The classifier: features of a segment in, probabilities of the five labels out.

Trained on simulation alone, it ships with the package (``data/classifier.npz``); how it is
trained is the business of `noise.classifier.training`.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.atomic import atomic
from noise.classifier.forest import Forest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["LABELS", "Classifier", "load_classifier"]

LABELS = ("creak", "squawk", "squeal", "none", "unknown")
"""The labels, in the order of all tables of probabilities."""

_FORMAT = 1


@dataclass(frozen=True, eq=False)
class Classifier:
    """A forest over named features, with calibrated probabilities.

    Parameters
    ----------
    feature_names : tuple of str
        Features in the forest's order.
    forest : Forest
    sharpness : float
        Exponent that calibrates the forest's votes: above 1 it makes them more certain.
    card : mapping
        How it was trained: seed, counts, score.
    """

    feature_names: tuple[str, ...]
    forest: Forest
    sharpness: float
    card: Mapping[str, object]

    classes = LABELS

    def predict_proba(self, features: list[dict[str, float]]) -> NDArray[np.float64]:
        """Probabilities of `LABELS`.

        Parameters
        ----------
        features : list of dict
            One a segment, as `features.recording_features` gives them; those that are missing
            count as unknown.

        Returns
        -------
        ndarray, shape (n_segments, 5)
            Each row sums to 1.
        """
        x = np.array([[row.get(name, np.nan) for name in self.feature_names] for row in features])
        return calibrated(self.forest.probabilities(x.reshape(len(features), -1)), self.sharpness)

    def save(self, path: str | Path) -> None:
        """Write the classifier into an NPZ file, whole or not at all."""
        arrays = {field.name: getattr(self.forest, field.name) for field in fields(Forest)}
        header = {
            "format": _FORMAT,
            "labels": LABELS,
            "feature_names": self.feature_names,
            "sharpness": self.sharpness,
            "card": dict(self.card),
        }
        with atomic(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, header=np.array(json.dumps(header)), **arrays)


def calibrated(votes: NDArray[np.float64], sharpness: float) -> NDArray[np.float64]:
    """Raise votes to a power and normalise them: one number, fitted on samples no tree saw.

    Examples
    --------
    >>> calibrated(np.array([[0.5, 0.25, 0.25]]), 2.0).round(2).tolist()
    [[0.67, 0.17, 0.17]]
    """
    floor = 1e-3  # no forest of some hundred trees can tell less
    p = (votes + floor) ** sharpness
    return np.asarray(p / p.sum(axis=1, keepdims=True))


def load_classifier(path: str | Path | None = None) -> Classifier:
    """Load a classifier, by default the one that is shipped.

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
            forest = Forest(**{field.name: file[field.name] for field in fields(Forest)})
        forest.check()
        highest = int(forest.feature.max(initial=-1))
        if highest >= len(header["feature_names"]) or forest.votes.shape[1] != len(LABELS):
            raise ValueError("its trees ask for features or labels that it does not name")
        if header["format"] != _FORMAT or tuple(header["labels"]) != LABELS:
            raise ParameterError(
                f"classifier {path}: of format {header['format']!r}, expected {_FORMAT}; "
                f"make it again with `bushing-noise train --out {path.name}`"
            )
        return Classifier(
            feature_names=tuple(header["feature_names"]),
            forest=forest,
            sharpness=float(header["sharpness"]),
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
