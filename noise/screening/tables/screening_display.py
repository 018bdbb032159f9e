"""Display of designs, screenings and robustness in a notebook."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from models.html_table import html_table
from noise.screening.design.axis_values import axis_words
from noise.screening.design.tolerances import unit_of
from noise.screening.tables.summary import probability_words, risk_words, sensitivity_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.screening.design.design import Design
    from noise.screening.design.tolerances import Tolerance
    from noise.screening.outcome import Screening
    from noise.screening.parts.robustness import Robustness

__all__ = ["design_html", "robustness_html", "screening_html"]


def screening_html(found: Screening) -> str:
    """Return the ranking as a table, with what the parts do where that was looked at."""
    rows = []
    for one in found.standings:
        stands = found.statistics_of(one.design, one.environment).robustness
        rows.append(
            [
                "-" if one.rank is None else str(one.rank),
                one.design,
                f"{one.environment}, {one.motion}",
                risk_words(one.risk),
                f"{1.0 - one.shares['none']:.0%}",
                "" if math.isnan(one.loudest_level) else f"{one.loudest_level:.0f} dB(A)",
                "" if math.isnan(one.margin_v_crit2) else f"{one.margin_v_crit2:+.3g}",
                "" if stands is None else probability_words(stands),
                one.words,
            ]
        )
    rows += [["", name, reason, *[""] * 6] for name, reason in found.refused]
    header = (
        "rank", "design", "where", "risk", "noisy use", "loudest", "margin [rad/s]", "parts",
        "in words",
    )  # fmt: skip
    caption = f"Screen of {found.points} points in {found.seconds:.1f} s"
    return html_table(caption, rows, header=header)


def design_html(design: Design) -> str:
    """Return what a design is and meets in use as tables."""
    use, rig = design.use, design.rig
    rows = [
        ["material", rig.material],
        ["friction", rig.friction.name],
        ["fits", _said([1e3 * fit.interference for fit in rig.fits], "mm")],
        ["speed of use", _said(use.speed, "rad/s")],
        ["interference of use", _said([1e3 * fit for fit in use.interference], "mm")],
        ["supports of use", _said(use.support_stiffness, "Nm/rad")],
        ["temperature of use", _said(use.temperature, "°C")],
    ]
    if use.swinging is not None:
        degrees = math.degrees(use.swinging.amplitude)
        rows.append(["swing", f"±{degrees:g}° at {_said(use.swinging.frequency, 'Hz')}"])
    rows += [[f"tolerance of {one.name}", _tolerance(one)] for one in design.tolerances]
    return html_table(f"Design {design.name}", rows)


def _said(values: Sequence[float], unit: str) -> str:
    if not values:
        return "not stated"
    return f"{axis_words(values)} {unit}"


def _tolerance(one: Tolerance) -> str:
    if one.kind == "relative":
        return f"{one.first:.3g} of the value, standard deviation"
    unit = unit_of(one.name)
    if one.kind == "absolute":
        return f"{one.first:.3g} {unit}, standard deviation"
    return f"{one.first:.4g} to {one.second:.4g} {unit}"


def robustness_html(found: Robustness) -> str:
    """Return what parts do, what matters and what helps as tables."""
    low, high = 100.0 * found.clear.low, 100.0 * found.clear.high
    margin = "nothing vibrates" if math.isinf(found.margin) else f"{found.margin:+.3g} rad/s"
    rows = [
        ["risk", risk_words(found.risk)],
        ["margin", margin],
        ["noise of parts", probability_words(found)],
        ["parts clear of vibration", f"{found.clear.value:.0%} ({low:.0f} to {high:.0f} %)"],
        ["matters most", sensitivity_words(found)],
        ["tolerances", "assumed" if found.assumed else "stated"],
    ]
    tables = [html_table(f"Robustness of {found.design}", rows)]
    sensitivities = [
        [one.name, _interval(one.first.value, one.first.low, one.first.high),
         _interval(one.total.value, one.total.low, one.total.high)]
        for one in found.sensitivities
    ]  # fmt: skip
    header = ("tolerance", "first index", "total index")
    tables.append(html_table("Sobol' indices of the margin", sensitivities, header=header))
    advice = [
        [one.name, f"{one.change:+.1%}", "yes" if one.enough else "no", brings]
        for advised in (found.margin_advice, found.noise_advice)
        for one in advised
        for brings in [one.label or f"{one.gain:+.2g} rad/s of margin"]
    ]
    if advice:
        named = ("change of", "by", "enough", "brings")
        tables.append(html_table("Advice, one change at a time", advice, header=named))
    return "\n".join(tables)


def _interval(value: float, low: float, high: float) -> str:
    return f"{value:.2f} ({low:.2f} to {high:.2f})"
