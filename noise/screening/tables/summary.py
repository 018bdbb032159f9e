"""Summary of a screening in a few lines: standings, and what tolerances and changes do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from noise.screening.parts.advice_words import advice_words
from noise.screening.ranking.risk import risk_band

if TYPE_CHECKING:
    from noise.screening.outcome import Screening
    from noise.screening.parts.robustness import Robustness
    from noise.screening.parts.statistics import Statistics
    from noise.screening.ranking.ranking import Standing

__all__ = [
    "parts_lines",
    "probability_words",
    "risk_words",
    "sensitivity_words",
    "summary_lines",
]


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
        lines.append(_standing_line(one, screening))
        where = one.design, one.environment
        if where not in told:
            told.add(where)
            lines += [f"   {line}" for line in parts_lines(screening.statistics_of(*where))]
    how = ", ".join(
        f"{screening.count(way)} {words}"
        for way, words in (
            ("simulated", "simulated"),
            ("stability", "by stability"),
            ("refined", "by refinement"),
            ("unchanged", "alike at another temperature"),
        )
        if screening.count(way)
    )
    left = sum(found.open for found in screening.maps)
    boundary = f" ({left} beside a boundary, as their nearest neighbour)" if left else ""
    lines.append(f"{screening.points} points in {screening.seconds:.1f} s: {how}{boundary}")
    lines.append(f"risk and tolerances in {screening.statistics_seconds:.1f} s")
    return lines


def _standing_line(one: Standing, screening: Screening) -> str:
    where = one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}"
    mapped = next(
        found
        for found in screening.maps
        if (found.design, found.environment, found.motion)
        == (one.design, one.environment, one.motion)
    )
    if one.rank is None:
        why = one.never_slips or "with the shaft turning it never slips"
        return f"-. {one.design}, {where}: no rank; {why}"
    low, high = mapped.grid.use
    speed = np.array(mapped.grid.speed)
    used = mapped.label[..., (speed >= low * 0.999999) & (speed <= high * 1.000001)].size
    head = f"{one.rank}. {one.design}, {where}: risk {risk_words(one.risk)}; "
    noisy = {name: share for name, share in one.shares.items() if name != "none" and share > 0.0}
    if not noisy:
        text = f"quiet at all {used} points of use"
        text += f" ({one.never_slips})" if one.never_slips else ""
    else:
        said = ", ".join(f"{name} {share:.0%}" for name, share in noisy.items())
        text = f"{said} of {used} points of use, up to {one.loudest_level:.0f} dB(A)"
        text += f" ({one.loudest_label}), exposure {one.exposure:.3g}"
    if one.motion != "steady":
        return head + text
    if one.v_crit2 == 0.0:
        return f"{head}{text}; nothing vibrates"
    return (
        f"{head}{text}; V_crit1 {_speed(one.v_crit1)}, V_crit2 {_speed(one.v_crit2)}, "
        f"margin {one.margin_v_crit2:+.3g} rad/s"
    )


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
    """Tell in three lines what noise parts make, what matters most, and what to change.

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
    lines.append(f"parts{assumed}: {probability_words(stands)}")
    lines.append(f"matters most: {sensitivity_words(stands)}")
    if advice := advice_words(one):
        lines.append(f"advice: {advice}")
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
