"""Summary of a screen in lines, for terminal and page: where noisy, what to change, how sure."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from noise.screening.mapping import BEYOND, REFINED, SIMULATED, UNCHANGED, DesignMap
from noise.screening.parts import Robustness
from noise.screening.provenance import RULE, within_fits
from noise.screening.words import critical_words, limit_words, margin_words

if TYPE_CHECKING:
    from noise.screening.screen import Screening
    from noise.screening.standing import Standing

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


def sure_words(one: Standing, mapped: DesignMap) -> list[str]:
    """Return phrases on how the results of a design were obtained and how exact they are.

    Parameters
    ----------
    one : Standing
    mapped : DesignMap
        Its map.
    """
    count, total = mapped.count(SIMULATED), mapped.label.size
    texts = [f"{count} of {total} points were simulated"]
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
    return texts + (_parts_words(one.robustness) if one.robustness else [])


def _parts_words(parts: Robustness) -> list[str]:
    """Return phrases on the probability of a noisy part and on the most important tolerance."""
    noisy = parts.noisy
    assumed = " within assumed tolerances" if parts.assumed else " within its tolerances"
    texts = [
        f"a part{assumed} is noisy somewhere in its use with a probability of {noisy.value:.0%} "
        f"({noisy.low:.0%} to {noisy.high:.0%})"
    ]
    if parts.sensitivities and parts.sensitivities[0].total.value > 0.0:
        most = parts.sensitivities[0]
        share = min(1.0, most.total.value)
        texts.append(
            f"the tolerance of {most.name.replace('_', ' ')} matters most: {share:.0%} of the "
            "scatter of the vibration's growth"
        )
    return texts


def detail_lines(one: Standing, screening: Screening) -> list[str]:
    """Return lines on where a design is noisy, level, changes, critical speeds and certainty.

    Parameters
    ----------
    one : Standing
    screening : Screening
        That it is of.
    """
    mapped = screening.map_of(one)
    points = [
        point
        for point in screening.critical
        if (point.design, point.environment, "steady") == (one.design, one.environment, one.motion)
    ]
    where = "" if one.never_slips else one.words.partition(": ")[2]
    lines = [f"where: {text}" for text in where.split("; ") if text]
    if one.loudest is not None:
        lines.append(
            f"heard: up to {one.loudest_level:.0f} dB(A) ({one.loudest_label}); mean loudness "
            f"{one.mean_loudness:.3g} sone"
        )
        lines += [f"what to change: {text}" for text in [one.advice] if text]
        lines += [f"limits: {text}" for text in limit_words(one.offers, one.loudest_label)]
    lines += [f"critical speeds: {text}" for text in critical_words(points, mapped.grid)]
    lines += [f"margin: {text}" for text in [margin_words(one, mapped.grid)] if text]
    lines.append(f"how sure: {'; '.join(sure_words(one, mapped))}")
    lines += [f"failed: {why}" for why in one.failed]
    return [*lines, *(f"note: {note}" for note in one.notes if note != one.never_slips)]


def summary_lines(screening: Screening) -> list[str]:
    """Return the summary of a screening for the terminal.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> lines = summary_lines(screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,))))
    >>> lines[0]
    '1. PDMS, dry: quiet in its use, all 4 conditions'
    """
    lines = []
    for one in screening.standings:
        head = f"{one.design}, {standing_place(one)}"
        if one.rank is None:
            why = one.never_slips or "with the shaft turning it never slips"
            lines.append(f"-. {head}: no rank; {why}")
        else:
            details = detail_lines(one, screening)
            lines.append(f"{one.rank}. {head}: {use_head(one)}")
            lines += [f"   {line}" for line in details]
    if len(screening.designs) > 1:
        lines.append(RANKING_RULE)
    lines += conditions_lines(screening)
    maps = screening.maps
    counts = {words: sum(mapped.count(how) for mapped in maps) for how, words in _HOW.items()}
    how = ", ".join(f"{count} {words}" for words, count in counts.items() if count)
    points = sum(mapped.label.size for mapped in maps)
    return [
        *lines,
        f"{points} points in {screening.seconds:.1f} s: {how}",
        f"advice and tolerances in {screening.statistics_seconds:.1f} s",
    ]


def use_head(one: Standing) -> str:
    """Return the first part of the words of a standing; `detail_lines` has the ranges."""
    return one.words if one.never_slips else one.words.partition(": ")[0]


def standing_place(one: Standing) -> str:
    """Return environment and motion of a standing as text."""
    return one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}"


def ranking_words(standings: Sequence[Standing]) -> str:
    """Return a sentence on the designs that come first; empty for a single design.

    Parameters
    ----------
    standings : sequence of Standing
        The first ranked first.
    """
    best = standings[0]
    if best.rank is None:
        return "No design slips, so none has a rank."
    if len({one.design for one in standings}) == 1:
        return ""
    first = [one for one in standings if one.rank == best.rank]
    names = " and ".join(sorted({one.design for one in first}))
    loudness = max(one.mean_loudness for one in first)
    if loudness == 0.0:
        return f"Quiet in all of its use: {names}. {RANKING_RULE}."
    return f"Lowest mean loudness, {loudness:.3g} sone: {names}. {RANKING_RULE}."


def conditions_lines(screening: Screening) -> list[str]:
    """Return lines on the conditions of the comparison and on data that are not the designs' own.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(1.0, 5.0), interference=(0.3e-3,), support_stiffness=(2214.0,))
    >>> for line in conditions_lines(screen(["PDMS"], use)):
    ...     print(line)
    each design at 2 points: speed 1 and 5 rad/s; interference 0.3 mm; support 2214 Nm/rad; ...
    not from a design's own data: 2 of PDMS; where a design has no data of its own, stiffness, ...
    """
    axes = dict.fromkeys(words for grid in screening.conditions for words in grid.words)
    n_points = sum(math.prod(grid.shape) for grid in screening.conditions)
    same = "the same " if len(screening.designs) > 1 else ""
    lines = [f"each design at {same}{n_points} points: {'; '.join(axes)}"]
    counts: Counter[str] = Counter()
    for mapped in screening.maps:
        counts[mapped.design] += int(mapped.substituted.sum())
    if stand_in := [f"{count} of {name}" for name, count in counts.items() if count]:
        lines.append(f"not from a design's own data: {', '.join(stand_in)}; {RULE}")
        lines += [text for text in [_fair(screening)] if text]
    return lines


def _fair(screening: Screening) -> str:
    """Return a remark on the interferences at which all designs have data; empty if all."""
    fits = sorted({fit for grid in screening.conditions for fit in grid.interference})
    own = [fit for fit in fits if all(within_fits(one.rig, fit) for one in screening.designs)]
    if len(screening.designs) == 1 or own == fits:
        return ""
    if not own:
        return "the fits of all designs have no interference in common: ranks are of unlike data"
    named = ",".join(f"{1e3 * fit:.4g}" for fit in own)
    return (
        "a torque held at a larger interference is too small, and flatters; "
        f"--interference {named} compares within the fits of all"
    )
