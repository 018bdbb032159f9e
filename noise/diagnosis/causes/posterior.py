"""Posterior probability of each cause: boosted trees over the evidence, calibrated.

Effects are not exclusive: one may occur with another. ``none``, ``parameters`` and ``unknown`` are
exclusive. Each cause has boosted trees of its own. The calibration is a logistic regression on the
log odds of the cause, of the strongest other cause and of ``none``. It is fitted on cases that the
trees have not seen.

Where the sensors of a bench are unlike those of the training cases, the null distribution is
simulated. A few repeats of each condition are simulated with the noise of the sensors. Some of them
take the place of the recordings and others that of the prediction of the rig file, which makes a
case without a cause; there are many such choices. Unusual sensors change the posterior of these
cases in the same way as that of the recordings.
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

N_NULLS = 200
"""Number of simulated cases without a cause."""

_N_REPEATS, _N_PREDICTED = 8, 3
"""Repeats per condition, and how many of them are the prediction; the latter as in `case_table`."""


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
        Numbers of its recordings.
    posterior : Posterior
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    seed : int

    Returns
    -------
    ndarray, shape (n_nulls, n_causes)
        Uncalibrated log odds, as `Posterior.log_odds` returns them [-].

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
    """Return a table with repeats in the place of the recordings and of their predictions."""
    recorded, predicted = {}, {}
    for key, rows in repeats.items():
        mixed = rows[rng.permutation(len(rows))]
        predicted[key] = column_moments(mixed[:_N_PREDICTED])
        recorded[key] = itertools.cycle(mixed[_N_PREDICTED:])
    means, spreads = (np.array([predicted[key][i] for key in at]) for i in range(2))
    measured = np.array([next(recorded[key]) for key in at])
    return replace(table, measured=measured, nominal=means, scatter=spreads)


def as_seldom(value: float, nulls: NDArray[np.float64], n_recordings: int) -> float:
    """Return the share of cases without a cause whose value is as low or lower [-].

    Parameters
    ----------
    value : float
        [any unit]
    nulls : ndarray, shape (n_nulls,)
        Values of the cases without a cause [unit of `value`].
    n_recordings : int
        Recordings of a case. With a single recording there are few choices of repeats; the share
        then comes from a t distribution rather than from ranks.

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
"""Causes in the order of the columns: the effects, then the exclusive causes."""

_KIND = ModelKind(
    "cause posterior", 2, "python -m noise.training.causes train FOLDER --out",
    ("noise.diagnosis", "causes.npz"),
)  # fmt: skip

_ARRAYS = ("scale", "weights", "columns")
_LARGEST = 12.0
"""Limit of log odds [-]: the training cases are too few to support larger ones."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Posterior probability of each cause given the evidence of a case.

    Parameters
    ----------
    names : tuple of str
        Numbers of a recording that are used, each in its own unit.
    scale : ndarray, shape (n_names,)
        Scatter of each number without a cause [unit of the number].
    columns : ndarray of int, shape (n_columns,)
        Columns of the evidence that the trees use.
    trees : BoostedTrees
        Their scores are the log odds of each of `CAUSES`.
    weights : ndarray, shape (n_causes, 4)
        Weights of the calibration: constant, own log odds, strongest other, ``none`` [-].
    alarm : float
        Probability [-] of ``none`` below which there is something to explain.
    card : mapping
        Seed, counts and scores of the training.
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
        Log odds [-].

    Returns
    -------
    ndarray, shape (n, n_causes, 4)
        Constant, own log odds, strongest other log odds, log odds of ``none`` [-].
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
        Log odds [-].
    weights : ndarray, shape (n_causes, 4)
        Weights of the calibration, as in `Posterior` [-].

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
    """Load a cause posterior; by default the shipped one.

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
        If `Posterior.save` did not write the file.
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
