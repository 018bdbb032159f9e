"""Constants and numbers that the thesis prints wrongly or in two ways."""

from __future__ import annotations

from noise.thesis.row import Row, number

__all__ = ["misprints"]


def misprints() -> list[Row]:
    """Return the WLF constants, and the band of the transfer film's vibration."""
    return [
        # Williams, Landel and Ferry (1955)
        Row(
            "wlf_constant", "(2.1), first", "1", number(8.88), exact=8.86, meant=number(8.86),
            tolerance=1e-3,
        ),
        Row(
            "wlf_constant", "(2.1), second", "K", number(101.5), exact=101.6, meant=number(101.6),
            tolerance=5e-4,
        ),
        Row(
            "film_band", "natural rubber, lower end, 6.2; 5.2.3 has 250 Hz", "Hz",
            number(25e3, "25000"), exact=250.0, meant=number(250.0),
        ),
        Row(
            "film_band", "natural rubber, upper end, 6.2; 5.2.3 has 1500 Hz", "Hz",
            number(1500e3, "1500000"), exact=1500.0, meant=number(1500.0),
        ),
        Row(
            "film_mode", "natural rubber, first, 6.2; 5.2.3 has 250 Hz", "Hz", number(25.0),
            exact=250.0, meant=number(250.0),
        ),
    ]  # fmt: skip
