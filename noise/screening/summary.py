"""Sentences on screened designs, for terminal and page: where noisy, what to change, how sure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.base.labels import PERSISTS
from noise.base.progress import counted
from noise.screening.advice import Offer
from noise.screening.grid import Grid
from noise.screening.mapping import SIMULATED, DesignMap
from noise.screening.vibration import Condition

if TYPE_CHECKING:
    from noise.screening.screen import Screening
    from noise.screening.standing import Standing

_NOISES = {
    "creak": "creak", "squawk": "squawk", "squeal": "squeal",
    PERSISTS: "quiet from rest, but a vibration that runs goes on,",
}  # fmt: skip
"""Labels of a map but ``none``, in sentences."""

_CHANGES, _LIMITS = 3, 2
"""Changes that are named: of those that end a noise, and of those that reach a limit."""

RANKING_RULE = (
    "Rank 1 has the lowest mean loudness of its use: 40 dB(A) counts 1 sone, 10 dB more twice as "
    "much, silence 0. So a design that is noisy more often but fainter may come first"
)
"""Explanation of the number by which designs are ranked."""

MARGIN_RULE = (
    "Margin: by how much the speeds of use would have to move until none vibrates (negative), or "
    "how far they are from one that does"
)


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


def condition_words(at: Condition) -> str:
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
    if margin > 0.0:
        return f"{text}; every speed of use is at least {margin:.3g} rad/s from what vibrates"
    if margin == 0.0:
        return f"{text}, where the use begins"
    if -margin > use[1] - use[0]:  # where they are equal, an end of the use is quiet
        return f"{text}; at the worst fit and support all speeds of use vibrate"
    way = "be slower by" if margin_is_bound(margin, grid) else "move by"
    return (
        f"{text}; at the worst fit and support the speeds of use would have to {way} "
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


# --- advice --------------------------------------------------------------------------------------


def advice_words(noise: str, at: Condition, offers: Sequence[Offer]) -> list[str]:
    """Return sentences on the changes that silence the loudest point, and on what they leave.

    Parameters
    ----------
    noise : str
        Noise at the loudest point.
    at : Condition
        The loudest point.
    offers : sequence of Offer
        Of `noise.screening.advice.advise`.

    Examples
    --------
    >>> at, other = Condition(5.0, 0.279e-3, 2214.0), Condition(9.0, 0.381e-3, 2214.0)
    >>> offer = Offer("critical_torque", 10.7, -20, True, "", None, 2, 6, other)
    >>> for words in advice_words("squawk", at, [offer]):
    ...     print(words)
    critical torque -20 % to 8.56 Nm silences the loudest point (squawk at 5 rad/s, 0.279 mm, ...
    critical torque -20 % is not enough at 9 rad/s, 0.381 mm, 2214 Nm/rad
    """
    where = f"the loudest point ({noise} at {at.speed:.5g} rad/s, {condition_words(at)})"
    ending = [one for one in offers if one.ends]
    if not ending:
        return [f"no single change that was tried silences {where}"] * bool(offers)
    texts = []
    for one in ending[:_CHANGES]:
        others = f" and {one.quiet_elsewhere} of {counted(one.elsewhere, 'other noisy point')}"
        texts.append(f"{one.words} silences {where}{others * bool(one.elsewhere)}")
        where = "it, too,"
    if len(ending) > _CHANGES:
        texts.append(f"advice.csv has {len(ending) - _CHANGES} more that silence it")
    best = ending[0]
    if best.left is not None:
        texts.append(
            f"{best.short} is not enough at {best.left.speed:.5g} rad/s, "
            f"{condition_words(best.left)}"
        )
    return texts


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
    ['damping +150 % is quiet from rest only: the squawk goes on once it has started']
    >>> limit_words([Offer("critical_torque", 10.0, -20, False, "too small")], "squawk")
    ['critical torque -20 % is the most that can be tried, and the squawk goes on (too small)']
    """
    texts = []
    end = {one.name for one in offers if one.ends}  # in the other direction
    limited: dict[str, str] = {}
    for one in offers:
        reason = f" ({one.limit})" * bool(one.limit)
        if one.from_rest is not None and not one.ends:
            texts.append(
                f"{replace(one, percent=one.from_rest).short} is quiet from rest only: the {noise} "
                f"goes on once it has started{reason}"
            )
        elif one.limit and one.name not in end:
            words = f"{one.short} is the most that can be tried, and the {noise} goes on{reason}"
            if not one.percent:
                words = f"no change of the {one.name.replace('_', ' ')} can be tried{reason}"
            limited.setdefault(one.name, words)
    return [*texts, *list(limited.values())[:_LIMITS]]


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
        changes = advice_words(one.loudest_label, one.loudest, one.offers)
        lines += [f"what to change: {text}" for text in changes]
        lines += [f"limits: {text}" for text in limit_words(one.offers, one.loudest_label)]
    lines += [f"margin: {text}" for text in [margin_words(one)] if text]
    lines.append(f"how sure: {'; '.join(_sure_words(one, mapped))}")
    return [*lines, *(f"note: {note}" for note in one.notes)]


def _sure_words(one: Standing, mapped: DesignMap) -> list[str]:
    """Return phrases on how the results of a design were obtained and how exact they are."""
    count, total = mapped.count(SIMULATED), mapped.label.size
    texts = [f"{count} of {counted(total, 'point')} were simulated"]
    if mapped.open:
        texts.append(f"{mapped.open} lie between simulated ones that differ and are as the nearest")
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
    return [*lines, f"{conditions_words(screening)}; {screening.seconds:.1f} s"]


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
