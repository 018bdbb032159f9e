"""Converter, rates and lengths of runs and simulations (3.1.2, 6.3)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.thesis.row import Column, Row, between, number
from sim.acquisition import CONVERTER_GAIN
from sim.analysis.thesis_listing import STEP

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["converter", "lengths"]

_BIT = 2.5 / 2**12
"""Of a 12-bit converter over +-1.25 V [V]."""

_UNITS = {"torque": "Nm", "acceleration": "m/s2", "pressure": "Pa", "angle": "rad"}

_PRINTED_ERROR = 0.625e-3
"""Quantization error that 3.1.2 states [V]."""

_REFERENCE_PRESSURE = 20e-6


def converter() -> Iterator[Row]:
    """One bit of the converter, in volts and in each channel's unit."""
    error = number(1e3 * _PRINTED_ERROR)
    yield Row("converter_bit", "12 bit over +-1.25 V", "mV", error, exact=1e3 * _BIT)
    for channel, gain in CONVERTER_GAIN.items():
        printed = _PRINTED_ERROR * gain
        yield Row(
            "converter_bit", f"{channel}, 0.625 mV at {gain:g} {_UNITS[channel]}/V",
            _UNITS[channel], number(printed, f"{printed:.3g}"), exact=_BIT * gain, digits=3,
        )  # fmt: skip
    gain = CONVERTER_GAIN["pressure"]
    printed_level, level = (
        20.0 * math.log10(volts * gain / math.sqrt(2.0) / _REFERENCE_PRESSURE)
        for volts in (_PRINTED_ERROR, _BIT)
    )
    yield Row(
        "converter_bit", "level of a sine of one bit", "dB",
        number(printed_level, f"{printed_level:.1f}"), exact=level, digits=3,
    )  # fmt: skip


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
