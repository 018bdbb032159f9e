"""Tables of a screening: map, critical speeds, designs, sensitivities and advice."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from noise.screening.design.tolerances import PARAMETERS
from noise.screening.map.batches import LABELS
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.probability import NOISES
from noise.screening.ranking.risk import risk_band

if TYPE_CHECKING:
    from noise.screening.outcome import Screening
    from noise.screening.parts.robustness import Robustness
    from noise.screening.parts.statistics import Statistics

    Columns = Mapping[str, Callable[..., object]]
    Table = tuple[tuple[str, ...], list[dict[str, object]]]


def screening_tables(screening: Screening) -> dict[str, Table]:
    """Return all tables of a screening; the last two only where tolerances were looked at.

    Returns
    -------
    dict of str to (tuple of str, list of dict)
        Columns and rows by the name of the file: ``map.csv`` with a row per point,
        ``critical_speeds.csv`` with one a temperature, fit and support, ``designs.csv`` with the
        quietest first and those refused last, ``sensitivities.csv`` of Sobol' indices of the margin
        with a row per parameter, and ``advice.csv`` of changes that widen the margin, then of those
        that end the noise.

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> columns, rows = screening_tables(found)["designs.csv"]
    >>> columns[:3], rows[0]["risk_band"]
    (('rank', 'design', 'environment'), 'no risk')
    """
    told = [(one, one.robustness) for one in screening.statistics if one.robustness is not None]
    points = ((found, at) for found in screening.maps for at in np.ndindex(found.label.shape))
    standings = (
        (one, screening.statistics_of(one.design, one.environment)) for one in screening.standings
    )
    columns, rows = _table(_DESIGNS, standings)
    rows += [{"design": name, "error": reason} for name, reason in screening.refused]
    tables = {
        "map.csv": _table(_MAP, points),
        "critical_speeds.csv": _table(_CRITICAL, ((point,) for point in screening.critical)),
        "designs.csv": (columns, rows),
    }
    if told:
        sensitivities = ((*both, found) for both in told for found in both[1].sensitivities)
        advice = (
            (one, aim, found)
            for one, robust in told
            for aim, advised in (("margin", robust.margin_advice), ("noise", robust.noise_advice))
            for found in advised
        )
        tables["sensitivities.csv"] = _table(_SENSITIVITIES, sensitivities)
        tables["advice.csv"] = _table(_ADVICE, advice)
    return tables


def _table(columns: Columns, items: Iterable[tuple[Any, ...]]) -> Table:
    return tuple(columns), [{name: cell(*item) for name, cell in columns.items()} for item in items]


def _short(value: float) -> float:
    return value if math.isnan(value) else float(f"{value:.6g}")


def _support(stiffness: float) -> float | str:
    return "fixed" if math.isinf(stiffness) else stiffness


def _source(robust: Robustness | None) -> str | None:
    return None if robust is None else "assumed" if robust.assumed else "stated"


_BOUNDS = {"": "value", "_low": "low", "_high": "high"}


def _with_bounds(name: str, estimate: Callable[..., object]) -> Columns:
    """Columns of an estimate and of the ends of its interval."""

    def cell(attribute: str) -> Callable[..., object]:
        def rounded(*item: object) -> float | None:
            found = estimate(*item)
            return None if found is None else round(getattr(found, attribute), 4)

        return rounded

    return {f"{name}{ending}": cell(attribute) for ending, attribute in _BOUNDS.items()}


def _probability(label: str) -> Columns:
    def estimate(_: object, told: Statistics) -> Estimate | None:
        robust = told.robustness
        return None if robust is None else robust.noises.by_label[label]

    return _with_bounds(f"p_{label}", estimate)


def _share(label: str) -> Columns:
    return {f"share_{label}": lambda one, _: round(one.shares[label], 4)}


_MAP: Columns = {
    "design": lambda found, _: found.design,
    "environment": lambda found, _: found.environment,
    "motion": lambda found, _: found.motion,
    "temperature_C": lambda found, at: found.grid.temperature[at[0]],
    "speed_rad_s": lambda found, at: _short(found.grid.speed[at[3]]),
    "frequency_hz": lambda found, at: found.grid.frequency[at[3]] if found.grid.frequency else None,
    "interference_mm": lambda found, at: _short(1e3 * found.grid.interference[at[2]]),
    "support_stiffness_Nm_rad": lambda found, at: _support(found.grid.support_stiffness[at[1]]),
    "regime": lambda found, at: str(found.regime[at]),
    "label": lambda found, at: str(found.label[at]),
    "level_dba": lambda found, at: round(float(found.level[at]), 2),
    "l_afmax_dba": lambda found, at: round(float(found.level_max[at]), 2),
    "loudness_n5_sone": lambda found, at: round(float(found.loudness[at]), 3),
    "how": lambda found, at: str(found.how[at]),
    "note": lambda found, at: found.note[at] or None,
}

_SPEEDS: Columns = {
    f"{name}_rad_s": lambda one, *_, name=name: _short(getattr(one, name))
    for name in (
        "v_crit1", "v_crit2", "v_crit2_stability",
        "margin_v_crit1", "margin_v_crit2", "margin_stability",
    )
}  # fmt: skip

_CRITICAL: Columns = {
    "design": lambda point: point.design,
    "environment": lambda point: point.environment,
    "temperature_C": lambda point: point.temperature,
    "interference_mm": lambda point: _short(1e3 * point.interference),
    "support_stiffness_Nm_rad": lambda point: _support(point.support_stiffness),
    **_SPEEDS,
}

_DESIGNS: Columns = {
    "rank": lambda one, _: one.rank,
    "design": lambda one, _: one.design,
    "environment": lambda one, _: one.environment,
    "motion": lambda one, _: one.motion,
    "risk": lambda one, _: one.risk,
    "risk_band": lambda one, _: None if one.risk is None else risk_band(one.risk),
    "tolerances": lambda _, told: _source(told.robustness),
    **{name: cell for label in NOISES for name, cell in _probability(label).items()},
    "exposure": lambda one, _: _short(one.exposure),
    **{name: cell for label in LABELS for name, cell in _share(label).items()},
    "loudest_level_dba": lambda one, _: round(one.loudest_level, 2),
    "loudest_l_afmax_dba": lambda one, _: round(one.loudest_level_max, 2),
    "loudest_label": lambda one, _: one.loudest_label,
    **{name: cell for name, cell in _SPEEDS.items() if name != "v_crit2_stability_rad_s"},
    "words": lambda one, _: one.words,
    "hint": lambda one, _: one.hint or None,
    "notes": lambda one, _: "; ".join(one.notes) or None,
    "error": lambda one, told: "; ".join(filter(None, (one.never_slips, *told.failed))) or None,
}

_SENSITIVITIES: Columns = {
    "design": lambda one, *_: one.design,
    "environment": lambda one, *_: one.environment,
    "tolerances": lambda _, robust, __: _source(robust),
    "parameter": lambda *item: item[-1].name,
    **_with_bounds("first", lambda *item: item[-1].first),
    **_with_bounds("total", lambda *item: item[-1].total),
}

_ADVICE: Columns = {
    "design": lambda one, *_: one.design,
    "environment": lambda one, *_: one.environment,
    "aim": lambda _, aim, __: aim,
    "parameter": lambda *item: item[-1].name,
    "unit": lambda *item: PARAMETERS[item[-1].name],
    "nominal": lambda one, _, found: _short(one.nominal[found.name]),
    "advised": lambda one, _, found: _short(one.nominal[found.name] * found.value),
    "change": lambda *item: _short(item[-1].change),
    "enough": lambda *item: item[-1].enough,
    "steady": lambda *item: item[-1].steady,
    "gain_rad_s": lambda *item: _short(item[-1].gain),
    "slope_rad_s": lambda *item: _short(item[-1].slope),
    "label": lambda *item: item[-1].label or None,
}
