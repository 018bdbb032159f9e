"""Which sounds are compared, in which order, and which of two is the first.

Sounds stand in a circle, in random order, and each is compared with those that are certain numbers
of steps away. With all numbers of steps, these are all pairs; with some of them, each sound is
compared equally often and all are joined, since the next neighbours are always compared. Of each
number of steps a sound is the first once and the second once, so sides are balanced.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    Pair = tuple[int, int]

__all__ = ["Design", "ordered_pairs"]

_TRIES = 20


@dataclass(frozen=True)
class Design:
    """How many comparisons there are.

    Parameters
    ----------
    n : int
        Sounds.
    each : int
        With so many others is each compared, at most [-].
    repeats : float
        Share of pairs that come a second time, with sides changed [-].

    Examples
    --------
    >>> Design(10, 20, 0.2).pairs, Design(10, 20, 0.2).again, Design(30, 8, 0.0).pairs
    (45, 9, 120)
    """

    n: int
    each: int
    repeats: float

    @property
    def steps(self) -> int:
        """Numbers of steps at which neighbours are compared."""
        most = self.n // 2
        return most if self.each >= self.n - 1 else max(1, min(self.each // 2, most))

    @property
    def pairs(self) -> int:
        """Different pairs."""
        if self.steps == self.n // 2:
            return self.n * (self.n - 1) // 2
        return self.n * self.steps

    @property
    def again(self) -> int:
        """Pairs that come a second time."""
        return round(self.repeats * self.pairs)


def ordered_pairs(design: Design, rng: np.random.Generator) -> list[Pair]:
    """Return all comparisons in a random order.

    No sound comes twice in a row where that can be avoided, which takes five sounds; a pair comes
    again only in the second half.

    Parameters
    ----------
    design : Design
    rng : Generator

    Returns
    -------
    list of tuple
        Numbers of the first and of the second sound.

    Examples
    --------
    >>> ordered_pairs(Design(3, 2, 0.0), np.random.default_rng(1))
    [(0, 2), (1, 0), (2, 1)]
    """
    pairs = _pairs(design, rng)
    tries = (_spread(pairs, rng) for _ in range(_TRIES))
    order = min(_until_perfect(tries), key=_clashes)
    half = (len(order) + 1) // 2
    chosen = rng.permutation(half if design.again <= half else len(order))[: design.again]
    for place in sorted(chosen.tolist()):
        first, second = order[place]
        _insert(order, (second, first), max(place + 2, half), rng)
    return order


def _pairs(design: Design, rng: np.random.Generator) -> list[Pair]:
    n, most = design.n, design.n // 2
    circle = rng.permutation(n).tolist()
    further = (rng.permutation(np.arange(2, most + 1))[: design.steps - 1]).tolist()
    if design.steps < most and n % 2 == 0:  # half a turn is but half as many pairs
        further = (rng.permutation(np.arange(2, most))[: design.steps - 1]).tolist()
    found = []
    for step in (1, *further):
        half_turn = 2 * step == n
        turned = rng.random() < 0.5
        for place in range(step if half_turn else n):
            pair = circle[place], circle[(place + step) % n]
            if half_turn:  # each sound is in one of these pairs alone
                turned = rng.random() < 0.5
            found.append(pair[::-1] if turned else pair)
    return found


def _spread(pairs: list[Pair], rng: np.random.Generator) -> list[Pair]:
    """Put pairs into an order by which the next has neither sound of the one before."""
    left = [pairs[place] for place in rng.permutation(len(pairs))]
    waiting = np.bincount(np.array(pairs).ravel())
    order: list[Pair] = []
    while left:
        last = set(order[-1]) if order else set()
        free = [at for at, pair in enumerate(left) if last.isdisjoint(pair)] or range(len(left))
        # The sounds that are left most often have to be taken, or they come in a row at the end.
        at = max(free, key=lambda at: waiting[left[at][0]] + waiting[left[at][1]] + rng.random())
        pair = left.pop(at)
        waiting[list(pair)] -= 1
        order.append(pair)
    return order


def _until_perfect(orders: Iterable[list[Pair]]) -> Iterable[list[Pair]]:
    for order in orders:
        yield order
        if not _clashes(order):
            return


def _clashes(order: list[Pair]) -> int:
    """Count how often a sound comes twice in a row."""
    return sum(not set(one).isdisjoint(other) for one, other in pairwise(order))


def _insert(order: list[Pair], pair: Pair, earliest: int, rng: np.random.Generator) -> None:
    """Put a pair where it clashes least, at a random one of such places."""
    places = rng.permutation(np.arange(min(earliest, len(order)), len(order) + 1)).tolist()
    place = min(
        places, key=lambda at: _clashes([*order[max(0, at - 1) : at], pair, *order[at : at + 1]])
    )
    order.insert(place, pair)
