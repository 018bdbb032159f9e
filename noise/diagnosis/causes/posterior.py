"""Posterior probability of each cause: trees over the evidence, with calibrated probabilities.

The causes are not exclusive, an effect may come with another; ``none``, ``parameters`` and
``unknown`` are. So each has boosted trees of its own, and the calibration is a logistic one on
their logarithmic odds, the strongest other ones and those of ``none``, fitted on cases that the
trees have not seen.

What it says of a bench where nothing is the matter is simulated where sensors are unlike those that
it learned with. Of each condition of a case a few repeats are simulated, as noisy as its sensors
are. Some of them in the place of the recordings, others in that of what the rig file predicts, are
a case without a cause, and there are many such choices. Sensors that the posterior has not learned
with change what it says of these cases as they change what it says of the recordings.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as students_t

from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import BoostedTrees
from noise.diagnosis.evidence.summary import (
    CaseTable,
    column_moments,
    evidence,
    same_channels,
    summary,
)
from noise.diagnosis.simulated.repeats import condition_key, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects import EFFECTS
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.evidence.summary import CaseTable


N_NULLS = 200
"""Cases without a cause."""

_N_REPEATS, _N_PREDICTED = 8, 3
"""Repeats a condition, and how many of them predict; the latter as in `case_table`."""


def null_log_odds(
    case: Case,
    table: CaseTable,
    posterior: Posterior,
    library: Mapping[str, Effect],
    seed: int = 0,
) -> NDArray[np.float64]:
    """Simulate cases without a cause on the bench of a case.

    Parameters
    ----------
    case : Case
    table : CaseTable
        Of its recordings.
    posterior : Posterior
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    seed : int

    Returns
    -------
    ndarray, shape (n_nulls, n_causes)
        Natural logarithms of odds, as of `Posterior.log_odds` [-].

    Raises
    ------
    ParameterError
        The rig cannot be simulated.
    """
    transfer_functions = TransferFunctionCache(case.rig, library)
    at = [condition_key(recording) for recording in case.recordings]
    first = dict(zip(reversed(at), reversed(case.recordings), strict=True))
    repeats = {}
    for place, (key, recording) in enumerate(first.items()):
        seeds = np.random.SeedSequence([seed, 7, place]).generate_state(_N_REPEATS).tolist()
        runs = nominal_repeats(recording, case.rig, transfer_functions, seeds, library=library)
        whole = transfer_functions.whole(recording)
        rows = [summary(same_channels(x, recording), case.rig, whole) for x in runs]
        repeats[key] = np.array([[row.get(name, np.nan) for name in table.names] for row in rows])
    rng = np.random.default_rng([seed, 8])
    return np.array([posterior.log_odds(_null(table, at, repeats, rng)) for _ in range(N_NULLS)])


def _null(
    table: CaseTable,
    at: list[tuple[float, ...]],
    repeats: Mapping[tuple[float, ...], NDArray[np.float64]],
    rng: np.random.Generator,
) -> CaseTable:
    """Return a table with repeats in place of recordings and of their predictions."""
    recorded, predicted = {}, {}
    for key, rows in repeats.items():
        mixed = rows[rng.permutation(len(rows))]
        predicted[key] = column_moments(mixed[:_N_PREDICTED])
        recorded[key] = itertools.cycle(mixed[_N_PREDICTED:])
    means, spreads = (np.array([predicted[key][i] for key in at]) for i in range(2))
    measured = np.array([next(recorded[key]) for key in at])
    return replace(table, measured=measured, nominal=means, scatter=spreads)


def as_seldom(value: float, nulls: NDArray[np.float64], n_recordings: int) -> float:
    """Return the share of cases without a cause that have so low a value [-].

    Parameters
    ----------
    value : float
        [any unit]
    nulls : ndarray, shape (n_nulls,)
        Of such cases [unit of `value`].
    n_recordings : int
        Of which each has been simulated; of one alone there are few choices, whose tail says more
        than their ranks.

    Examples
    --------
    >>> nulls = np.random.default_rng(0).normal(size=400)
    >>> as_seldom(-9.0, nulls, 5) < 0.01, as_seldom(0.0, nulls, 5) > 0.3
    (True, True)
    """
    share = (1.0 + np.count_nonzero(nulls <= value)) / (nulls.size + 1.0)
    if n_recordings > 1:
        return float(share)
    wide = float(nulls.std(ddof=1)) * np.sqrt(1.0 + 1.0 / _N_REPEATS) + 1e-9
    tail = students_t.cdf((value - float(nulls.mean())) / wide, _N_REPEATS - 1)
    return float(max(share, tail))


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
    """Posterior probability of each cause given the evidence of a case.

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
        """Return the probability that each of `CAUSES` is present."""
        p = calibrated(self.log_odds(table)[None], self.weights)[0]
        return dict(zip(CAUSES, p.tolist(), strict=True))

    def log_odds(self, table: CaseTable) -> NDArray[np.float64]:
        """Return the uncalibrated log odds of each of `CAUSES`, shape (n_causes,) [-]."""
        row = evidence(table, self.names, self.scale).astype(np.float64)
        return np.asarray(self.trees.scores(row[None, self.columns])[0])

    def save(self, path: str | Path) -> None:
        """Write the posterior to an NPZ file, whole or not at all.

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
    """Return the features of the calibration.

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
    """Return the calibrated probabilities of log odds.

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
