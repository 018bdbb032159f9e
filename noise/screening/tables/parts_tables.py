"""Tables and sentences about what tolerances and changes do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.screening.design.tolerances import PARAMETERS
from noise.screening.parts.probability import NOISES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from noise.screening.outcome import Screening
    from noise.screening.parts.advice import Advice
    from noise.screening.parts.robustness import Robustness
    from noise.screening.parts.statistics import Statistics

__all__ = [
    "ADVICE_COLUMNS",
    "PROBABILITY_COLUMNS",
    "SENSITIVITY_COLUMNS",
    "advice_rows",
    "advice_words",
    "parts_lines",
    "probability_cells",
    "probability_words",
    "sensitivity_rows",
    "sensitivity_words",
]

PROBABILITY_COLUMNS = (
    "tolerances",
    *(f"p_{label}{bound}" for label in NOISES for bound in ("", "_low", "_high")),
)
"""Of ``designs.csv``; empty where they were not looked at."""

SENSITIVITY_COLUMNS = (
    "design",
    "environment",
    "tolerances",
    "parameter",
    "first",
    "first_low",
    "first_high",
    "total",
    "total_low",
    "total_high",
)

ADVICE_COLUMNS = (
    "design",
    "environment",
    "aim",
    "parameter",
    "unit",
    "nominal",
    "advised",
    "change",
    "enough",
    "steady",
    "gain_rad_s",
    "slope_rad_s",
    "label",
)


def probability_cells(one: Statistics) -> dict[str, object]:
    """Cells of ``designs.csv`` that tell the probability of each noise among parts."""
    stands = one.robustness
    if stands is None:
        return {}
    cells: dict[str, object] = {"tolerances": _source(stands)}
    for label in NOISES:
        found = stands.noises.by_label[label]
        cells |= {
            f"p_{label}": round(found.value, 4),
            f"p_{label}_low": round(found.low, 4),
            f"p_{label}_high": round(found.high, 4),
        }
    return cells


def sensitivity_rows(screening: Screening) -> Iterator[dict[str, object]]:
    """Rows of ``sensitivities.csv``: Sobol' indices of the margin, a row a parameter."""
    for one in screening.statistics:
        for found in one.robustness.sensitivities if one.robustness else ():
            yield {
                "design": one.design,
                "environment": one.environment,
                "tolerances": _source(one.robustness),
                "parameter": found.name,
                "first": round(found.first.value, 4),
                "first_low": round(found.first.low, 4),
                "first_high": round(found.first.high, 4),
                "total": round(found.total.value, 4),
                "total_low": round(found.total.low, 4),
                "total_high": round(found.total.high, 4),
            }


def advice_rows(screening: Screening) -> Iterator[dict[str, object]]:
    """Rows of ``advice.csv``: changes that widen the margin, then those that end the noise."""
    for one in screening.statistics:
        if one.robustness is None:
            continue
        for aim, advised in (
            ("margin", one.robustness.margin_advice),
            ("noise", one.robustness.noise_advice),
        ):
            for found in advised:
                yield _advice_row(one, aim, found)


def _advice_row(one: Statistics, aim: str, found: Advice) -> dict[str, object]:
    nominal = one.nominal[found.name]
    return {
        "design": one.design,
        "environment": one.environment,
        "aim": aim,
        "parameter": found.name,
        "unit": PARAMETERS[found.name],
        "nominal": _short(nominal),
        "advised": _short(nominal * found.value),
        "change": _short(found.change),
        "enough": found.enough,
        "steady": found.steady,
        "gain_rad_s": _short(found.gain),
        "slope_rad_s": _short(found.slope),
        "label": found.label or None,
    }


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


def advice_words(one: Statistics) -> str:
    """Tell the least change that widens the margin, and the least that ends the noise."""
    stands = one.robustness
    if stands is None:
        return ""
    said = []
    for aim, advised in (("margin", stands.margin_advice), ("noise", stands.noise_advice)):
        enough = [found for found in advised if found.enough]
        # What stands on an island is the worse advice, however small the change.
        best = next((found for found in enough if found.steady), next(iter(enough), None))
        if best is None and advised:
            said.append(f"no single change {_FAILS[aim]}")
        if best is not None:
            to = f"{one.nominal[best.name] * best.value:.3g} {PARAMETERS[best.name]}"
            brings = f"{_DOES[aim]} by {best.gain:.2g} rad/s" if aim == "margin" else _DOES[aim]
            said.append(f"{best.name} {best.change:+.1%} to {to} {brings}")
    return "; ".join(said)


_DOES = {"margin": "widens the margin", "noise": "ends the noise in the middle of the use"}

_FAILS = {
    "margin": "widens the margin as far as asked",
    "noise": "ends the noise in the middle of the use",
}


def _source(stands: Robustness | None) -> str:
    return "assumed" if stands is not None and stands.assumed else "stated"


def _short(value: float) -> float:
    return value if math.isnan(value) else float(f"{value:.6g}")
