"""Standing of each design in each environment and motion, and its rank among all.

Designs are ranked by one number, the mean loudness of their use: a condition counts 2 to the power
of (L_AFmax - 40 dB) / 10, Stevens' rule that ten decibels are twice as loud, and nothing where
there is no noise; a vibration that only persists counts as what is heard of it. The worst of a
design's environments and motions counts, and the larger margin decides between equals. All maps are
over the same points, or are refused.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.show import short_repr
from noise.base.labels import PERSISTS
from noise.screening.advice import Offer
from noise.screening.grid import Grid
from noise.screening.mapping import DesignMap
from noise.screening.margins import CriticalPoint
from noise.screening.parts import Robustness
from noise.screening.vibration import Condition
from noise.screening.words import use_words

SHARED = ("creak", "squawk", "squeal", "none", PERSISTS)
"""Labels of a map, of which shares are told."""


@short_repr
@dataclass(frozen=True)
class Standing:
    """How a design does in one environment and motion.

    Parameters
    ----------
    rank : int, optional
        Of the design among all, 1 being quietest; None where the contact never slips.
    design, environment, motion : str
    mean_loudness : float
        Of the use [sone].
    shares : dict of str to float
        Of the points of use, by label [-].
    loudest : Condition, optional
        The loudest of use; None where nothing is heard.
    loudest_label : str
        Its noise, ``none`` if there is none.
    loudest_level, loudest_level_max : float
        Its L_Aeq and L_AFmax [dB re 20 uPa]; NaN if there is none.
    v_crit1, v_crit2, v_crit2_high : float
        Largest of all fits, supports and temperatures [rad/s]; NaN where the shaft swings.
    margin_v_crit1, margin_v_crit2, margin_stability : float
        Smallest likewise [rad/s].
    offers : tuple of Offer
        Changes that end the loudest noise of use, and those that do not.
    robustness : Robustness, optional
        What tolerances do, where it was asked for.
    never_slips : str
        Why the contact never slips; empty where it does.
    words, advice : str
        Whether it is quiet and where not; what to change.
    notes : tuple of str
        What to know of its numbers.
    failed : tuple of str
        What could not be told, and why.
    """

    rank: int | None
    design: str
    environment: str
    motion: str
    mean_loudness: float
    shares: dict[str, float]
    loudest: Condition | None
    loudest_label: str
    loudest_level: float
    loudest_level_max: float
    v_crit1: float
    v_crit2: float
    v_crit2_high: float
    margin_v_crit1: float
    margin_v_crit2: float
    margin_stability: float
    offers: tuple[Offer, ...] = ()
    robustness: Robustness | None = None
    never_slips: str = ""
    words: str = ""
    advice: str = ""
    notes: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()


def loudness_weight(level: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how loud levels are, 1 at 40 dB(A), doubled every 10 dB.

    Parameters
    ----------
    level : ndarray, any shape
        [dB(A)]

    Returns
    -------
    ndarray
        Of the same shape [sone].

    Examples
    --------
    >>> loudness_weight(np.array([40.0, 60.0]))
    array([1., 4.])
    """
    return np.asarray(2.0 ** ((level - 40.0) / 10.0))


def standing_of(
    found: DesignMap, critical: Sequence[CriticalPoint], never_slips: str = ""
) -> Standing:
    """Tell how a mapped design does; its rank is open.

    Parameters
    ----------
    found : DesignMap
    critical : sequence of CriticalPoint
        Of this map.
    never_slips : str
        Why the contact never slips; empty where it does.

    Returns
    -------
    Standing
    """
    used = found.grid.used
    label, sound, level, level_max = (
        each[..., used] for each in (found.label, found.sound, found.level, found.level_max)
    )
    noisy = (sound != "none") & np.isfinite(level)
    loudest = np.unravel_index(np.argmax(np.where(noisy, level, -np.inf)), level.shape)
    nothing, any_noise = math.nan, bool(noisy.any())
    return Standing(
        rank=None,
        design=found.design,
        environment=found.environment,
        motion=found.motion,
        mean_loudness=float(np.sum(loudness_weight(level_max[noisy])) / label.size),
        shares={name: float(np.mean(label == name)) for name in SHARED},
        loudest=condition_at(found.grid, loudest) if any_noise else None,
        loudest_label=str(sound[loudest]) if any_noise else "none",
        loudest_level=float(level[loudest]) if any_noise else nothing,
        loudest_level_max=float(level_max[loudest]) if any_noise else nothing,
        v_crit1=max((point.v_crit1 for point in critical), default=nothing),
        v_crit2=max((point.v_crit2 for point in critical), default=nothing),
        v_crit2_high=max((point.v_crit2_high for point in critical), default=nothing),
        margin_v_crit1=min((point.margin_v_crit1 for point in critical), default=nothing),
        margin_v_crit2=min((point.margin_v_crit2 for point in critical), default=nothing),
        margin_stability=min((point.margin_stability for point in critical), default=nothing),
        never_slips=never_slips,
        words=use_words(found, never_slips),
    )


def condition_at(grid: Grid, at: Sequence[int | np.integer]) -> Condition:
    """Return the condition at a point of use, by its indices among the speeds of use."""
    t, k, i, v = (int(n) for n in at)
    columns = np.flatnonzero(grid.used)
    return Condition(
        grid.speed[columns[v]],
        grid.interference[i],
        grid.support_stiffness[k],
        grid.temperature[t],
        grid.frequency[columns[v]] if grid.frequency else None,
    )


def ranked(found: Sequence[Standing]) -> tuple[Standing, ...]:
    """Rank designs by mean loudness and then by margin, the quietest first.

    Parameters
    ----------
    found : sequence of Standing
        Of designs in environments and motions; the worst of each design counts.

    Returns
    -------
    tuple of Standing
        Those without a rank are the last; equals share one.
    """
    keys: dict[str, tuple[float, float]] = {}
    for one in found:
        margin = -math.inf if math.isnan(one.margin_v_crit2) else one.margin_v_crit2
        key = round(one.mean_loudness, 6), -margin
        keys[one.design] = max(keys.get(one.design, key), key)
    for one in found:
        if one.never_slips and one.motion == "steady":
            keys.pop(one.design, None)
    order = sorted(keys.values())
    ranks = {name: 1 + order.index(key) for name, key in keys.items()}
    standings = [replace(one, rank=ranks.get(one.design)) for one in found]
    return tuple(sorted(standings, key=lambda one: (one.rank or math.inf, one.design)))


def refuse_unlike(maps: Sequence[DesignMap]) -> None:
    """Refuse maps of which not all designs have the same points.

    Raises
    ------
    ParameterError
        They have not; a rank would then be a matter of where was looked.
    """
    points: dict[str, set[tuple[str, str, Grid]]] = {}
    for mapped in maps:
        where = mapped.environment, mapped.motion, mapped.grid
        points.setdefault(mapped.design, set()).add(where)
    first = next(iter(points), "")
    for name in points:
        if points[name] != points[first]:
            raise ParameterError(
                f"designs {first} and {name} are not mapped over the same points, and cannot be "
                "ranked"
            )
