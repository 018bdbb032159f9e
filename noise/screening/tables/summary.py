"""Summary of a screening in a few lines: standings, and what tolerances and changes do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.base.remarks import constant_remark
from noise.screening.design.environments import environment, in_environment
from noise.screening.map.provenance import RULE, within_fits
from noise.screening.ranking.risk import risk_band

if TYPE_CHECKING:
    from noise.screening.outcome import Screening
    from noise.screening.parts.robustness import Robustness
    from noise.screening.parts.statistics import Statistics
    from noise.screening.ranking.ranking import Standing


def summary_lines(screening: Screening) -> list[str]:
    """Tell what a screen found, a line a design and motion, its parts below, and how it is known.

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> lines = summary_lines(screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,))))
    >>> lines[0]
    '1. PDMS, dry: risk 1 (no risk); quiet at all 4 points of use; nothing vibrates'
    """
    lines = []
    told: set[tuple[str, str]] = set()
    for one in screening.standings:
        lines += _standing_lines(one)
        where = one.design, one.environment
        if where not in told:
            told.add(where)
            lines += [f"   {line}" for line in parts_lines(screening.statistics_of(*where))]
            lines += [f"   note: {note}" for note in one.notes if note != one.never_slips]
    lines += conditions_lines(screening)
    how = ", ".join(
        f"{screening.count(way)} {words}"
        for way, words in (
            ("simulated", "simulated"),
            ("stability", "by stability"),
            ("refined", "by refinement"),
            ("unchanged", "as at another temperature or fit"),
        )
        if screening.count(way)
    )
    left = sum(found.open for found in screening.maps)
    boundary = f" ({left} beside a boundary, as their nearest neighbour)" if left else ""
    lines.append(f"{screening.points} points in {screening.seconds:.1f} s: {how}{boundary}")
    lines.append(f"risk and tolerances in {screening.statistics_seconds:.1f} s")
    return lines


def conditions_lines(screening: Screening) -> list[str]:
    """Say over which conditions all designs are compared, and where data are not their own.

    Examples
    --------
    >>> from noise.screening.design.design import Use
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
    if screening.substituted:
        counts = ", ".join(f"{count} of {name}" for name, count in screening.substituted.items())
        lines.append(f"not from a design's own data: {counts}; {RULE}")
        lines += [text for text in [_fair(screening)] if text]
    rigs = [
        in_environment(one.rig, environment(where))
        for one in screening.designs
        for where in dict.fromkeys(found.environment for found in screening.maps)
    ]
    constant = constant_remark(rigs, "labels, levels, risks and critical speeds")
    return [*lines, f"{constant}; sounds have it"] if constant else lines


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


def _standing_lines(one: Standing) -> list[str]:
    where = one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}"
    if one.rank is None:
        why = one.never_slips or "with the shaft turning it never slips"
        return [f"-. {one.design}, {where}: no rank; {why}"]
    head = f"{one.rank}. {one.design}, {where}: risk {risk_words(one.risk)}; {one.words}"
    if one.loudest_label == "none":
        return [head]
    facts = [f"up to {one.loudest_level:.0f} dB(A) ({one.loudest_label})"]
    facts += [f"exposure {one.exposure:.3g}"]
    if one.motion == "steady":
        facts += [f"V_crit1 {_speed(one.v_crit1)}, V_crit2 {_speed(one.v_crit2)}"]
        facts += [f"margin {one.margin_v_crit2:+.3g} rad/s"]
    lines = [head, f"   {', '.join(facts)}"]
    return [*lines, f"   what helps: {one.hint}"] if one.hint else lines


def _speed(value: float) -> str:
    return "beyond the map" if math.isinf(value) else f"{value:.3g}"


def risk_words(risk: int | None) -> str:
    """Tell a risk number with its band.

    Examples
    --------
    >>> risk_words(4), risk_words(None)
    ('4 (conditional)', 'not known')
    """
    return "not known" if risk is None else f"{risk} ({risk_band(risk)})"


def parts_lines(one: Statistics) -> list[str]:
    """Tell in two lines what noise parts make, and what matters most.

    Examples
    --------
    >>> from noise.screening.parts.statistics import Statistics
    >>> parts_lines(Statistics("soft", "dry", failed=("risk: no fit",)))
    ['not told: risk: no fit']
    """
    lines = [f"not told: {why}" for why in one.failed]
    stands = one.robustness
    if stands is None:
        return lines
    assumed = " (tolerances assumed)" if stands.assumed else ""
    lines.append(f"a part{assumed} at a speed of its use: {probability_words(stands)}")
    lines.append(f"matters most: {sensitivity_words(stands)}")
    return lines


def probability_words(stands: Robustness) -> str:
    """Tell the probability of each noise that occurs, with its interval."""
    said = [
        f"{label} {found.value:.0%} ({found.low:.0%} to {found.high:.0%})"
        for label, found in stands.noises.by_label.items()
        if found.value > 0.0 and label != "none"
    ]
    if said:
        return ", ".join(said)
    return f"no noise, with {stands.noises.any_but().high:.0%} at most"


def sensitivity_words(stands: Robustness) -> str:
    """Tell which tolerance the margin scatters most by."""
    found = stands.sensitivities[0]
    if found.total.value <= 0.0:
        return "no tolerance moves the margin"
    return (
        f"the tolerance of {found.name}, {min(1.0, found.total.value):.0%} of the margin's scatter"
    )
