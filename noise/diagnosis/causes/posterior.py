"""How probable each cause is: trees over the evidence, their votes made probabilities.

The causes are not exclusive, an effect may come with another; ``none``, ``parameters`` and
``unknown`` are. So each has boosted trees of its own, and the calibration is a logistic one on
their logarithmic odds, the strongest other ones and those of ``none``, fitted on cases that the
trees have not seen. The file holds arrays only and runs no code.
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
from noise.base.atomic import atomic
from noise.classifier.trees import Trees
from noise.diagnosis.evidence.evidence import evidence
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from noise.diagnosis.evidence.summary import CaseTable

__all__ = ["CAUSES", "Posterior", "calibrated", "load_posterior", "odds_features"]

CAUSES = (*sorted(EFFECTS), "parameters", "unknown", "none")
"""What can be the matter."""

_FORMAT = 2
_LARGEST = 12.0
"""Of a logarithm of odds: no library is large enough to tell more."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Cause posterior.

    Parameters
    ----------
    names : tuple of str
        Numbers of a recording that count.
    scale : ndarray, shape (n_names,)
        Scatter of each without a cause.
    columns : ndarray of int, shape (n_columns,)
        Of the evidence that the trees look at.
    trees : Trees
        Their scores are logarithmic odds of each of `CAUSES`.
    weights : ndarray, shape (n_causes, 4)
        Of the calibration: constant, own odds, strongest other, none.
    alarm : float
        Probability of ``none`` below which there is something to explain.
    null : ndarray, shape (n_quantiles, n_stages)
        Largest differences of each stage in cases without a cause, for p-values.
    card : mapping
        How it was made: seed, counts, scores.
    """

    names: tuple[str, ...]
    scale: NDArray[np.float64]
    columns: NDArray[np.int64]
    trees: Trees
    weights: NDArray[np.float64]
    alarm: float
    null: NDArray[np.float64]
    card: Mapping[str, object]

    def probabilities(self, table: CaseTable) -> dict[str, float]:
        """Probability of each of `CAUSES` being at work."""
        row = evidence(table, self.names, self.scale).astype(np.float64)
        p = calibrated(self.trees.scores(row[None, self.columns]), self.weights)[0]
        return dict(zip(CAUSES, p.tolist(), strict=True))

    def save(self, path: str | Path) -> None:
        """Write it into an NPZ file, whole or not at all."""
        arrays = {field.name: getattr(self.trees, field.name) for field in fields(Trees)}
        header = {
            "format": _FORMAT, "causes": CAUSES, "names": self.names, "alarm": self.alarm,
            "card": dict(self.card),
        }  # fmt: skip
        with atomic(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(
                file, header=np.array(json.dumps(header)), scale=self.scale, weights=self.weights,
                null=self.null, columns=self.columns, **arrays,
            )  # fmt: skip


def odds_features(odds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what the calibration looks at, shape (n, n_causes, 4)."""
    odds = np.clip(odds, -_LARGEST, _LARGEST)
    others = np.stack(
        [np.delete(odds, k, axis=1).max(axis=1) for k in range(odds.shape[1])], axis=1
    )
    none = np.broadcast_to(odds[:, -1:], odds.shape)
    return np.stack([np.ones_like(odds), odds, others, none], axis=2)


def calibrated(odds: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Probabilities of logarithmic odds.

    Examples
    --------
    >>> even = np.zeros((1, len(CAUSES)))
    >>> calibrated(even, np.zeros((len(CAUSES), 4)))[0, 0]
    np.float64(0.5)
    """
    logit = np.einsum("nkf,kf->nk", odds_features(odds), weights)
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(logit, -30.0, 30.0))))


def load_posterior(path: str | Path | None = None) -> Posterior:
    """Load a cause posterior, by default the one that is shipped.

    Raises
    ------
    ParameterError
        If the file is none that `Posterior.save` wrote.
    """
    return _shipped() if path is None else _load(Path(path))


@lru_cache(maxsize=1)
def _shipped() -> Posterior:
    with resources.as_file(resources.files("noise.diagnosis") / "data" / "causes.npz") as path:
        return _load(path)


def _load(path: Path) -> Posterior:
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(str(file["header"]))
            trees = Trees(**{field.name: file[field.name] for field in fields(Trees)})
            arrays = {name: file[name] for name in ("scale", "weights", "null", "columns")}
        trees.check()
        if header["format"] != _FORMAT or tuple(header["causes"]) != CAUSES:
            raise ValueError("it was made for other causes")
        return Posterior(
            names=tuple(header["names"]),
            trees=trees,
            alarm=float(header["alarm"]),
            card=header["card"],
            **arrays,
        )
    except FileNotFoundError:
        raise ParameterError(f"cause posterior {path}: no such file") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise ParameterError(f"cause posterior {path}: cannot be used ({error})") from None
