"""Sentences on screened designs, for terminal and page: where noisy, what to change, how sure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from noise.base.labels import PERSISTS
from noise.base.progress import counted
from noise.screening.advice import Offer
from noise.screening.grid import Grid
from noise.screening.mapping import BEYOND, REFINED, SIMULATED, UNCHANGED, DesignMap
from noise.screening.vibration import Condition

if TYPE_CHECKING:
    from noise.screening.screen import Screening
    from noise.screening.standing import CriticalPoint, Standing

_NOISES = {
    "creak": "creak", "squawk": "squawk", "squeal": "squeal",
    PERSISTS: "quiet from rest, but a vibration that runs goes on,",
}  # fmt: skip
"""Labels of a map but ``none``, in sentences."""

_MOST_CRITICAL = 4
"""Largest number of lines on critical speeds, of the smallest margins."""

_CHANGES, _LIMITS = 3, 2
"""Changes that are named: of those that end a noise, and of those that reach a limit."""

RANKING_RULE = (
    "Rank 1 has the lowest mean loudness of its use, in which 40 dB(A) counts 1 sone, 10 dB more "
    "twice as much and silence 0, so that a design that is noisy more often but fainter may come "
    "first"
)
"""Explanation of the number by which designs are ranked."""

MARGIN_RULE = (
    "Margin: by how much the speeds of use would have to move until none vibrates (negative), or "
    "how far they are from one that does"
)

_HOW = {
    SIMULATED: "simulated from rest and from running vibration",
    REFINED: "as the simulated points about them",
    BEYOND: "not run, beyond a simulated speed at which a running vibration dies",
    UNCHANGED: "as at another temperature or fit",
}


# --- one design ----------------------------------------------------------------------------------


def use_words(mapped: DesignMap) -> tuple[str, list[str]]:
    """Return whether a design is quiet over its use, and phrases on each of its noises.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(2.0, 12.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> use_words(screen(["PDMS"], use).maps[0])
    ('quiet in its use (2 conditions)', [])
    """
    label = mapped.label[..., mapped.grid.used]
    shares = {name: float(np.mean(label == name)) for name in _NOISES}
    noises = sorted((name for name in shares if shares[name]), key=lambda name: -shares[name])
    if not noises:
        return f"quiet in its use ({counted(label.size, 'condition')})", []
    noisy = sum(share for name, share in shares.items() if name != PERSISTS)
    head = f"noisy at {percent(noisy)} of its use" if noisy else "quiet from rest in its use"
    return head, [
        f"{_NOISES[name]} at {percent(shares[name])}, {_range_words(mapped, name)}"
        for name in noises
    ]


def percent(share: float) -> str:
    """Return a share as text.

    Examples
    --------
    >>> percent(0.5), percent(0.001)
    ('50%', '< 1%')
    """
    return "< 1%" if 0.0 < share < 0.005 else f"{share:.0%}"


def _range_words(mapped: DesignMap, name: str) -> str:
    """Return where a noise occurs at most speeds of use, and between which, as text."""
    grid = mapped.grid
    there = mapped.label[..., grid.used] == name
    t, k, i = np.unravel_index(there.sum(axis=-1).argmax(), there.shape[:3])
    speed = np.array(grid.speed)[grid.used][there[t, k, i]]
    words = f"between {speed[0]:.5g} and {speed[-1]:.5g} rad/s"
    if speed.size == 1:
        words = f"at {speed[0]:.5g} rad/s"
    if there.size == there.shape[-1]:
        return words
    where = condition_words(Condition(0.0, grid.interference[i], grid.support_stiffness[k]))
    several = f", {grid.temperature[t]:g} °C" * (len(grid.temperature) > 1)
    return f"most at {where}{several}: {words}"


def condition_words(at: Condition | CriticalPoint) -> str:
    """Return interference and support of a condition as text.

    Examples
    --------
    >>> condition_words(Condition(5.0, 0.279e-3, math.inf))
    '0.279 mm, the clamp fixed'
    """
    support = "the clamp fixed"
    if math.isfinite(at.support_stiffness):
        support = f"{at.support_stiffness:.4g} Nm/rad"
    return f"{1e3 * at.interference:.3g} mm, {support}"


def margin_words(one: Standing) -> str:
    """Return a sentence on the last vibration and the margin of the use; empty for a swing.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> margin_words(found.standings[0])
    'nothing vibrates at any speed of the map'
    """
    grid, use = one.mapped.grid, one.mapped.grid.use
    margin, last, beyond = map(one.worst, ("margin_v_crit2", "v_crit2", "v_crit2_high"))
    if math.isnan(margin):
        return ""
    if margin == math.inf:
        return "nothing vibrates at any speed of the map"
    text = f"the last vibration ends between {last:.3g} and {beyond:.3g} rad/s (V_crit2)"
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
        Of one map; none for a swing.
    grid : Grid
        Of the map.

    Returns
    -------
    list of str
        None where nothing vibrates at any fit, support and temperature.
    """
    vibrating = sorted((one for one in points if one.v_crit2), key=lambda one: one.margin_v_crit2)
    several = len(grid.temperature) > 1
    texts = [
        f"{condition_words(one)}{f', {one.temperature:g} °C' * several}: {_ends_words(one, grid)}"
        for one in vibrating[:_MOST_CRITICAL]
    ]
    more = len(vibrating) > _MOST_CRITICAL
    return texts + ["critical_speeds.csv has those of the larger margins"] * more


def _ends_words(one: CriticalPoint, grid: Grid) -> str:
    """Return where stick and vibration end at one fit, support and temperature, as text."""
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


# --- advice --------------------------------------------------------------------------------------


def advice_words(noise: str, at: Condition, offers: Sequence[Offer], left: str = "") -> str:
    """Return sentences on the changes that silence the loudest point, and on what they leave.

    Parameters
    ----------
    noise : str
        Noise at the loudest point.
    at : Condition
        The loudest point.
    offers : sequence of Offer
        Of `noise.screening.advice.advise`.
    left : str
        Noise of the unchanged design where the first change leaves it, such as ``creak,
        85 dB(A)``.

    Examples
    --------
    >>> at, other = Condition(5.0, 0.279e-3, 2214.0), Condition(9.0, 0.381e-3, 2214.0)
    >>> offers = [Offer("critical_torque", 10.7, -20, True, "", None, 2, 6, other)]
    >>> advice_words("squawk", at, offers, "creak, 85 dB(A)")
    'no single change that was tried quiets the whole use. The loudest point (squawk at 5 rad/s, ...
    """
    where = f"the loudest point ({noise} at {at.speed:.5g} rad/s, {condition_words(at)})"
    ending = [one for one in offers if one.ends]
    if not ending:
        return f"no single change that was tried silences {where}" if offers else ""
    best, shown = ending[0], ending[:_CHANGES]
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
        f"{rest}: {best.left.speed:.5g} rad/s, {condition_words(best.left)} (before the change "
        f"{left})"
    )


def limit_words(offers: Sequence[Offer], noise: str) -> list[str]:
    """Return sentences on changes that do not end the noise.

    Parameters
    ----------
    offers : sequence of Offer
    noise : str
        Its name.

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
    for one in limited[:_LIMITS]:
        name = one.name.replace("_", " ")
        texts.append(
            f"{one.words} reaches the limit, and the {noise} goes on ({one.limit})"
            if one.percent
            else f"{name} alone does not end it ({one.limit})"
        )
    if len(limited) > _LIMITS:
        texts.append(f"advice.csv has {len(limited) - _LIMITS} more that reach a limit")
    return texts


# --- all of a screen -----------------------------------------------------------------------------


def detail_lines(one: Standing) -> list[str]:
    """Return lines on where a design is noisy, level, changes, critical speeds and certainty."""
    mapped = one.mapped
    lines = [f"where: {text}" for text in use_words(mapped)[1]]
    if one.loudest is not None:
        lines.append(
            f"heard: up to {one.loudest_level:.0f} dB(A) ({one.loudest_label}); mean loudness "
            f"{one.mean_loudness:.3g} sone"
        )
        left = next((_noise_at(mapped, offer.left) for offer in one.offers if offer.left), "")
        advice = advice_words(one.loudest_label, one.loudest, one.offers, left)
        lines += [f"what to change: {text}" for text in [advice] if text]
        lines += [f"limits: {text}" for text in limit_words(one.offers, one.loudest_label)]
    lines += [f"critical speeds: {text}" for text in critical_words(one.critical, mapped.grid)]
    lines += [f"margin: {text}" for text in [margin_words(one)] if text]
    lines.append(f"how sure: {'; '.join(_sure_words(one, mapped))}")
    return [*lines, *(f"note: {note}" for note in one.notes)]


def _noise_at(mapped: DesignMap, at: Condition) -> str:
    """Return noise and level at a point of a map."""
    grid = mapped.grid
    where = (
        grid.temperature.index(at.temperature), grid.support_stiffness.index(at.support_stiffness),
        grid.interference.index(at.interference), grid.speed.index(at.speed),
    )  # fmt: skip
    return f"{mapped.sound[where]}, {mapped.level[where]:.0f} dB(A)"


def _sure_words(one: Standing, mapped: DesignMap) -> list[str]:
    """Return phrases on how the results of a design were obtained and how exact they are."""
    count, total = mapped.count(SIMULATED), mapped.label.size
    texts = [f"{count} of {counted(total, 'point')} were simulated"]
    steps = [b - a for a, b in pairwise(mapped.grid.speed)]
    if steps and mapped.open:
        texts.append(
            f"{mapped.open} lie between simulated points that differ and are as the nearest, so "
            "boundaries there are coarser than the map"
        )
    elif steps and (mapped.label != "none").any():
        texts.append(f"speeds at which a noise begins or ends are known to {max(steps):.3g} rad/s")
    if any(offer.ends for offer in one.offers):
        texts.append(
            "each change was run from rest, from the running noise, and with 2 % less of it"
        )
    if one.parts is not None:
        texts.append(
            f"a part within its tolerances is noisy somewhere in its use with a probability "
            f"of {one.parts.probability:.0%} ({one.parts.low:.0%} to {one.parts.high:.0%})"
        )
    return texts


def summary_lines(screening: Screening) -> list[str]:
    """Return the summary of a screening for the terminal.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> lines = summary_lines(screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,))))
    >>> lines[0]
    '1. PDMS, dry: quiet in its use (4 conditions)'
    """
    lines = []
    for one in screening.standings:
        lines.append(f"{one.rank}. {one.design}, {one.place}: {use_words(one.mapped)[0]}")
        lines += [f"   {line}" for line in detail_lines(one)]
    if len(screening.designs) > 1:
        lines.append(RANKING_RULE)
    maps = screening.maps
    counts = {words: sum(mapped.count(how) for mapped in maps) for how, words in _HOW.items()}
    how = ", ".join(f"{count} {words}" for words, count in counts.items() if count)
    points = sum(mapped.label.size for mapped in maps)
    return [
        *lines,
        conditions_words(screening),
        f"{counted(points, 'point')} in {screening.seconds:.1f} s: {how}",
    ]


def ranking_words(standings: Sequence[Standing]) -> str:
    """Return a sentence on the designs that come first; empty for a single design.

    Parameters
    ----------
    standings : sequence of Standing
        The first ranked first.
    """
    if len({one.design for one in standings}) == 1:
        return ""
    first = [one for one in standings if one.rank == 1]
    names = " and ".join(sorted({one.design for one in first}))
    loudness = max(one.mean_loudness for one in first)
    if loudness == 0.0:
        return f"Quiet in all of its use: {names}. {RANKING_RULE}."
    return f"Lowest mean loudness, {loudness:.3g} sone: {names}. {RANKING_RULE}."


def conditions_words(screening: Screening) -> str:
    """Return a phrase on the conditions of the comparison.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(1.0, 5.0), interference=(0.3e-3,), support_stiffness=(2214.0,))
    >>> conditions_words(screen(["PDMS"], use))
    'each design at 2 points: speed 1 and 5 rad/s; interference 0.3 mm; support 2214 Nm/rad; ...
    """
    first = screening.maps[0].design
    grids = [mapped.grid for mapped in screening.maps if mapped.design == first]
    axes = dict.fromkeys(words for grid in grids for words in grid.words)
    n_points = sum(math.prod(grid.shape) for grid in grids)
    same = "the same " if len(screening.designs) > 1 else ""
    return f"each design at {same}{counted(n_points, 'point')}: {'; '.join(axes)}"
