"""Tables of a screening: map, critical speeds and designs; and its summary in a few lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from noise.screening.map.batches import LABELS
from noise.screening.ranking.risk import risk_band
from noise.screening.tables.parts_tables import PROBABILITY_COLUMNS, parts_lines, probability_cells
from noise.screening.tables.screening_display import risk_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from noise.screening.map.mapping import DesignMap
    from noise.screening.outcome import Screening
    from noise.screening.parts.statistics import Statistics
    from noise.screening.ranking.margins import CriticalPoint
    from noise.screening.ranking.ranking import Standing

__all__ = [
    "CRITICAL_COLUMNS",
    "DESIGN_COLUMNS",
    "MAP_COLUMNS",
    "critical_rows",
    "design_rows",
    "map_rows",
    "summary_lines",
]

MAP_COLUMNS = (
    "design",
    "environment",
    "motion",
    "temperature_C",
    "speed_rad_s",
    "frequency_hz",
    "interference_mm",
    "support_stiffness_Nm_rad",
    "regime",
    "label",
    "level_db",
    "loudness",
    "how",
)

CRITICAL_COLUMNS = (
    "design",
    "environment",
    "temperature_C",
    "interference_mm",
    "support_stiffness_Nm_rad",
    "v_crit1_rad_s",
    "v_crit2_rad_s",
    "v_crit2_stability_rad_s",
    "margin_v_crit1_rad_s",
    "margin_v_crit2_rad_s",
    "margin_stability_rad_s",
)

DESIGN_COLUMNS = (
    "rank",
    "design",
    "environment",
    "motion",
    "risk",
    "risk_band",
    *PROBABILITY_COLUMNS,
    "exposure",
    *(f"share_{label}" for label in LABELS),
    "loudest_level_db",
    "loudest_label",
    "v_crit1_rad_s",
    "v_crit2_rad_s",
    "margin_v_crit1_rad_s",
    "margin_v_crit2_rad_s",
    "margin_stability_rad_s",
    "error",
)


def map_rows(screening: Screening) -> Iterator[dict[str, object]]:
    """Rows of ``map.csv``, one a point."""
    for found in screening.maps:
        yield from _map_rows(found)


def _map_rows(found: DesignMap) -> Iterator[dict[str, object]]:
    grid = found.grid
    for t, k, i, v in np.ndindex(found.label.shape):
        where = t, k, i, v
        yield {
            "design": found.design,
            "environment": found.environment,
            "motion": found.motion,
            "temperature_C": grid.temperature[t],
            "speed_rad_s": _short(grid.speed[v]),
            "frequency_hz": grid.frequency[v] if grid.frequency else None,
            "interference_mm": _short(1e3 * grid.interference[i]),
            "support_stiffness_Nm_rad": _support(grid.support_stiffness[k]),
            "regime": str(found.regime[where]),
            "label": str(found.label[where]),
            "level_db": round(float(found.level[where]), 2),
            "loudness": round(float(found.loudness[where]), 3),
            "how": str(found.how[where]),
        }


def critical_rows(screening: Screening) -> Iterator[dict[str, object]]:
    """Rows of ``critical_speeds.csv``, one a temperature, fit and support."""
    for point in screening.critical:
        yield _critical_row(point)


def _critical_row(point: CriticalPoint) -> dict[str, object]:
    return {
        "design": point.design,
        "environment": point.environment,
        "temperature_C": point.temperature,
        "interference_mm": _short(1e3 * point.interference),
        "support_stiffness_Nm_rad": _support(point.support_stiffness),
        "v_crit1_rad_s": _short(point.v_crit1),
        "v_crit2_rad_s": _short(point.v_crit2),
        "v_crit2_stability_rad_s": _short(point.v_crit2_stability),
        "margin_v_crit1_rad_s": _short(point.margin_v_crit1),
        "margin_v_crit2_rad_s": _short(point.margin_v_crit2),
        "margin_stability_rad_s": _short(point.margin_stability),
    }


def design_rows(screening: Screening) -> Iterator[dict[str, object]]:
    """Rows of ``designs.csv``, the quietest first, those refused last."""
    for one in screening.standings:
        yield _design_row(one, screening.statistics_of(one.design, one.environment))
    for name, reason in screening.refused:
        yield {"design": name, "error": reason}


def _design_row(one: Standing, told: Statistics) -> dict[str, object]:
    return {
        "rank": one.rank,
        "design": one.design,
        "environment": one.environment,
        "motion": one.motion,
        "risk": one.risk,
        "risk_band": None if one.risk is None else risk_band(one.risk),
        **probability_cells(told),
        "exposure": _short(one.exposure),
        **{f"share_{label}": round(share, 4) for label, share in one.shares.items()},
        "loudest_level_db": round(one.loudest_level, 2),
        "loudest_label": one.loudest_label,
        "v_crit1_rad_s": _short(one.v_crit1),
        "v_crit2_rad_s": _short(one.v_crit2),
        "margin_v_crit1_rad_s": _short(one.margin_v_crit1),
        "margin_v_crit2_rad_s": _short(one.margin_v_crit2),
        "margin_stability_rad_s": _short(one.margin_stability),
        "error": "; ".join(filter(None, (one.never_slips, *told.failed))) or None,
    }


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


def _support(stiffness: float) -> float | str:
    return "fixed" if math.isinf(stiffness) else stiffness


def _short(value: float) -> float:
    return float(f"{value:.6g}")
