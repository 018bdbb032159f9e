"""Frictional heat (6.1, Appendix G)."""

from __future__ import annotations

import math

from models.heating import (
    RUBBER,
    STEEL,
    Layer,
    contact_area,
    heat_shares,
    interface_rise,
    temperature_rise,
)
from noise.thesis.row import Row, number

__all__ = ["heating"]

_POWER = 30.0 * 10.0
"""30 Nm at 10 rad/s [W]."""

_SECONDS = 0.23
_RISE = 26.0
"""Published [K]."""

_PAINT = Layer(50e-6, 0.2)
"""Of the shaft, assumed."""


def heating() -> list[Row]:
    """Shares of the heat, temperatures at the surface and below."""
    into_steel, into_rubber = heat_shares(STEEL, RUBBER)
    area = contact_area(_POWER, _RISE, _SECONDS)
    flux = into_rubber * _POWER / area
    steel_flux = into_steel * _POWER / area
    # (G3) as it is printed, without the power of 1/2.
    printed = 2.0 * steel_flux / STEEL.conductivity * STEEL.diffusivity * _SECONDS / math.pi
    where = "30 Nm, 10 rad/s, 0.23 s"
    return [
        Row("heat_share", "into steel", "%", number(92.0), exact=100.0 * into_steel, digits=3),
        Row(
            "heat_share", "into rubber", "%", number(8.0), exact=100.0 * into_rubber,
            tolerance=0.06, digits=2,
        ),
        Row(
            "contact_area", f"{where}, that gives 26 K", "cm2", number(0.0, "0.2 of apparent"),
            digits=3,
        ),
        Row(
            "temperature_rise", f"{where}, contact 7.69 cm2; (G3)", "K", number(_RISE),
            exact=interface_rise(_POWER, 7.69e-4, _SECONDS), as_printed=printed, digits=3,
            in_sample=True,
        ),
        Row(
            "temperature_rise", f"{where}, 0.4 mm deep, printed 0.0004 mm", "K",
            number(0.0, "0 (22 C, as the room)"),
            exact=temperature_rise(RUBBER, flux, _SECONDS, 0.4e-3),
            as_printed=temperature_rise(RUBBER, flux, _SECONDS, 0.4e-6),
            scale=_RISE, tolerance=0.02, digits=2,
        ),
        Row(
            "temperature_rise", f"{where}, under 50 um of paint", "K",
            number(_RISE, "26, most conservative"),
            exact=interface_rise(_POWER, area, _SECONDS, layer=_PAINT), digits=2,
        ),
    ]  # fmt: skip
