"""Verdict of a diagnosis: hypotheses from causes taken one by one, and causes from hypotheses.

A hypothesis is the set of causes that are at work: none, ``parameters`` or ``unknown`` by itself,
or up to three effects.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from itertools import combinations

import numpy as np

from noise.diagnosis.gap import Gap

Hypothesis = frozenset[str]

_EXCLUSIVE = ("none", "parameters", "unknown")
_LEAST = 1e-4
"""Probabilities are held this far from 0 and 1 [-]: no library is large enough to tell more."""


_UNKNOWN_ODDS = 2.2
"""Factor on the odds of an unknown cause, since real rigs are more unlike those that the posterior
learned from than these are unlike each other [-]; of 281 development cases of the second rig (seeds
51 to 53, all with a gap) it lowers the Brier score from 0.378 to 0.361, cross-validated."""


def joint_probabilities(probabilities: Mapping[str, float]) -> dict[Hypothesis, float]:
    """Return the probability of each hypothesis if causes are independent.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of every cause being at work, ``none``, ``parameters`` and ``unknown`` among them [-].

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-].

    Examples
    --------
    >>> p = {"none": 0.0, "parameters": 0.1, "unknown": 0.0, "clipping": 0.9, "mains_hum": 0.7}
    >>> sorted(next(iter(joint_probabilities(p))))
    ['clipping', 'mains_hum']
    """
    odds = {
        cause: bounded / (1.0 - bounded)
        for cause, p in probabilities.items()
        if p > 0.0
        for bounded in [min(max(p, _LEAST), 1.0 - _LEAST)]
    }
    effects = [cause for cause in odds if cause not in _EXCLUSIVE]
    weights = {frozenset(set() if c == "none" else {c}): odds.get(c, 0.0) for c in _EXCLUSIVE}
    weights[frozenset({"unknown"})] *= _UNKNOWN_ODDS
    for size in (1, 2, 3):
        for members in combinations(effects, size):
            weights[frozenset(members)] = float(np.prod([odds[m] for m in members]))
    return normalised(weights)


def normalised(weights: Mapping[Hypothesis, float]) -> dict[Hypothesis, float]:
    """Return weights in proportion, so that they sum to 1 [-]; the largest first."""
    whole = sum(weights.values())
    ranked = sorted(weights.items(), key=lambda entry: -entry[1])
    return {hypothesis: weight / whole for hypothesis, weight in ranked}


def with_none(joint: Mapping[Hypothesis, float], least: float) -> dict[Hypothesis, float]:
    """Raise the probability of no cause to a minimum and rescale the others.

    Parameters
    ----------
    joint : mapping of frozenset of str to float
        Of the hypotheses [-].
    least : float
        Of nothing being the matter, where it has less [-].

    Examples
    --------
    >>> raised = with_none({frozenset({"clipping"}): 0.9, frozenset(): 0.1}, 0.7)
    >>> {"+".join(causes): round(p, 3) for causes, p in raised.items()}
    {'': 0.7, 'clipping': 0.3}
    """
    none: Hypothesis = frozenset()
    least = max(least, joint.get(none, 0.0))
    rest = sum(p for hypothesis, p in joint.items() if hypothesis)
    share = (1.0 - least) / rest if rest > 0.0 else 0.0
    others = {hypothesis: share * p for hypothesis, p in joint.items() if hypothesis}
    return normalised({none: least, **others})


def marginals(joint: Mapping[Hypothesis, float]) -> dict[str, float]:
    """Return the probability that each cause is present.

    Parameters
    ----------
    joint : mapping of frozenset of str to float
        Of the hypotheses [-].

    Returns
    -------
    dict of str to float
        By cause, ``none`` among them [-].

    Examples
    --------
    >>> marginals({frozenset(): 0.1, frozenset({"a"}): 0.5, frozenset({"a", "b"}): 0.4})
    {'none': 0.1, 'a': 0.9, 'b': 0.4}
    """
    single: dict[str, float] = {}
    for hypothesis, p in joint.items():
        for cause in sorted(hypothesis or {"none"}):
            single[cause] = single.get(cause, 0.0) + p
    return single


ALONE: tuple[Hypothesis, ...] = (frozenset({"parameters"}), frozenset({"unknown"}))
"""Hypotheses of a cause that no effect is named beside."""

BEYOND = 5.0
"""Floors from which a gap that repeats hardly ever have is one to explain; assumed."""

RARE = 0.002
"""Probability of a gap between repeats that is hardly ever met; assumed."""

UNUSUAL = 0.05
"""Probability without a cause of what has to be seldom for an alarm of models that have not seen
such sensors or responses; the customary level, assumed."""


def needs_explaining(
    none: float, alarm: float, gap: Gap | None = None, chance: float | None = None
) -> bool:
    """Return whether the gap needs an explanation.

    Parameters
    ----------
    none : float
        Probability [-] of nothing being the matter.
    alarm : float
        Below which there is something to explain [-].
    gap : Gap, optional
        Against simulated repeats; one that these hardly ever have needs explaining as well.
    chance : float, optional
        How often such an answer is given on this bench where nothing is the matter [-]; asked for
        where the probabilities were not learned with such a bench.

    Examples
    --------
    >>> needs_explaining(0.6, 0.05), needs_explaining(0.01, 0.05)
    (False, True)
    >>> needs_explaining(0.01, 0.05, chance=0.3)
    False
    """
    if gap is not None and gap.distance >= BEYOND and gap.p_value <= RARE:
        return True
    return none < alarm and (chance is None or chance <= UNUSUAL)


NAMED = 0.5
"""Probability from which on an effect is in a verdict [-]: it is likelier than not."""


def likeliest(
    hypotheses: Mapping[Hypothesis, float], fitted: Container[Hypothesis] | None = None
) -> tuple[str, ...]:
    """Return the causes of the likeliest hypothesis, the likeliest of them first.

    An effect that many sets share is likelier than any of these: it is weighed with all of them
    against the hypotheses that are no set of effects. What is less likely than not is not named,
    and where that is so of all of it, the cause is unknown.

    Parameters
    ----------
    hypotheses : mapping of frozenset of str to float
        [-]
    fitted : container of frozenset of str, optional
        Sets of effects that were fitted, and may be named; by default all may.

    Examples
    --------
    >>> likely = {frozenset({"clipping", "mains_hum"}): 0.5, frozenset({"mains_hum"}): 0.15,
    ...           frozenset({"unknown"}): 0.35}
    >>> likeliest(likely), likeliest(likely, [frozenset({"mains_hum"})])
    (('mains_hum', 'clipping'), ('mains_hum',))
    >>> likeliest({frozenset({"clipping"}): 0.4, frozenset({"mains_hum"}): 0.35})
    ('unknown',)
    """
    single = marginals(hypotheses)
    alone = [h for h in hypotheses if not h or h in ALONE]
    sets = [h for h in hypotheses if h not in alone and (fitted is None or h in fitted)]
    best = max(sets, key=lambda h: (max(single[name] for name in h), hypotheses[h]), default=None)
    apart = max(alone, key=lambda h: hypotheses[h], default=None)
    if best is None or (
        apart is not None and hypotheses[apart] >= max(single[name] for name in best)
    ):
        return tuple(apart or ())
    named = [name for name in best if single[name] >= NAMED]
    return tuple(sorted(named, key=lambda name: (-single[name], name))) or ("unknown",)
