"""Tables of a screening: map, critical speeds, designs and advice."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from noise.base.labels import PERSISTS
from noise.screening.design import PARAMETERS
from noise.screening.standing import SHARED

if TYPE_CHECKING:
    from noise.screening.screen import Screening

Columns = Mapping[str, Callable[..., object]]
Table = tuple[tuple[str, ...], list[dict[str, object]]]


def screening_tables(screening: Screening) -> dict[str, Table]:
    """Return all tables of a screening; the last only where it has rows.

    Returns
    -------
    dict of str to (tuple of str, list of dict)
        Columns and rows by the name of the file: ``map.csv`` with a row a point,
        ``critical_speeds.csv`` with one a temperature, fit and support, ``designs.csv`` with the
        quietest first and those refused last, ``advice.csv`` of changes and whether they end the
        loudest noise of use.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> columns, rows = screening_tables(found)["designs.csv"]
    >>> columns[:3], rows[0]["mean_loudness_sone"]
    (('rank', 'design', 'environment'), 0.0)
    """
    points = ((mapped, at) for mapped in screening.maps for at in np.ndindex(mapped.label.shape))
    places = (
        (one, one.mapped.grid, at)
        for one in screening.standings
        if one.critical
        for at in np.ndindex(one.mapped.grid.shape[:3])
    )
    columns, rows = _table(_DESIGNS, ((one,) for one in screening.standings))
    rows += [{"design": name, "error": reason} for name, reason in screening.refused]
    offers = [(one, offer) for one in screening.standings for offer in one.offers]
    tables = {
        "map.csv": _table(_MAP, points),
        "critical_speeds.csv": _table(_CRITICAL, places),
        "designs.csv": (columns, rows),
    }
    return tables | ({"advice.csv": _table(_ADVICE, offers)} if offers else {})


def _table(columns: Columns, items: Iterable[tuple[Any, ...]]) -> Table:
    return tuple(columns), [{name: cell(*item) for name, cell in columns.items()} for item in items]


def _short(value: float) -> float:
    return value if math.isnan(value) else float(f"{value:.6g}")


def _support(stiffness: float) -> float | str:
    return "fixed" if math.isinf(stiffness) else stiffness


def _loudest(axis: str, scale: float = 1.0) -> Callable[..., object]:
    def cell(one: Any) -> object:
        return None if one.loudest is None else _short(scale * getattr(one.loudest, axis))

    return cell


_OF_DESIGN: Columns = {
    "design": lambda one, *_: one.mapped.design,
    "environment": lambda one, *_: one.mapped.environment,
}

_MAP: Columns = {
    "design": lambda mapped, _: mapped.design,
    "environment": lambda mapped, _: mapped.environment,
    "motion": lambda mapped, _: mapped.motion,
    "temperature_C": lambda mapped, at: mapped.grid.temperature[at[0]],
    "speed_rad_s": lambda mapped, at: _short(mapped.grid.speed[at[3]]),
    "frequency_hz": lambda one, at: one.grid.frequency[at[3]] if one.grid.frequency else None,
    "interference_mm": lambda mapped, at: _short(1e3 * mapped.grid.interference[at[2]]),
    "support_stiffness_Nm_rad": lambda mapped, at: _support(mapped.grid.support_stiffness[at[1]]),
    "regime": lambda mapped, at: str(mapped.regime[at]),
    "label": lambda mapped, at: str(mapped.sound[at]),
    "persists": lambda mapped, at: str(mapped.label[at]) == PERSISTS,
    "label_by_physics": lambda mapped, at: str(mapped.physics[at]),
    "growth_1_s": lambda mapped, at: round(float(mapped.growth[at]), 3),
    "level_dba": lambda mapped, at: round(float(mapped.level[at]), 2),
    "l_afmax_dba": lambda mapped, at: round(float(mapped.level_max[at]), 2),
    "how": lambda mapped, at: str(mapped.how[at]),
}

_MARGINS = "margin_v_crit1", "margin_v_crit2", "margin_stability"
_SPEEDS = "v_crit1", "v_crit1_high", "v_crit2", "v_crit2_high", "v_crit2_stability", *_MARGINS

_CRITICAL: Columns = {
    **_OF_DESIGN,
    "temperature_C": lambda _, grid, at: grid.temperature[at[0]],
    "interference_mm": lambda _, grid, at: _short(1e3 * grid.interference[at[2]]),
    "support_stiffness_Nm_rad": lambda _, grid, at: _support(grid.support_stiffness[at[1]]),
    **{
        f"{name}_rad_s": lambda one, _, at, name=name: _short(one.critical[name][at])
        for name in _SPEEDS
    },
}

_DESIGNS: Columns = {
    "rank": lambda one: one.rank,
    **_OF_DESIGN,
    "motion": lambda one: one.mapped.motion,
    "mean_loudness_sone": lambda one: _short(one.mean_loudness),
    **{f"share_{label}": lambda one, label=label: round(one.shares[label], 4) for label in SHARED},
    "loudest_label": lambda one: one.loudest_label,
    "loudest_level_dba": lambda one: round(one.loudest_level, 2),
    "loudest_l_afmax_dba": lambda one: round(one.loudest_level_max, 2),
    "loudest_speed_rad_s": _loudest("speed"),
    "loudest_interference_mm": _loudest("interference", 1e3),
    "loudest_support_stiffness_Nm_rad": _loudest("support_stiffness"),
    **{
        f"{name}_rad_s": lambda one, name=name: _short(one.worst(name))
        for name in ("v_crit1", "v_crit2", "v_crit2_high", *_MARGINS)
    },
    "p_noisy_part": lambda one: one.parts and round(one.parts.probability, 4),
    "p_noisy_part_low": lambda one: one.parts and round(one.parts.low, 4),
    "p_noisy_part_high": lambda one: one.parts and round(one.parts.high, 4),
    "notes": lambda one: "; ".join(one.notes) or None,
    "error": lambda _: None,
}

_ADVICE: Columns = {
    **_OF_DESIGN,
    "label": lambda one, _: one.loudest_label,
    "speed_rad_s": lambda one, _: _short(one.loudest.speed),
    "interference_mm": lambda one, _: _short(1e3 * one.loudest.interference),
    "support_stiffness_Nm_rad": lambda one, _: _support(one.loudest.support_stiffness),
    "parameter": lambda _, offer: offer.name,
    "unit": lambda _, offer: PARAMETERS[offer.name],
    "nominal": lambda _, offer: _short(offer.nominal),
    "advised": lambda _, offer: _short(offer.value) if offer.ends else None,
    "change_percent": lambda _, offer: offer.percent,
    "ends_noise": lambda _, offer: offer.ends,
    "quiet_from_rest_percent": lambda _, offer: offer.from_rest,
    "quiet_elsewhere": lambda _, offer: offer.quiet_elsewhere if offer.ends else None,
    "elsewhere": lambda _, offer: offer.elsewhere if offer.ends else None,
    "limit": lambda _, offer: offer.limit or None,
}
