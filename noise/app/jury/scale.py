"""The scale that votes tell: a value for each sound, with its 95 % interval.

A difference d means that the higher of two sounds is chosen exp(d) times as often as the other;
the mean of all values is zero. Intervals are where twice the logarithm of the likelihood is less
than 3.84 below its highest, all other values being the likeliest (profile likelihood); with few
votes they are not symmetric, and hold better than those of Fisher's information. They tell how
surely these votes place a sound, as though all were independent: they do not tell how another
person would vote.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.app.jury.likelihood import Likelihood

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.app.jury.votes import Vote

    Array = NDArray[np.float64]

__all__ = ["Placed", "Scale", "scale"]

_SURE_95 = 3.8415
"""Of chi-squared with one degree of freedom [-]."""

_TRIES = 60
_CLOSE = 2e-3
"""How closely the ends of an interval are found, of its half width [-]."""


@dataclass(frozen=True)
class Placed:
    """A sound on the scale.

    Parameters
    ----------
    value, low, high : float or None
        Where it is, and its 95 % interval; None without votes.
    chosen, not_chosen, no_difference : int
        Votes [-].
    group : int
        Values of different groups cannot be compared.
    """

    value: float | None
    low: float | None
    high: float | None
    chosen: int
    not_chosen: int
    no_difference: int
    group: int

    @property
    def votes(self) -> int:
        """In which it was compared."""
        return self.chosen + self.not_chosen + self.no_difference


@dataclass(frozen=True)
class Scale:
    """Sounds in the order in which they were given, and what is to be known of their values."""

    sounds: tuple[Placed, ...]
    remarks: tuple[str, ...]


def scale(names: Sequence[str], votes: Sequence[Vote]) -> Scale:
    """Return the scale of sounds.

    Parameters
    ----------
    names : sequence of str
        Of the sounds.
    votes : sequence of Vote
        Of which each tells the numbers of two of these sounds.

    Examples
    --------
    >>> from noise.app.jury.votes import Vote
    >>> found = scale(["calm", "loud"], [Vote(0, 1, "second")] * 7 + [Vote(1, 0, "second")] * 3)
    >>> calm, loud = found.sounds
    >>> round(loud.value - calm.value, 3), loud.chosen, loud.low < loud.value < loud.high
    (0.762, 7, True)
    """
    from scipy.sparse.csgraph import connected_components

    n = len(names)
    wins, ties = np.zeros((n, n)), np.zeros((n, n))
    for vote in votes:
        if vote.chosen is None:
            ties[vote.first, vote.second] += 1
            ties[vote.second, vote.first] += 1
        else:
            wins[vote.chosen, vote.other] += 1
    groups = _groups(wins + wins.T + ties)
    found: dict[int, Placed] = {}
    for number, members in enumerate(groups):
        part = np.ix_(members, members)
        for place, (value, low, high) in zip(members, _fit(wins[part], ties[part]), strict=True):
            chosen, not_chosen = int(wins[place].sum()), int(wins[:, place].sum())
            equal = int(ties[place].sum())
            found[place] = Placed(value, low, high, chosen, not_chosen, equal, number)
    placed = tuple(found[place] for place in range(n))
    parts = connected_components(wins + ties > 0.0, connection="strong")[0]
    return Scale(placed, tuple(_remarks(names, placed, groups, parts)))


def _groups(compared: Array) -> list[list[int]]:
    """Part sounds into those that votes join, directly or by way of others; the largest first."""
    from scipy.sparse.csgraph import connected_components

    count, label = connected_components(compared > 0.0, directed=False)
    parts = [np.flatnonzero(label == number).tolist() for number in range(count)]
    return sorted(parts, key=lambda part: (-len(part), part))


def _fit(wins: Array, ties: Array) -> list[tuple[float | None, float | None, float | None]]:
    n = len(wins)
    if n == 1:
        return [(None, None, None)]
    first, second = np.nonzero(np.triu(wins + wins.T + ties))
    counts = np.stack([wins[first, second], wins[second, first], ties[first, second]], axis=1)
    likelihood = Likelihood(n, np.stack([first, second], axis=1), counts)
    free = likelihood.free
    start = np.zeros(n + 1)
    best, _ = likelihood.highest(start, free, free.T @ likelihood.information(start) @ free)
    curvature = likelihood.curvature(best)
    best, height = likelihood.highest(best, free, curvature)
    ends = [
        [_end(likelihood, best, height, curvature, place, side) for side in (-1.0, 1.0)]
        for place in range(n)
    ]
    return [(float(best[place]), low, high) for place, (low, high) in enumerate(ends)]


def _end(
    likelihood: Likelihood, best: Array, height: float, curvature: Array, place: int, side: float
) -> float:
    """Return where the likelihood with one value held has fallen by what 95 % allow."""
    row = likelihood.free[place]
    # Directions that leave this value as it is, and the likeliest one that moves it by one.
    held = np.linalg.svd(row[None])[2][1:].T
    others, across = likelihood.free @ held, held.T @ curvature @ held
    towards = np.linalg.solve(curvature, row)
    moving = likelihood.free @ towards / (row @ towards)
    allowed = 0.5 * _SURE_95
    width = math.sqrt(2.0 * allowed * float(row @ towards))
    low, high, away = 0.0, math.inf, width
    at = best
    for _ in range(_TRIES):
        start = at + moving * (best[place] + side * away - at[place])
        at, reached = likelihood.highest(start, others, across)
        if height - reached < allowed:
            low = max(low, away)
        else:
            high = min(high, away)
        # The root of how far it has fallen is nearly a straight line.
        fallen = math.sqrt(max(height - reached, 1e-12))
        slope = -side * float(likelihood.value_and_slope(at)[1] @ moving) / (2.0 * fallen)
        step = (math.sqrt(allowed) - fallen) / slope if slope > 0.0 else math.inf
        if abs(step) < _CLOSE * width:
            away += step
            break
        away += min(step, 2.0 * width)
        if not low < away < high:
            away = 0.5 * (low + high) if math.isfinite(high) else low + width
    return float(best[place] + side * away)


def _remarks(
    names: Sequence[str],
    placed: Sequence[Placed],
    groups: Sequence[Sequence[int]],
    parts: int,
) -> list[str]:
    """Say what is to be known; `parts` are as many as no votes join in both directions."""
    if any(one.votes for one in placed) and not any(one.chosen for one in placed):
        return ["no sound was chosen over another, so nothing tells them apart"]
    remarks = []
    unheard = [name for name, one in zip(names, placed, strict=True) if not one.votes]
    if unheard and len(unheard) < len(names):
        remarks.append(f"not compared yet, so not on the scale: {_listed(unheard)}")
    joined = [group for group in groups if len(group) > 1]
    if len(joined) > 1:
        remarks.append(
            f"no vote joins these {len(joined)} groups, so that values of one say nothing of "
            "another: " + "; ".join(_listed([names[place] for place in group]) for group in joined)
        )
    for count, word in (("not_chosen", "chosen in all comparisons"), ("chosen", "never chosen")):
        beyond = [
            name
            for name, one in zip(names, placed, strict=True)
            if one.votes and not getattr(one, count) and not one.no_difference
        ]
        if beyond:
            remarks.append(
                f"{word}: {_listed(beyond)}; how far beyond the others these votes do not tell, "
                "and value and outer end of the interval rest on Firth's correction"
            )
    if parts > len(joined) + len(unheard):
        remarks.append(
            f"no vote contradicts the order of {parts - len(unheard)} groups of sounds, so how far "
            "these stand apart rests on Firth's correction as well"
        )
    return remarks


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names)
