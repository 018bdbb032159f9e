"""Share of a gap that a fit closes, with its interval.

A share is that of what can be closed: a gap of one floor is none, and closing all of it is 1.
Beside the recordings, of which there are few, what is left after the fit is unsure, by as much as
one recording's distance is where nothing is left to explain.

How far the odds of a hypothesis change with what its fit closes.

Fits of right names close more of what refitted parameters leave, and the stage that they act in
differs more often. How much more often, was counted on cases whose cause is known; what the counts
say is stored as a likelihood ratio of right and wrong names, a logarithm that is linear in a few
shares. Of a gap that refitted parameters close nothing is left to tell names apart by, and the
ratio goes to one. The shares are of all recordings, those that were fitted to among them: held-out
ones alone are few, and an effect may show in the others.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.gap.distance import closed_fraction

if TYPE_CHECKING:
    from noise.diagnosis.findings import StageFinding


_HALF = 0.5
"""Floors above the floor at which a gap tells half as much as a large one; assumed, and the
weights were learned with it."""

_SURE = 0.05
"""p-value from which down a stage differs for sure; the customary level, assumed."""


@dataclass(frozen=True)
class ClosingOdds:
    """Logarithms of likelihood ratios, as linear functions.

    Parameters
    ----------
    none, parameters, effects : mapping of str to float
        Weights of what tells for and against each kind of hypothesis [-]: how much there is to
        close (``room``, by `room_of`) and to close still (``left``), what the fit closes of it
        (``closed``, by `closed_of`), whether the stage differs (``stage``, by `differing`), that
        there is one effect more than in another fit (``more``), and ``one``.
    enough : float
        Share that a fit has to close for its effects to be named, as `closed_of` has it [-].
    """

    none: Mapping[str, float]
    parameters: Mapping[str, float]
    effects: Mapping[str, float]
    enough: float

    def of_none(self, gap: float) -> float:
        """Logarithm of the ratio [-] for nothing being the matter, at a gap [floors]."""
        return self.none["one"] + self.none["room"] * room_of(gap)

    def of_parameters(self, before: float, recalibrated: float) -> float:
        """Logarithm of the ratio [-] for parameters, from gaps without and with them [floors]."""
        return (
            self.parameters["one"]
            + self.parameters["left"] * room_of(recalibrated)
            + self.parameters["closed"] * closed_of(before, recalibrated)
        )

    def of_effects(
        self,
        recalibrated: float,
        after: float,
        without_some: Sequence[float] = (),
        stages: Sequence[float] = (),
    ) -> float:
        """Logarithm of the ratio for effects.

        Parameters
        ----------
        recalibrated, after : float
            Gap with parameters alone, and with the effects In floors [-].
        without_some : sequence of float
            Gaps with all but some of the effects, where these were fitted: what is superfluous
            closes nothing of them In floors [-].
        stages : sequence of float
            `differing` of each stage that they act in and that was looked at, 1 where no other
            differs more surely [-].

        Returns
        -------
        float
            [-]
        """
        weights = self.effects
        total = weights["room"] * room_of(recalibrated)
        total += weights["closed"] * closed_of(recalibrated, after)
        total += weights["stage"] * (min(stages, default=1.0) - 1.0)
        return total + min([0.0, *(self.of_more(gap, after) for gap in without_some)])

    def of_more(self, before: float, after: float) -> float:
        """Logarithm of the ratio [-], 0 at most, for more effects than leave a gap [floors]."""
        return min(0.0, self.effects["more"] + self.effects["closed"] * closed_of(before, after))


def room_of(gap: float) -> float:
    """How much there is to close, from 0 at the floor to 1 [-].

    Parameters
    ----------
    gap : float
        In floors [-].

    Examples
    --------
    >>> room_of(0.9), room_of(1.5), round(room_of(20.0), 2)
    (0.0, 0.5, 0.97)
    """
    above = max(gap - 1.0, 0.0)
    return above / (above + _HALF)


def closed_of(before: float, after: float) -> float:
    """Share of a gap that is closed, of small gaps less, between -1 and 1 [-].

    Parameters
    ----------
    before, after : float
        In floors [-].

    Examples
    --------
    >>> closed_of(5.0, 1.0), closed_of(1.5, 1.0), closed_of(2.0, 90.0)
    (0.888..., 0.5, -1.0)
    """
    above, left = max(before - 1.0, 0.0), max(after - 1.0, 0.0)
    return min(max((above - left) / (above + _HALF), -1.0), 1.0)


def differing(stage: StageFinding) -> float | None:
    """How surely a stage differs, from 0 to 1 [-]; None where nothing of it was recorded.

    Examples
    --------
    >>> from noise.diagnosis.findings import StageFinding
    >>> differing(StageFinding(7.0, 0.8, 0.001)), differing(StageFinding(1.0, 0.0, 1.0))
    (1.0, 0.0)
    """
    if not stage.gap > 0.0:
        return None
    return min(math.log(max(stage.p_value, _SURE)) / math.log(_SURE), 1.0) + 0.0


@cache
def load_closing_odds() -> ClosingOdds:
    """Load the ratios that are shipped."""
    path = resources.files("noise.diagnosis") / "data" / "closing.json"
    found = json.loads(path.read_text(encoding="utf-8"))
    return ClosingOdds(found["none"], found["parameters"], found["effects"], found["enough"])


CLOSABLE = 0.5
"""A gap is worth closing from so many floors above the floor; assumed."""

_FLOOR_SPREAD = 0.35
"""Standard deviation of one recording's distance where nothing is left to explain; assumed. Of 66
recordings of quiet development cases without a cause (seed 4) it is 0.36."""

_LEVEL = (5.0, 95.0)
_DRAWS = 400


@dataclass(frozen=True, eq=False)
class Scores:
    """Squared distances of held-out recordings from three models, one entry a recording.

    Parameters
    ----------
    before, recalibrated, after : ndarray, shape (n,)
        From the rig file's, from that with other parameters, from that with effects In squared
        floors [-].
    """

    before: NDArray[np.float64]
    recalibrated: NDArray[np.float64]
    after: NDArray[np.float64]


def rms(squared: NDArray[np.float64]) -> float:
    """Root mean square distance of recordings.

    Parameters
    ----------
    squared : ndarray, shape (n,)
        Distances in squared floors [-].

    Returns
    -------
    float
        In floors [-].

    Examples
    --------
    >>> rms(np.array([1.0, 7.0]))
    2.0
    """
    return float(np.sqrt(np.mean(squared)))


def closed_share(before: NDArray[np.float64], after: NDArray[np.float64]) -> float | None:
    """Share of the closable gap; None where there is less than `CLOSABLE` to close.

    Parameters
    ----------
    before, after : ndarray, shape (n,)
        Distances of recordings in squared floors [-].

    Returns
    -------
    float or None
        [-]

    Examples
    --------
    >>> closed_share(np.array([9.0]), np.array([4.0])), closed_share(np.array([2.0]), np.ones(1))
    (0.5, None)
    """
    gap, left = rms(before), max(rms(after), 1.0)
    return None if gap - 1.0 < CLOSABLE else closed_fraction(gap, left)


def closed_interval(scores: Scores, seed: int = 0) -> tuple[float, float] | None:
    """90 % interval of the share that the effect closes; None where there is nothing to close.

    Parameters
    ----------
    scores : Scores
    seed : int
        Of the bootstrap over recordings.

    Examples
    --------
    >>> sure = Scores(np.full(4, 400.0), np.full(4, 300.0), np.ones(4))
    >>> low, high = closed_interval(sure)
    >>> 0.95 < low < high == 1.0
    True
    """
    share = closed_share(scores.before, scores.after)
    if share is None:
        return None
    rng = np.random.default_rng(seed)
    n = len(scores.before)
    found = []
    for _ in range(_DRAWS):
        place = rng.integers(n, size=n)
        gap = rms(scores.before[place])
        if gap - 1.0 < CLOSABLE:
            gap = rms(scores.before)
        left = rms(scores.after[place]) + _FLOOR_SPREAD / np.sqrt(n) * rng.standard_normal()
        found.append(closed_fraction(gap, max(left, 1.0)))
    low, high = np.percentile(found, _LEVEL).tolist()
    return min(low, share), max(high, share)
