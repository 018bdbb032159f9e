"""Converter, rates and lengths of runs and simulations (3.1.2, 6.3)."""

from __future__ import annotations

from noise.thesis.listing import STEP
from noise.thesis.row import Column, Row, between, number

_BIT = 2.5 / 2**12
"""Of a 12-bit converter over +-1.25 V [V]."""

_PRINTED_ERROR = 0.625e-3
"""Quantization error that 3.1.2 states [V]."""


def converter() -> list[Row]:
    """One bit of the converter; in the channels' units the thesis does not state it."""
    error = number(1e3 * _PRINTED_ERROR)
    return [Row("converter_bit", "12 bit over +-1.25 V", "mV", error, exact=1e3 * _BIT)]


def lengths() -> list[Row]:
    """Time steps and lengths."""
    return [
        Row(
            "time_step", "6.3; 4.2 and line 140 have 0.02 ms", "ms", number(0.2),
            listing=1e3 * STEP, judged=Column.LISTING, meant=number(0.02),
        ),
        Row(
            "simulated_time", "4096 steps", "ms", number(82.0), listing=1e3 * 4096 * STEP,
            judged=Column.LISTING,
        ),
        Row(
            "simulated_time", "40960 steps", "ms", number(820.0), listing=1e3 * 40960 * STEP,
            judged=Column.LISTING,
        ),
        Row(
            "highest_frequency", "sound through 15 kHz is half the sampling rate", "kHz",
            number(15.0), exact=0.5 * 30.0,
        ),
        Row("shaft_travel", "0.23 s at 10 rad/s", "rad", between(0.5, 3.0), exact=2.3),
        Row(
            "surface_speed", "45 rad/s on a shaft of 30 mm", "cm/s", number(67.0),
            exact=45.0 * 1.5,
        ),
    ]  # fmt: skip
