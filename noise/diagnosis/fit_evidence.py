"""What fits say of which cause it is: the gap that each leaves on recordings no fit has seen.

A fit alone is a poor judge of causes, as one may stand in for another, and as one whose forms are
many finds more to fit. But where the first answer wavers between a few, that which leaves less is
the likelier one; how much likelier is one number, learned from cases whose cause is known.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.diagnosis.closing import root

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.diagnosis.closing import Scores

__all__ = ["gaps_left", "reranked"]

WEIGHT = 2.0
"""Of the logarithm of what is left, against that of a probability."""

_LEAST = 1e-4
"""Smallest probability; the first answer is never as sure as that."""


def gaps_left(scores: Mapping[str, Scores]) -> dict[str, float]:
    """Gap that each fit leaves; what is below the floor is the floor.

    Examples
    --------
    >>> import numpy as np
    >>> from noise.diagnosis.closing import Scores
    >>> gaps_left({"clipping": Scores(np.full(2, 9.0), np.full(2, 9.0), np.full(2, 4.0))})
    {'clipping': 2.0}
    """
    return {name: max(root(of.after), 1.0) for name, of in scores.items()}


def reranked(
    probabilities: Mapping[str, float], gaps: Mapping[str, float], weight: float = WEIGHT
) -> dict[str, float]:
    """Share out the probability of the causes that were fitted anew.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of the first answer.
    gaps : mapping of str to float
        Of the causes that were fitted, as `gaps_left` gives them.
    weight : float
        0 leaves the first answer as it is.

    Returns
    -------
    dict of str to float
        All of `probabilities`; those that were fitted keep their sum.

    Examples
    --------
    >>> first = {"clipping": 0.5, "gain_error": 0.4, "none": 0.1}
    >>> again = reranked(first, {"clipping": 3.0, "gain_error": 1.0})
    >>> again["gain_error"] > 0.7, round(sum(again.values()), 9)
    (True, 1.0)
    """
    known = [name for name in gaps if name in probabilities]
    scores = {
        name: math.log(max(probabilities[name], _LEAST)) - weight * math.log(gaps[name])
        for name in known
    }
    whole = sum(probabilities[name] for name in known)
    shares = {name: math.exp(score - max(scores.values())) for name, score in scores.items()}
    total = sum(shares.values())
    return {**probabilities, **{name: whole * x / total for name, x in shares.items()}}
