"""Standing of each design in each environment and motion, and its rank among all.

The rank is that of `noise.screening.ranking.risk.ranked`: by risk, by how probably there is noise,
and by margin, the worst of a design's environments and motions counting. All maps are over the same
points, or are refused. How probably is told by
the parts where those of all designs were looked at; else by the share of the points of use that are
noisy, of all designs alike, since the two must not be compared with each other.

The exposure stands beside it, and says how loud the use is: a point counts 2 to the power of
(L_AFmax - 40 dB) / 10, Stevens' rule that ten decibels are twice as loud, and nothing where there
is no noise.

Advice in words: the least change that widens the margin, and the least that ends the noise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.show import short_repr
from noise.screening.design.tolerances import PARAMETERS
from noise.screening.map.batches import LABELS
from noise.screening.parts.estimate import Estimate
from noise.screening.ranking.plain_words import plain_words
from noise.screening.ranking.risk import Candidate, ranked

if TYPE_CHECKING:
    from noise.screening.map.grid import Grid
    from noise.screening.map.mapping import DesignMap
    from noise.screening.parts.statistics import Statistics
    from noise.screening.ranking.margins import CriticalPoint


def advice_words(one: Statistics) -> str:
    """Tell the least change that widens the margin, and the least that ends the noise."""
    stands = one.robustness
    if stands is None:
        return ""
    said = []
    for aim, advised in (("margin", stands.margin_advice), ("noise", stands.noise_advice)):
        enough = [found for found in advised if found.enough]
        # What stands on an island is the worse advice, however small the change.
        best = next((found for found in enough if found.steady), next(iter(enough), None))
        if best is None and advised:
            said.append(f"no single change {_FAILS[aim]}")
        if best is not None:
            to = f"{one.nominal[best.name] * best.value:.3g} {PARAMETERS[best.name]}"
            brings = _DOES[aim]
            if aim == "margin":
                by = f"{brings} by {best.gain:.2g} rad/s"
                brings = by if math.isfinite(best.gain) else "leaves no speed that vibrates"
            said.append(f"{best.name} {best.change:+.1%} to {to} {brings}")
    return "; ".join(said)


_DOES = {"margin": "widens the margin", "noise": "ends the noise in the middle of the use"}

_FAILS = {
    "margin": "widens the margin as far as asked",
    "noise": "ends the noise in the middle of the use",
}


@short_repr
@dataclass(frozen=True)
class Standing:
    """How a design does in one environment and motion.

    Parameters
    ----------
    rank : int, optional
        Of the design among all, 1 being quietest; those whose risk is not known share the last.
        None where the shaft turns and the contact never slips.
    design, environment, motion : str
    risk : int, optional
        From 1 to 10 at constant speed; None if it is not known.
    exposure : float
        Mean of the points of use [-], 1 being 40 dB(A) throughout.
    shares : dict of str to float
        Of the points of use, by label [-].
    loudest_level, loudest_level_max : float
        L_Aeq and L_AFmax of the loudest point of use with a noise [dB re 20 uPa]; NaN if there is
        none.
    loudest_label : str
        Its noise, ``none`` if there is none.
    v_crit1, v_crit2 : float
        Largest of all fits, supports and temperatures [rad/s]; NaN where the shaft swings.
    margin_v_crit1, margin_v_crit2, margin_stability : float
        Smallest likewise [rad/s].
    never_slips : str
        Why the contact never slips; empty where it does.
    words : str
        What it does, in plain words.
    hint : str
        What would help; empty where nothing needs to, or nothing is known to.
    notes : tuple of str
        What to know of its numbers: implausible values, data interpolated or held, speeds beyond
        those fitted, effects and temperatures that change nothing, a contact that never slips.
    """

    rank: int | None
    design: str
    environment: str
    motion: str
    risk: int | None
    exposure: float
    shares: dict[str, float]
    loudest_level: float
    loudest_level_max: float
    loudest_label: str
    v_crit1: float
    v_crit2: float
    margin_v_crit1: float
    margin_v_crit2: float
    margin_stability: float
    never_slips: str = ""
    words: str = ""
    hint: str = ""
    notes: tuple[str, ...] = ()


def loudness_weight(level: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how loud levels are, 1 at 40 dB(A), doubled every 10 dB.

    Parameters
    ----------
    level : ndarray, any shape
        [dB(A)]

    Returns
    -------
    ndarray
        Of the same shape [-].

    Examples
    --------
    >>> loudness_weight(np.array([40.0, 60.0]))
    array([1., 4.])
    """
    return np.asarray(2.0 ** ((level - 40.0) / 10.0))


def standings(
    maps: Sequence[DesignMap],
    critical: Sequence[CriticalPoint],
    statistics: Sequence[Statistics],
    never_slipping: Sequence[str] | None = None,
    hints: Sequence[str] | None = None,
    remarks: Mapping[tuple[str, str], Sequence[str]] | None = None,
) -> tuple[Standing, ...]:
    """Tell how mapped designs do, the quietest first.

    Parameters
    ----------
    maps : sequence of DesignMap
    critical : sequence of CriticalPoint
    statistics : sequence of Statistics
        One for each design and environment.
    never_slipping : sequence of str, optional
        Of each map why the contact never slips, empty where it does; by default all slip.
    hints : sequence of str, optional
        Of each map what would help, where no advice is told; by default nothing.
    remarks : mapping of (str, str) to sequence of str, optional
        What to know of the numbers of a design in an environment, by both names.

    Returns
    -------
    tuple of Standing
        One a map; those without a rank are the last.

    Raises
    ------
    ParameterError
        The maps are not over the same points.
    """
    refuse_unlike(maps)
    risks = {(one.design, one.environment): one.risk for one in statistics}
    advised = {(one.design, one.environment): advice_words(one) for one in statistics}
    found = []
    nothing = [""] * len(maps)
    for mapped, why, hint in zip(maps, never_slipping or nothing, hints or nothing, strict=True):
        where = mapped.design, mapped.environment
        one = _standing(mapped, critical, risks[where])
        found.append(
            replace(
                one,
                never_slips=why,
                words=plain_words(mapped, one.margin_v_crit2, why),
                hint="" if why else advised[where] or hint,
                notes=(*(remarks or {}).get(where, ()), *filter(None, [why])),
            )
        )
    held = {one.design for one in found if one.never_slips and one.motion == "steady"}
    judged = [one for one in statistics if one.design not in held]
    order = ranked(_candidates([one for one in found if one.design not in held], judged))
    rank: dict[str, int | None] = {**order, **dict.fromkeys(held)}
    last = 1 + len(order)
    all_ranked = [replace(one, rank=rank.get(one.design, last)) for one in found]
    return tuple(
        sorted(all_ranked, key=lambda one: (last + 1 if one.rank is None else one.rank, one.design))
    )


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


def _candidates(found: Sequence[Standing], statistics: Sequence[Statistics]) -> list[Candidate]:
    by_parts = all(one.robustness is not None for one in statistics)
    candidates = []
    for design in dict.fromkeys(one.design for one in found):
        risks = [one.risk for one in statistics if one.design == design]
        known = [risk for risk in risks if risk is not None]
        if len(known) < len(risks):
            continue
        own = [one for one in found if one.design == design]
        noisy = max(1.0 - one.shares["none"] for one in own)
        noise = Estimate(noisy, noisy, noisy)
        if by_parts:
            noises = [
                one.robustness.noises.any_but()
                for one in statistics
                if one.design == design and one.robustness is not None
            ]
            noise = max(noises, key=lambda estimate: estimate.value)
        margins = [one.margin_v_crit2 for one in own if not np.isnan(one.margin_v_crit2)]
        candidates.append(Candidate(design, max(known), noise, min(margins, default=np.nan)))
    return candidates


def _standing(mapped: DesignMap, critical: Sequence[CriticalPoint], risk: int | None) -> Standing:
    used = mapped.grid.used
    label, level, level_max = (
        each[..., used] for each in (mapped.label, mapped.level, mapped.level_max)
    )
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
        risk=risk,
        exposure=float(np.sum(loudness_weight(level_max[noisy])) / label.size),
        shares={name: float(np.mean(label == name)) for name in LABELS},
        loudest_level=float(level[loudest]) if noisy.any() else nothing,
        loudest_level_max=float(level_max[loudest]) if noisy.any() else nothing,
        loudest_label=str(label[loudest]) if noisy.any() else "none",
        v_crit1=max((point.v_crit1 for point in own), default=nothing),
        v_crit2=max((point.v_crit2 for point in own), default=nothing),
        margin_v_crit1=min((point.margin_v_crit1 for point in own), default=nothing),
        margin_v_crit2=min((point.margin_v_crit2 for point in own), default=nothing),
        margin_stability=min((point.margin_stability for point in own), default=nothing),
    )
