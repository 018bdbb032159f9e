"""Advice in words: the least change that widens the margin, and the least that ends the noise."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.screening.design.tolerances import PARAMETERS

if TYPE_CHECKING:
    from noise.screening.parts.statistics import Statistics


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
            brings = _DOES[aim]
            if aim == "margin":
                by = f"{brings} by {best.gain:.2g} rad/s"
                brings = by if math.isfinite(best.gain) else "leaves no speed that vibrates"
            said.append(f"{best.name} {best.change:+.1%} to {to} {brings}")
    return "; ".join(said)


_DOES = {"margin": "widens the margin", "noise": "ends the noise in the middle of the use"}

_FAILS = {
    "margin": "widens the margin as far as asked",
    "noise": "ends the noise in the middle of the use",
}
