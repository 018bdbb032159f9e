"""Hypotheses from causes taken one by one, and causes from hypotheses.

A hypothesis is the set of causes that are at work: none, ``parameters`` or ``unknown`` by itself,
or up to three effects.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

Hypothesis = frozenset[str]

_EXCLUSIVE = ("none", "parameters", "unknown")
_LEAST = 1e-4
"""Probabilities are held this far from 0 and 1 [-]: no library is large enough to tell more."""


def joint_probabilities(probabilities: Mapping[str, float]) -> dict[Hypothesis, float]:
    """Probability of each hypothesis, the causes taken for independent.

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
        cause: kept / (1.0 - kept)
        for cause, p in probabilities.items()
        if p > 0.0
        for kept in [min(max(p, _LEAST), 1.0 - _LEAST)]
    }
    effects = [cause for cause in odds if cause not in _EXCLUSIVE]
    weights = {frozenset(set() if c == "none" else {c}): odds.get(c, 0.0) for c in _EXCLUSIVE}
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
    """Give nothing being the matter a probability, at the expense of all others alike.

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
    """Probability of each cause being at work.

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
    found: dict[str, float] = {}
    for hypothesis, p in joint.items():
        for cause in sorted(hypothesis or {"none"}):
            found[cause] = found.get(cause, 0.0) + p
    return found
