"""What the cause posterior says of a bench where nothing is the matter: simulated cases of it.

Of each condition of a case a few repeats are simulated, as noisy as its sensors are. Some of them
in the place of the recordings, others in that of what the rig file predicts, are a case without a
cause, and there are many such choices. Sensors that the posterior has not learned with change what
it says of these cases as they change what it says of the recordings.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as students_t

from noise.diagnosis.evidence.summary import CaseTable, column_moments, same_channels, summary
from noise.diagnosis.simulated.nominal import condition_key, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior

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
    """Put repeats in the places of the recordings, and of what is predicted of them."""
    recorded, predicted = {}, {}
    for key, rows in repeats.items():
        mixed = rows[rng.permutation(len(rows))]
        predicted[key] = column_moments(mixed[:_N_PREDICTED])
        recorded[key] = itertools.cycle(mixed[_N_PREDICTED:])
    means, spreads = (np.array([predicted[key][i] for key in at]) for i in range(2))
    measured = np.array([next(recorded[key]) for key in at])
    return replace(table, measured=measured, nominal=means, scatter=spreads)


def as_seldom(value: float, nulls: NDArray[np.float64], n_recordings: int) -> float:
    """Return how seldom cases without a cause have so low a value [-].

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
