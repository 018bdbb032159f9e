"""Hypotheses judged by cases of this very rig, simulated under each that is still likely.

What log-odds of causes mean on one rig: a multinomial regression on cases simulated of it.

Hypotheses are sets of causes, and there are more of them than a few hundred cases can teach one by
one. So what a set of effects scores is the sum of what its members score, of what all pairs (or
triples) have in common, and of a little of its own. Before any case is seen, a set scores the sum
of its members' log-odds; a ridge holds it there, as strongly as cases left out say.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar
from scipy.special import log_softmax

from noise.diagnosis.cases.truth import KINDS
from noise.diagnosis.causes.joint import Hypothesis, marginals, normalised
from noise.diagnosis.causes.local_cases import LocalCase, bench_of, local_cases
from noise.diagnosis.causes.posterior import CAUSES, Posterior
from noise.diagnosis.causes.verdict import ALONE
from noise.diagnosis.evidence.summary import CaseTable
from sim.effects import EFFECTS
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case

_LARGEST = 12.0
"""Of a logarithm of odds; no library is large enough to tell more; assumed."""

_UNIT = 4.0
"""Of logarithms of odds, so that they are about 1."""

_OWN_SHARE = 0.5
"""Of what a set's own weights count beside those of its members; assumed."""

_RIDGES = (0.3, 1.0, 3.0, 10.0, 30.0)
"""Tried; the cases left out in folds choose among them. Grid, folds and steps are assumed."""
_FOLDS = 4
_STEPS = 80

Sets = tuple[frozenset[str], ...]


@dataclass(frozen=True, eq=False)
class LocalModel:
    """Scores of hypotheses from log-odds of causes.

    Parameters
    ----------
    hypotheses : tuple of frozenset of str
    weights : ndarray, shape (n_hypotheses, n_causes + 1)
        Of log-odds over `_UNIT` and of a constant [-].
    temperature : float
        That calibrates the scores on cases left out [-].
    ridge : float
        [-]
    """

    hypotheses: Sets
    weights: NDArray[np.float64]
    temperature: float
    ridge: float

    def log_likelihoods(self, odds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Logarithms of likelihoods but for a common factor.

        Parameters
        ----------
        odds : ndarray, shape (n_causes,)
            Natural logarithms of odds of `CAUSES` [-].

        Returns
        -------
        ndarray, shape (n_hypotheses,)
            [-]
        """
        return np.asarray(self.weights @ _features(odds[None])[0] / self.temperature)


def fit_local_model(
    odds: NDArray[np.float64], causes: Sequence[frozenset[str]], hypotheses: Sets
) -> LocalModel:
    """Fit what log-odds mean.

    Parameters
    ----------
    odds : ndarray, shape (n_cases, n_causes)
        Natural logarithms of odds of `CAUSES` [-].
    causes : sequence of frozenset of str
        Of each case, one of the hypotheses.
    hypotheses : tuple of frozenset of str

    Returns
    -------
    LocalModel
    """
    x = _features(odds)
    place = {hypothesis: i for i, hypothesis in enumerate(hypotheses)}
    y = np.array([place[cause] for cause in causes], dtype=int)
    if not y.size:
        return LocalModel(hypotheses, _first_weights(hypotheses), 1.0, np.inf)
    # Each hypothesis is left out in turn as evenly as its cases allow.
    fold = np.zeros(y.size, dtype=int)
    order = np.argsort(y, kind="stable")
    fold[order] = np.arange(y.size) % _FOLDS
    best: tuple[float, float, float] | None = None
    for ridge in _RIDGES:
        left_out = np.zeros((y.size, len(hypotheses)))
        for k in range(_FOLDS):
            out = fold == k
            if out.any() and not out.all():
                weights = _weights(x[~out], y[~out], hypotheses, ridge)
                left_out[out] = x[out] @ weights.T
        loss, temperature = _tempered(left_out, y)
        if best is None or loss < best[0]:
            best = (loss, ridge, temperature)
    assert best is not None
    _, ridge, temperature = best
    return LocalModel(hypotheses, _weights(x, y, hypotheses, ridge), temperature, ridge)


def _features(odds: NDArray[np.float64]) -> NDArray[np.float64]:
    clipped = np.clip(odds, -_LARGEST, _LARGEST) / _UNIT
    return np.column_stack([clipped, np.ones(len(clipped))])


def _first_weights(hypotheses: Sets) -> NDArray[np.float64]:
    """Weights by which a set scores the sum of its members' log-odds."""
    weights = np.zeros((len(hypotheses), len(CAUSES) + 1))
    for i, hypothesis in enumerate(hypotheses):
        for cause in hypothesis or {"none"}:
            if cause in CAUSES:
                weights[i, CAUSES.index(cause)] = _UNIT
    return weights


def _parts(hypotheses: Sets) -> NDArray[np.float64]:
    """Of what the weights of each hypothesis are made, shape (n_hypotheses, n_parts)."""
    members = sorted({cause for hypothesis in hypotheses for cause in hypothesis or {"none"}})
    of_members = [[cause in (h or {"none"}) for cause in members] for h in hypotheses]
    of_size = [[len(h) == 2, len(h) == 3] for h in hypotheses]
    own = _OWN_SHARE * np.eye(len(hypotheses))
    return np.column_stack([np.array(of_members, float), np.array(of_size, float), own])


def _weights(
    x: NDArray[np.float64], y: NDArray[np.int64], hypotheses: Sets, ridge: float
) -> NDArray[np.float64]:
    first, parts = _first_weights(hypotheses), _parts(hypotheses)
    offset = _log_shares(y, len(hypotheses))
    truth = np.zeros((y.size, len(hypotheses)))
    truth[np.arange(y.size), y] = 1.0
    shape = (parts.shape[1], x.shape[1])

    def loss(flat: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        more = flat.reshape(shape)
        log_p = log_softmax(x @ (first + parts @ more).T + offset, axis=1)
        slope = parts.T @ ((np.exp(log_p) - truth).T @ x) + ridge * more
        value = -float(log_p[np.arange(y.size), y].sum()) + 0.5 * ridge * float((more**2).sum())
        return value, slope.ravel()

    found = minimize(
        loss, np.zeros(shape).ravel(), jac=True, method="L-BFGS-B", options={"maxiter": _STEPS}
    )
    return np.asarray(first + parts @ found.x.reshape(shape))


def _log_shares(y: NDArray[np.int64], n: int) -> NDArray[np.float64]:
    """Logarithm of the share of each hypothesis in the cases; those without a case do not count."""
    count = np.bincount(y, minlength=n)
    return np.where(count > 0, np.log(np.maximum(count, 1) / y.size), -1e3)


def _tempered(scores: NDArray[np.float64], y: NDArray[np.int64]) -> tuple[float, float]:
    """Mean loss and temperature at which scores of cases left out are likeliest."""
    offset = _log_shares(y, scores.shape[1])

    def loss(log_temperature: float) -> float:
        log_p = log_softmax(scores / np.exp(log_temperature) + offset, axis=1)
        return -float(log_p[np.arange(y.size), y].mean())

    found = minimize_scalar(loss, bounds=(-0.7, 2.0), method="bounded")
    return float(found.fun), float(np.exp(found.x))


NONE: Hypothesis = frozenset()
SHORTLIST = 8
"""Effects that local cases are made of; those hold both of a pair in five cases of six."""

LEADERS = 2
"""The likeliest effects, with and without which most cases are made."""

SURE = 0.8
"""Probability of a hypothesis from which on local cases change no verdict [-]."""

_ENOUGH = 0.8
"""Share of the local cases without which they are not asked [-]."""

_IN_TRIPLES = 5
"""The likeliest effects, of which triples are made; assumed."""


_KIND_OF_SIZE = {1: "one", 2: "pair", 3: "triple"}


def local_answer(
    case: Case,
    table: CaseTable,
    posterior: Posterior,
    first: Mapping[Hypothesis, float],
    *,
    library: Mapping[str, Effect] = EFFECTS,
    workers: int = 2,
    seed: int = 0,
) -> tuple[dict[Hypothesis, float], str]:
    """Probability of each hypothesis, judged by cases simulated of this rig at these conditions.

    How many cases there are is settled by the hypotheses in question, and never by the clock: the
    same recordings have the same answer on a slow machine.

    Parameters
    ----------
    case : Case
    table : CaseTable
        Of its recordings.
    posterior : Posterior
    first : mapping of frozenset of str to float
        As `joint_probabilities` gives it [-].
    library : mapping of str to Effect
        Effects that may be missing; those of the user's own are always in question, and take their
        probability from all others alike.
    workers : int
        Processes.
    seed : int
        Of the cases.

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-]. What was not simulated keeps the probability that
        it had.
    str
        Why these are the first answer's, or what else is to be known of them; empty if nothing is.
    """
    single = marginals(first)
    effects = sorted((c for c in single if c in EFFECTS), key=lambda c: -single[c])[:SHORTLIST]
    listed = {spec.name for spec in case.rig.effects}
    own = [name for name in library if name not in EFFECTS and name not in listed]
    sure = max(first.values()) >= SURE
    if sure and not own:
        return dict(first), ""
    known = _hypotheses(effects)
    of_own = [h for h in _hypotheses([*effects, *own]) if h & set(own)]
    bench = bench_of(case, table, library=library, seed=seed)
    wanted = [job for h in (known, of_own) for job in _wanted(h, effects[:LEADERS])]
    cases = local_cases(bench, posterior, wanted, library=library, workers=workers, seed=seed)
    if len(cases) < _ENOUGH * len(wanted):  # those that can be simulated are no fair choice
        return dict(first), (
            f"{len(wanted) - len(cases)} of {len(wanted)} cases of this rig with a likely cause "
            "cannot be simulated: the causes are as probable as on other rigs"
        )
    odds = posterior.log_odds(bench.table)
    covered = sum(first.get(hypothesis, 0.0) for hypothesis in known)
    answer = dict(first)
    if not sure:  # a few dozen cases are as unsure as the library is: the two count alike
        told = _told_by(cases, known, odds, len(effects))
        both = normalised({h: math.sqrt(p * first.get(h, 0.0)) for h, p in told.items()})
        answer |= {h: covered * p for h, p in both.items()}
    if own:  # the others stay as probable beside each other as they are without these
        told = _told_by(cases, [*known, *of_own], odds, len(effects) + len(own))
        of_these = {h: covered * told[h] for h in of_own}
        left = 1.0 - sum(of_these.values())
        answer = {h: left * p for h, p in answer.items()} | of_these
    n, whole = len(bench.runs), len(case.recordings)
    part = f"{n} of {whole} recordings" if n < whole else ""
    return normalised(answer), f"causes were simulated on this rig for {part} only" if part else ""


def _told_by(
    cases: Sequence[LocalCase],
    hypotheses: Sequence[Hypothesis],
    odds: NDArray[np.float64],
    n_effects: int,
) -> dict[Hypothesis, float]:
    """Probability of each hypothesis by local cases of them alone, were there no other [-]."""
    among = [one for one in cases if one.hypothesis in set(hypotheses)]
    model = fit_local_model(
        np.array([one.odds for one in among]), [one.hypothesis for one in among], tuple(hypotheses)
    )
    scores = model.log_likelihoods(odds)
    weights = np.exp(scores - scores.max()) * _prior(hypotheses, n_effects)
    return normalised(dict(zip(hypotheses, weights.tolist(), strict=True)))


def _hypotheses(effects: Sequence[str]) -> tuple[Hypothesis, ...]:
    triples = combinations(effects[:_IN_TRIPLES], 3)
    sets = (*combinations(effects, 1), *combinations(effects, 2), *triples)
    return (NONE, *ALONE, *map(frozenset, sets))


def _prior(hypotheses: Sequence[Hypothesis], n_effects: int) -> NDArray[np.float64]:
    """Share of each hypothesis among cases as they are drawn, were there only these effects [-]."""

    def share(hypothesis: Hypothesis) -> float:
        if hypothesis in ALONE:
            return KINDS[min(hypothesis)]
        if not hypothesis:
            return KINDS["none"]
        size = len(hypothesis)
        return KINDS[_KIND_OF_SIZE[size]] / math.comb(n_effects, size)

    return np.array([share(hypothesis) for hypothesis in hypotheses])


def _wanted(
    hypotheses: Sequence[Hypothesis], leaders: Collection[str]
) -> list[tuple[Hypothesis, int]]:
    """Cause and number of each case; of triples, which are many, one in a few has a case."""
    found = []
    for place, hypothesis in enumerate(hypotheses):
        often, share = _often(hypothesis, leaders), place / len(hypotheses)
        n = math.floor(often + share) - math.floor(share)
        found += [(hypothesis, number) for number in range(n)]
    return found


def _often(hypothesis: Hypothesis, leaders: Collection[str]) -> float:
    """Count the cases of a hypothesis; of those that have a part of one, so many share it.

    There are more where much hangs on it: of the likeliest effects and what may come with them, and
    of what the posterior has no name for.
    """
    if hypothesis == NONE or hypothesis in ALONE:
        return 6 if "unknown" in hypothesis else 4
    led = len(hypothesis & set(leaders))
    if len(hypothesis) == 1:
        return 4 if led else 2 if hypothesis <= EFFECTS.keys() else 6
    if len(hypothesis) == 2:
        return (0.34, 2, 3)[led]
    return 0.34 if led == 2 else 0.1
