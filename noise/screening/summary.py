"""Summary of a screening for the terminal: a paragraph a design, then how it is known."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from noise.screening.provenance import RULE, within_fits
from noise.screening.standing import Standing
from noise.screening.words import RANKING_RULE, limit_words, margin_words, parts_words

if TYPE_CHECKING:
    from noise.screening.screen import Screening


def summary_lines(screening: Screening) -> list[str]:
    """Say of each design whether it is quiet in its use, what to change and how sure that is.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> lines = summary_lines(screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,))))
    >>> lines[0]
    '1. PDMS, dry: quiet in its use, all 4 conditions'
    """
    use = screening.maps[0].grid.use
    lines = [line for one in screening.standings for line in _standing_lines(one, use)]
    if len(screening.designs) > 1:
        lines.append(RANKING_RULE)
    lines += conditions_lines(screening)
    maps = screening.maps
    counts = {
        words: sum(found.count(way) for found in maps)
        for way, words in (
            ("simulated", "simulated from rest and from running vibration"),
            ("refined", "as the simulated ones about them"),
            ("unchanged", "as at another temperature or fit"),
        )
    }
    how = ", ".join(f"{count} {words}" for words, count in counts.items() if count)
    left = sum(found.open for found in maps)
    boundary = f" ({left} beside a boundary, as their nearest neighbour)" if left else ""
    points = sum(found.label.size for found in maps)
    lines.append(f"{points} points in {screening.seconds:.1f} s: {how}{boundary}")
    lines.append(f"advice and tolerances in {screening.statistics_seconds:.1f} s")
    return lines


def _standing_lines(one: Standing, use: tuple[float, float]) -> list[str]:
    where = one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}"
    if one.rank is None:
        why = one.never_slips or "with the shaft turning it never slips"
        return [f"-. {one.design}, {where}: no rank; {why}"]
    lines = [f"{one.rank}. {one.design}, {where}: {one.words}"]
    return [*lines, *(f"   {line}" for line in detail_lines(one, use))]


def detail_lines(one: Standing, use: tuple[float, float]) -> list[str]:
    """Say what is heard, what to change, and how sure that is.

    Parameters
    ----------
    one : Standing
    use : (float, float)
        Slowest and fastest speed of use [rad/s].
    """
    lines = []
    if one.loudest is not None:
        lines.append(
            f"heard: up to {one.loudest_level:.0f} dB(A) ({one.loudest_label}); mean loudness "
            f"{one.mean_loudness:.3g} sone"
        )
        lines += [f"what to change: {text}" for text in [one.advice] if text]
        lines += [f"limits: {text}" for text in limit_words(one.offers, one.loudest_label)]
    sure = [margin_words(one, use)]
    if one.advice and any(offer.ends for offer in one.offers):
        sure.append(
            "each change was run from rest, from the running noise, and with 2 % less of it"
        )
    if one.robustness is not None:
        sure += parts_words(one.robustness)
    lines += [f"how sure: {'; '.join(filter(None, sure))}"] if any(sure) else []
    lines += [f"not told: {why}" for why in one.failed]
    return [*lines, *(f"note: {note}" for note in one.notes if note != one.never_slips)]


def conditions_lines(screening: Screening) -> list[str]:
    """Say over which conditions all designs are compared, and where data are not their own.

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
    said = dict.fromkeys(words for grid in screening.conditions for words in grid.words)
    n_points = sum(math.prod(grid.shape) for grid in screening.conditions)
    same = "the same " if len(screening.designs) > 1 else ""
    lines = [f"each design at {same}{n_points} points: {'; '.join(said)}"]
    counts: Counter[str] = Counter()
    for found in screening.maps:
        counts[found.design] += int(found.substituted.sum())
    if stand_in := [f"{count} of {name}" for name, count in counts.items() if count]:
        lines.append(f"not from a design's own data: {', '.join(stand_in)}; {RULE}")
        lines += [text for text in [_fair(screening)] if text]
    return lines


def _fair(screening: Screening) -> str:
    """Say at which interferences no design's torques are held, where at some they are."""
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
