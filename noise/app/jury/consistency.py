"""Whether a person's votes can be trusted: triads that go in a circle, repeats, a favoured side.

Each says in one line when to distrust, and says nothing where chance alone would often do as badly
in a careful person. What is too little to tell is said, too. Circles are those of M. G. Kendall and
B. Babington Smith (Biometrika 31, 324, 1940).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.app.jury.votes import EQUAL, FIRST

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from noise.app.jury.votes import Vote

__all__ = ["Consistency", "circular_triads", "consistency"]

_LEVEL = 0.05
"""What happens by chance more seldom than this is not put down to it [-]."""

_DRAWS = 2000
"""Of votes by tossing a coin [-]."""


@dataclass(frozen=True)
class Consistency:
    """How well votes agree with each other.

    Parameters
    ----------
    circular, triads : int
        Triads that go in a circle, of those whose three pairs were decided at first [-].
    zeta : float or None
        Kendall's coefficient: 1 without circles, 0 with as many as there can be; None where not
        all pairs were decided [-].
    alike, repeats : int
        Pairs that were answered alike when they came again with sides changed, of so many [-].
    first, decided : int
        Votes for what was called A, of those for either [-].
    remarks : tuple of str
        When to distrust.
    """

    circular: int
    triads: int
    zeta: float | None
    alike: int
    repeats: int
    first: int
    decided: int
    remarks: tuple[str, ...]


def consistency(n: int, votes: Sequence[Vote], rng: np.random.Generator) -> Consistency:
    """Return how far votes can be trusted.

    Parameters
    ----------
    n : int
        Sounds.
    votes : sequence of Vote
        In their order.
    rng : Generator
        Of votes by tossing a coin, to compare with.

    Examples
    --------
    >>> from noise.app.jury.votes import Vote
    >>> circle = [Vote(0, 1, "first"), Vote(1, 2, "first"), Vote(2, 0, "first")]
    >>> found = consistency(3, circle, np.random.default_rng(1))
    >>> found.circular, found.triads, found.zeta
    (1, 1, 0.0)
    """
    remarks: list[str] = []
    answers = _answers(votes).values()
    beats = np.zeros((n, n), bool)
    for first, *_ in answers:
        if first.chosen is not None:
            beats[first.chosen, first.other] = True
    circular, triads = circular_triads(beats)
    zeta = None
    if n >= 3 and (beats | beats.T).sum() == n * (n - 1):
        most = (n**3 - n) // 24 if n % 2 else (n**3 - 4 * n) // 24
        zeta = 1.0 - circular / most
    remarks += _of_triads(beats, circular, triads, rng)
    again = [vote.chosen == first.chosen for first, *others in answers for vote in others]
    remarks += _of_repeats(sum(again), len(again))
    decided = [vote for vote in votes if vote.said != EQUAL]
    n_first = sum(vote.said == FIRST for vote in decided)
    remarks += _of_sides(n_first, len(decided))
    return Consistency(
        circular, triads, zeta, sum(again), len(again), n_first, len(decided), tuple(remarks)
    )


def circular_triads(beats: NDArray[np.bool_]) -> tuple[int, int]:
    """Count the triads of which each is chosen over the next, and all that are decided.

    Parameters
    ----------
    beats : ndarray of bool, shape (n, n)
        Whether the sound of a row was chosen over that of a column.

    Examples
    --------
    >>> circular_triads(np.roll(np.eye(3, dtype=bool), 1, axis=1))
    (1, 1)
    """
    chosen = beats.astype(float)
    decided = chosen + chosen.T
    return round(np.trace(chosen @ chosen @ chosen) / 3.0), round(
        np.trace(decided @ decided @ decided) / 6.0
    )


def _answers(votes: Iterable[Vote]) -> dict[frozenset[int], list[Vote]]:
    """Return all votes on each pair."""
    answers: dict[frozenset[int], list[Vote]] = defaultdict(list)
    for vote in votes:
        answers[vote.pair].append(vote)
    return answers


def _of_triads(
    beats: NDArray[np.bool_], circular: int, triads: int, rng: np.random.Generator
) -> list[str]:
    if not triads:
        return []
    pairs = np.argwhere(np.triu(beats | beats.T))
    by_chance = np.empty(_DRAWS)
    for draw in range(_DRAWS):
        tossed = np.zeros_like(beats)
        heads = rng.random(len(pairs)) < 0.5
        tossed[pairs[heads, 0], pairs[heads, 1]] = True
        tossed[pairs[~heads, 1], pairs[~heads, 0]] = True
        by_chance[draw] = circular_triads(tossed)[0]
    said = f"{circular} of {triads} triads go in a circle"
    if (by_chance == 0).mean() > _LEVEL:  # a coin, too, often makes none
        return [f"{said}; these are too few to tell votes from chance"] if circular else []
    if (by_chance <= circular).mean() > _LEVEL:
        return [
            f"{said} (A over B, B over C, C over A), as votes by tossing a coin would have it: "
            "the sounds are hardly told apart, or not by one quality; distrust the scale"
        ]
    return []


def _of_repeats(alike: int, repeats: int) -> list[str]:
    from scipy.stats import binom

    if not repeats or alike == repeats:
        return []
    said = f"{alike} of {repeats} repeated pairs were answered alike"
    if float(binom.sf(repeats - 1, repeats, 0.5)) > _LEVEL:
        return [f"{said}; these are too few to tell votes from chance"]
    if float(binom.sf(alike - 1, repeats, 0.5)) > _LEVEL:
        return [f"{said}, as tossing a coin would have it: distrust the scale"]
    return []


def _of_sides(first: int, decided: int) -> list[str]:
    from scipy.stats import binomtest

    if not decided or binomtest(first, decided).pvalue > _LEVEL:
        return []
    side, votes = ("first", first) if 2 * first > decided else ("second", decided - first)
    return [
        f"the {side} of two was chosen in {votes} of {decided} decided votes: the side was "
        "favoured, not the sound alone; distrust small differences"
    ]
