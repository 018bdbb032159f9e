"""Phrases on screened designs: ranges of a noise, conditions, margins, critical speeds, changes."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from noise.base.labels import PERSISTS
from noise.base.progress import counted
from noise.screening.advice import Offer
from noise.screening.axis_values import axis_words
from noise.screening.grid import Grid
from noise.screening.mapping import DesignMap
from noise.screening.vibration import Condition

if TYPE_CHECKING:
    from noise.screening.standing import CriticalPoint, Standing

K = TypeVar("K", bound=Hashable)

_NOISES = {
    "creak": "creak", "squawk": "squawk", "squeal": "squeal",
    PERSISTS: "quiet from rest, but a vibration that runs goes on,",
}  # fmt: skip
"""Labels of a map but ``none``, in sentences."""

_MOST_RANGES = 2
"""Largest number of ranges of a noise in a sentence."""

_MOST_CRITICAL = 4
"""Largest number of lines on critical speeds, of the smallest margins."""


def use_words(mapped: DesignMap, never_slips: str = "") -> str:
    """Return a sentence on whether a design is quiet over its use, and where it is not.

    Parameters
    ----------
    mapped : DesignMap
    never_slips : str
        Why the contact never slips; empty where it does.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(2.0, 12.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> screen(["PDMS"], use).standings[0].words
    'quiet in its use, all 2 conditions'
    """
    if never_slips:
        return f"{never_slips}; quiet" if mapped.grid.frequency else never_slips
    label = mapped.label[..., mapped.grid.used]
    shares = {name: float(np.mean(label == name)) for name in _NOISES}
    noises = sorted((name for name in shares if shares[name]), key=lambda name: -shares[name])
    if not noises:
        return f"quiet in its use, all {label.size} conditions"
    noisy = sum(share for name, share in shares.items() if name != PERSISTS)
    head = f"noisy at {percent(noisy)} of its use" if noisy else "quiet from rest in its use"
    parts = [
        f"{_NOISES[name]} at {percent(shares[name])}, {_ranges_words(label == name, mapped.grid)}"
        for name in noises
    ]
    return f"{head}: {'; '.join(parts)}"


def percent(share: float) -> str:
    """Return a share as text.

    Examples
    --------
    >>> percent(0.5), percent(0.001)
    ('50%', '< 1%')
    """
    return "< 1%" if 0.0 < share < 0.005 else f"{share:.0%}"


def _ranges_words(happens: NDArray[np.bool_], grid: Grid) -> str:
    """Return the largest ranges of speed throughout which something happens, as text."""
    speed = np.array(grid.speed)[grid.used]
    rows = (
        ((run, t, k), i)
        for t, k, i in np.ndindex(happens.shape[:3])
        for run in _runs(happens[t, k, i])
    )
    sizes = {
        one: (one[0][1] - one[0][0]) * math.prod(map(len, one[1:])) for one in _places_of(rows)
    }
    largest = sorted(sizes, key=lambda one: -sizes[one])
    texts = [
        " ".join([_between(speed[slice(*run)]), *_where(fits, supports, temperatures, grid)])
        for run, supports, fits, temperatures in largest[:_MOST_RANGES]
    ]
    more = [sizes[one] for one in largest[_MOST_RANGES:]]
    if more:
        ranges = counted(len(more), "further point" if max(more) == 1 else "further range")
        texts.append(f"{'at' if max(more) == 1 else 'in'} {ranges}")
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _places_of(
    rows: Iterable[tuple[tuple[K, int, int], int]],
) -> list[tuple[K, tuple[int, ...], tuple[int, ...], tuple[int, ...]]]:
    """Group what is alike at several fits, supports and temperatures.

    Rows are a key, a temperature and a support, and a fit; groups are a key with its supports, fits
    and temperatures.
    """
    of_fits = _grouped(rows)
    of_supports = _grouped(((key, t, fits), k) for (key, t, k), fits in of_fits.items())
    groups = _grouped(((key, k, fits), t) for (key, t, fits), k in of_supports.items())
    return [(*group, temperatures) for group, temperatures in groups.items()]


def _runs(happens: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of true values: the first index, and the one after the last."""
    edges = np.flatnonzero(np.diff(happens.astype(int), prepend=0, append=0))
    return [(int(first), int(end)) for first, end in edges.reshape(-1, 2)]


def _grouped(pairs: Iterable[tuple[K, int]]) -> dict[K, tuple[int, ...]]:
    groups: dict[K, tuple[int, ...]] = {}
    for key, value in pairs:
        groups[key] = (*groups.get(key, ()), value)
    return groups


def _between(span: NDArray[np.float64]) -> str:
    if span.size == 1:
        return f"at {span[0]:.5g} rad/s"
    return f"from {span[0]:.5g} to {span[-1]:.5g} rad/s"


def _where(
    fits: Sequence[int], supports: Sequence[int], temperatures: Sequence[int], grid: Grid
) -> list[str]:
    """Return fits, supports and temperatures as text, where they are not all of the map."""
    return [
        say([values[i] for i in there])
        for values, there, say in (
            (grid.interference, fits, fit_words),
            (grid.support_stiffness, supports, supports_words),
            (grid.temperature, temperatures, lambda values: f"at {axis_words(values)} °C"),
        )
        if len(there) < len(values)
    ]


def fit_words(values: Sequence[float]) -> str:
    """Return interferences [m] as text.

    Examples
    --------
    >>> fit_words([0.279e-3, 0.381e-3])
    'at 0.279 and 0.381 mm'
    """
    return f"at {axis_words([1e3 * value for value in values])} mm"


def supports_words(values: Sequence[float]) -> str:
    """Return supports [Nm/rad] as text.

    Examples
    --------
    >>> supports_words([2214.0, math.inf])
    'on a support of 2214 Nm/rad and with the clamp fixed'
    """
    finite = [value for value in values if math.isfinite(value)]
    several = "supports" if len(finite) > 1 else "a support"
    texts = [f"on {several} of {axis_words(finite)} Nm/rad"] if finite else []
    return " and ".join([*texts, *(["with the clamp fixed"] if len(finite) < len(values) else [])])


def condition_words(at: Condition) -> str:
    """Return a condition as text.

    Examples
    --------
    >>> condition_words(Condition(5.0, 0.279e-3, math.inf))
    '5 rad/s, 0.279 mm, the clamp fixed'
    """
    support = "the clamp fixed"
    if math.isfinite(at.support_stiffness):
        support = f"{at.support_stiffness:.4g} Nm/rad"
    return f"{at.speed:.5g} rad/s, {1e3 * at.interference:.3g} mm, {support}"


def margin_words(one: Standing, grid: Grid) -> str:
    """Return a sentence on the last vibration and the margin of the use; empty for a swing.

    Parameters
    ----------
    one : Standing
    grid : Grid
        Of its map.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> margin_words(found.standings[0], found.maps[0].grid)
    'nothing vibrates at any speed of the map'
    """
    margin, last, use = one.margin_v_crit2, one.v_crit2, grid.use
    if math.isnan(margin):
        return ""
    if margin == math.inf:
        return "nothing vibrates at any speed of the map"
    text = f"the last vibration ends between {last:.3g} and {one.v_crit2_high:.3g} rad/s (V_crit2)"
    if math.isinf(last):
        text = f"vibration does not end within the map, up to {grid.speed[-1]:.3g} rad/s (V_crit2)"
    if margin_is_bound(margin, grid):
        text += f"; the margin is at least {margin:.3g} rad/s"
    if margin > 0.0:
        return f"{text}; every speed of use is at least {margin:.3g} rad/s from what vibrates"
    if margin == 0.0:
        return f"{text}, where the use begins"
    if -margin > use[1] - use[0]:  # where they are equal, an end of the use is quiet
        return f"{text}; at the worst fit and support all speeds of use vibrate"
    return (
        f"{text}; at the worst fit and support the speeds of use would have to move by "
        f"{-margin:.3g} rad/s to be quiet"
    )


def margin_is_bound(margin: float, grid: Grid) -> bool:
    """Return whether a margin is a lower bound, as the vibration does not end within the map.

    A use that would leave a vibration by a shorter way, to slower speeds, has its exact margin.

    Parameters
    ----------
    margin : float
        To what vibrates [rad/s].
    grid : Grid
    """
    return margin < grid.use[0] - grid.speed[-1]


def critical_words(points: Sequence[CriticalPoint], grid: Grid) -> list[str]:
    """Return phrases on where stick and vibration end, those of the smallest margins first.

    Parameters
    ----------
    points : sequence of CriticalPoint
        Of one map, in its order; none for a swing.
    grid : Grid
        Of the map.

    Returns
    -------
    list of str
        None where nothing vibrates at any fit, support and temperature.
    """
    if not any(point.v_crit2 for point in points):
        return []
    shape = len(grid.temperature), len(grid.support_stiffness), len(grid.interference)
    rows = [
        (((one.margin_v_crit2, _ends_words(one, grid)), t, k), i)
        for (t, k, i), one in zip(np.ndindex(shape), points, strict=True)
    ]
    groups = sorted(_places_of(rows), key=lambda group: group[0][0])
    texts = [
        " ".join([text, *_where(fits, supports, temperatures, grid)])
        for (_, text), supports, fits, temperatures in groups[:_MOST_CRITICAL]
    ]
    more = len(groups) > _MOST_CRITICAL
    return texts + ["critical_speeds.csv has those of the larger margins"] * more


def _ends_words(one: CriticalPoint, grid: Grid) -> str:
    """Return where stick and vibration end at one fit, support and temperature, as text."""
    if not one.v_crit2:
        return "nothing vibrates"
    fastest = f"within the map (up to {grid.speed[-1]:.3g} rad/s)"
    if math.isinf(one.v_crit1):
        return f"neither stick (V_crit1) nor vibration (V_crit2) ends {fastest}"
    stick = f"stick ends at {one.v_crit1:.3g} to {one.v_crit1_high:.3g} rad/s (V_crit1)"
    ends = f"vibration at {one.v_crit2:.3g} to {one.v_crit2_high:.3g} rad/s (V_crit2)"
    if not one.v_crit1:
        stick, ends = "nothing sticks", ends.replace("vibration", "vibration ends")
    if math.isinf(one.v_crit2):
        ends = f"vibration (V_crit2) does not end {fastest}"
    return f"{stick} and {ends}"


def advice_words(
    noise: str,
    at: Condition,
    offers: Sequence[Offer],
    sounds: Mapping[Condition, str],
    most: int = 3,
) -> str:
    """Return sentences on the changes that silence the loudest point, and on what they leave.

    Parameters
    ----------
    noise : str
        Noise at the loudest point.
    at : Condition
        The loudest point.
    offers : sequence of Offer
        Of `noise.screening.advice.advise`.
    sounds : mapping of Condition to str
        Noise of the unchanged design at the other points that were simulated, such as ``creak,
        85 dB(A)``.
    most : int
        Changes that are named.

    Examples
    --------
    >>> at, other = Condition(5.0, 0.279e-3, 2214.0), Condition(9.0, 0.381e-3, 2214.0)
    >>> offers = [Offer("critical_torque", 10.7, -20, True, "", None, 2, 6, other)]
    >>> advice_words("squawk", at, offers, {other: "creak, 85 dB(A)"})
    'no single change that was tried quiets the whole use. The loudest point (squawk at 5 rad/s, ...
    """
    where = f"the loudest point ({noise} at {condition_words(at)})"
    ending = [one for one in offers if one.ends]
    if not ending:
        return f"no single change that was tried silences {where}" if offers else ""
    best, shown = ending[0], ending[:most]
    others = " (in brackets: other noisy points silenced, of those tried)" * bool(best.elsewhere)
    changes = "; ".join(
        f"{one.words} ({one.quiet_elsewhere} of {one.elsewhere})" if others else one.words
        for one in shown
    )
    by = "by" if len(ending) == 1 else "by any one of these"
    text = f"{where} falls silent {by}{others}: {changes}"
    text += f"; advice.csv has {len(ending) - len(shown)} more" * (len(ending) > len(shown))
    if best.left is None:
        return text
    rest = "The other noisy point that was tried stays noisy with the first"
    if best.elsewhere > 1:
        rest = (
            f"Of the {best.elsewhere} other noisy points tried, the loudest that stays noisy with "
            "the first"
        )
    return (
        f"no single change that was tried quiets the whole use. {text[0].upper()}{text[1:]}. "
        f"{rest}: {condition_words(best.left)} (before the change {sounds[best.left]})"
    )


def limit_words(offers: Sequence[Offer], noise: str, most: int = 2) -> list[str]:
    """Return sentences on changes that do not end the noise.

    Parameters
    ----------
    offers : sequence of Offer
    noise : str
        Its name.
    most : int
        Of those that reach a limit, that are named.

    Examples
    --------
    >>> limit_words([Offer("damping", 0.1, 200, False, from_rest=150)], "squawk")
    ['damping +150 % to 0.25 Nm s/rad is quiet from rest only: the squawk persists once started']
    >>> limit_words([Offer("critical_torque", 10.0, -20, False, "too small")], "squawk")
    ['critical torque -20 % to 8 Nm reaches the limit, and the squawk goes on (too small)']
    """
    end = {one.name for one in offers if one.ends}  # in the other direction
    texts = [
        f"{replace(one, percent=one.from_rest).words} is quiet from rest only: the {noise} "
        f"persists once started{f' ({one.limit})' if one.limit else ''}"
        for one in offers
        if one.from_rest is not None and not one.ends
    ]
    limited = [one for one in offers if one.limit and one.from_rest is None and one.name not in end]
    for one in limited[:most]:
        name = one.name.replace("_", " ")
        texts.append(
            f"{one.words} reaches the limit, and the {noise} goes on ({one.limit})"
            if one.percent
            else f"{name} alone does not end it ({one.limit})"
        )
    if len(limited) > most:
        texts.append(f"advice.csv has {len(limited) - most} more that reach a limit")
    return texts
