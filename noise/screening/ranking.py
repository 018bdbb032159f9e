"""Which design is quieter: one number each, and the order that follows.

A point of use counts by how loud it is: 2 to the power of (L_AFmax - 40 dB) / 10, Stevens' rule
that ten decibels are twice as loud, and nothing where there is no noise. The mean over all points
of use is a design's exposure. Shares of points alone would rank a faint squeal with a loud creak,
and the loudest point alone would not see how much of the use is noisy. Between designs that are
equally quiet the larger margin goes first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from noise.screening.batches import LABELS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.screening.mapping import DesignMap
    from noise.screening.margins import CriticalPoint

__all__ = ["Standing", "loudness_weight", "standings"]

_DECIMALS = 9


@dataclass(frozen=True)
class Standing:
    """How a design does in one environment and motion.

    Parameters
    ----------
    rank : int
        Of the design among all, by its mean exposure over environments and motions; 1 is quietest.
    design, environment, motion : str
    exposure : float
        Mean of the points of use, 1 being 40 dB(A) throughout.
    shares : dict of str to float
        Of the points of use, by label.
    loudest_level : float
        L_AFmax of the loudest point of use with a noise [dB re 20 uPa]; NaN if there is none.
    loudest_label : str
        Its noise, ``none`` if there is none.
    v_crit1, v_crit2 : float
        Largest of all fits, supports and temperatures [rad/s]; NaN where the shaft swings.
    margin_v_crit1, margin_v_crit2, margin_stability : float
        Smallest likewise.
    """

    rank: int
    design: str
    environment: str
    motion: str
    exposure: float
    shares: dict[str, float]
    loudest_level: float
    loudest_label: str
    v_crit1: float
    v_crit2: float
    margin_v_crit1: float
    margin_v_crit2: float
    margin_stability: float


def loudness_weight(level: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how loud levels are, 1 at 40 dB(A), doubled every 10 dB.

    Examples
    --------
    >>> loudness_weight(np.array([40.0, 60.0]))
    array([1., 4.])
    """
    return np.asarray(2.0 ** ((level - 40.0) / 10.0))


def standings(maps: Sequence[DesignMap], critical: Sequence[CriticalPoint]) -> tuple[Standing, ...]:
    """Rank mapped designs, the quietest first."""
    found = [_standing(mapped, critical) for mapped in maps]
    means: dict[str, tuple[float, float]] = {}
    for design in dict.fromkeys(one.design for one in found):
        own = [one for one in found if one.design == design]
        margins = [one.margin_v_crit2 for one in own if not np.isnan(one.margin_v_crit2)]
        exposure = round(float(np.mean([one.exposure for one in own])), _DECIMALS)
        means[design] = exposure, -min(margins, default=0.0)
    order = sorted(means, key=lambda design: means[design])
    rank = {design: 1 + order.index(design) for design in order}
    for before, after in pairwise(order):
        if means[before] == means[after]:
            rank[after] = rank[before]
    placed = [replace(one, rank=rank[one.design]) for one in found]
    return tuple(sorted(placed, key=lambda one: (one.rank, one.design)))


def _standing(mapped: DesignMap, critical: Sequence[CriticalPoint]) -> Standing:
    speed = np.array(mapped.grid.speed)
    low, high = mapped.grid.use
    used = (speed >= low * (1.0 - 1e-9)) & (speed <= high * (1.0 + 1e-9))
    if not used.any():
        used[np.argmin(np.abs(speed - 0.5 * (low + high)))] = True
    label, level = mapped.label[..., used], mapped.level[..., used]
    noisy = (label != "none") & np.isfinite(level)
    loudest = np.unravel_index(np.argmax(np.where(noisy, level, -np.inf)), level.shape)
    own = [
        point
        for point in critical
        if (point.design, point.environment) == (mapped.design, mapped.environment)
        and mapped.motion == "steady"
    ]
    nothing = float("nan")
    return Standing(
        rank=0,
        design=mapped.design,
        environment=mapped.environment,
        motion=mapped.motion,
        exposure=float(np.sum(loudness_weight(level[noisy])) / label.size),
        shares={name: float(np.mean(label == name)) for name in LABELS},
        loudest_level=float(level[loudest]) if noisy.any() else nothing,
        loudest_label=str(label[loudest]) if noisy.any() else "none",
        v_crit1=max((point.v_crit1 for point in own), default=nothing),
        v_crit2=max((point.v_crit2 for point in own), default=nothing),
        margin_v_crit1=min((point.margin_v_crit1 for point in own), default=nothing),
        margin_v_crit2=min((point.margin_v_crit2 for point in own), default=nothing),
        margin_stability=min((point.margin_stability for point in own), default=nothing),
    )
