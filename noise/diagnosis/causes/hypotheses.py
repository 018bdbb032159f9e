"""Hypotheses judged by cases of this very rig, simulated under each that is still likely."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.cases.truth import KINDS
from noise.diagnosis.causes.joint import Hypothesis, marginals, normalised
from noise.diagnosis.causes.local_cases import LocalCase, bench_of, local_cases
from noise.diagnosis.causes.local_model import fit_local_model
from noise.diagnosis.causes.posterior import Posterior
from noise.diagnosis.causes.verdict import ALONE
from noise.diagnosis.evidence.summary import CaseTable
from sim.effects import EFFECTS
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case


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
