"""Constants and numbers that the thesis prints wrongly or in two ways."""

from __future__ import annotations

from noise.thesis.row import Row, number

_MISPRINTS = (
    # Williams, Landel and Ferry (1955)
    ("wlf_constant", "(2.1), first", "1", "8.88", 8.86, 1e-3),
    ("wlf_constant", "(2.1), second", "K", "101.5", 101.6, 5e-4),
    ("film_band", "natural rubber, lower end, 6.2; 5.2.3 has 250 Hz", "Hz", "25000", 250.0, 0.01),
    ("film_band", "natural rubber, upper end, 6.2; 5.2.3 has 1500 Hz", "Hz", "1500000", 1500.0,
     0.01),
    ("film_mode", "natural rubber, first, 6.2; 5.2.3 has 250 Hz", "Hz", "25", 250.0, 0.01),
)  # fmt: skip
"""Item, condition, unit, what is printed, what is meant, and the tolerance."""


def misprints() -> list[Row]:
    """Return the WLF constants, and the band of the transfer film's vibration."""
    return [
        Row(
            item, where, unit, number(float(printed), printed), exact=meant, meant=number(meant),
            tolerance=tolerance,
        )
        for item, where, unit, printed, meant, tolerance in _MISPRINTS
    ]  # fmt: skip
