"""Posterior probability of each cause: trees over the evidence, with calibrated probabilities.

The causes are not exclusive, an effect may come with another; ``none``, ``parameters`` and
``unknown`` are. So each has boosted trees of its own, and the calibration is a logistic one on
their logarithmic odds, the strongest other ones and those of ``none``, fitted on cases that the
trees have not seen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import BoostedTrees
from noise.diagnosis.evidence.evidence import evidence
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.diagnosis.evidence.summary import CaseTable


CAUSES = (*sorted(EFFECTS), "parameters", "unknown", "none")
"""What can be the matter."""

_KIND = ModelKind(
    "cause posterior", 2, "python -m noise.training.causes train FOLDER --out",
    ("noise.diagnosis", "causes.npz"),
)  # fmt: skip

_ARRAYS = ("scale", "weights", "columns")
_LARGEST = 12.0
"""Of a logarithm of odds: no library is large enough to tell more."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Cause posterior.

    Parameters
    ----------
    names : tuple of str
        Numbers of a recording that count, each in its own unit.
    scale : ndarray, shape (n_names,)
        Scatter of each without a cause, [unit of the number].
    columns : ndarray of int, shape (n_columns,)
        Of the evidence that the trees look at.
    trees : BoostedTrees
        Their scores are logarithmic odds of each of `CAUSES`.
    weights : ndarray, shape (n_causes, 4)
        Of the calibration: constant, own odds, strongest other, none [-].
    alarm : float
        Probability [-] of ``none`` below which there is something to explain.
    card : mapping
        How it was made: seed, counts, scores.
    """

    names: tuple[str, ...]
    scale: NDArray[np.float64]
    columns: NDArray[np.int64]
    trees: BoostedTrees
    weights: NDArray[np.float64]
    alarm: float
    card: Mapping[str, object]

    def probabilities(self, table: CaseTable) -> dict[str, float]:
        """Probability of each of `CAUSES` being at work."""
        p = calibrated(self.log_odds(table)[None], self.weights)[0]
        return dict(zip(CAUSES, p.tolist(), strict=True))

    def log_odds(self, table: CaseTable) -> NDArray[np.float64]:
        """Return what the trees say of each of `CAUSES`, not calibrated, shape (n_causes,) [-]."""
        row = evidence(table, self.names, self.scale).astype(np.float64)
        return np.asarray(self.trees.scores(row[None, self.columns])[0])

    def save(self, path: str | Path) -> None:
        """Write it into an NPZ file, whole or not at all.

        Raises
        ------
        ParameterError
            The file cannot be written.
        """
        header = {
            "causes": CAUSES, "names": self.names, "alarm": self.alarm, "card": dict(self.card)
        }  # fmt: skip
        own = {name: getattr(self, name) for name in _ARRAYS}
        save_model(path, _KIND, header, {**own, **self.trees.arrays()})


def odds_features(odds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what the calibration looks at.

    Parameters
    ----------
    odds : ndarray, shape (n, n_causes)
        Natural logarithms of odds [-].

    Returns
    -------
    ndarray, shape (n, n_causes, 4)
        Constant, own odds, strongest other odds, odds of ``none`` [-].
    """
    odds = np.clip(odds, -_LARGEST, _LARGEST)
    others = np.stack(
        [np.delete(odds, k, axis=1).max(axis=1) for k in range(odds.shape[1])], axis=1
    )
    none = np.broadcast_to(odds[:, -1:], odds.shape)
    return np.stack([np.ones_like(odds), odds, others, none], axis=2)


def calibrated(odds: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Probabilities of logarithmic odds.

    Parameters
    ----------
    odds : ndarray, shape (n, n_causes)
        Natural logarithms of odds [-].
    weights : ndarray, shape (n_causes, 4)
        As of `Posterior` [-].

    Returns
    -------
    ndarray, shape (n, n_causes)
        Probabilities [-].

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

    Parameters
    ----------
    path : path-like, optional
        NPZ file that `Posterior.save` wrote.

    Returns
    -------
    Posterior

    Raises
    ------
    ParameterError
        If the file is none that `Posterior.save` wrote.
    """
    return load_model(path, _KIND, _built)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Posterior:
    if tuple(header["causes"]) != CAUSES:
        raise ValueError("it was made for other causes")
    own = {name: arrays[name] for name in _ARRAYS}
    trees = BoostedTrees.of_arrays(arrays)
    trees.check(own["columns"].size)
    n = len(CAUSES)
    if trees.base.size != n or own["weights"].shape != (n, 4):
        raise ValueError("its arrays do not fit together")
    return Posterior(
        names=tuple(header["names"]),
        trees=trees,
        alarm=float(header["alarm"]),
        card=header["card"],
        **own,
    )
