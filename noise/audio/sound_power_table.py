"""Table of the sound power of a run: one-third octaves and their sum, plain and A-weighted."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import NOMINAL_THIRD_OCTAVES, a_weighting
from models.radiation.sound_power import BandPower

COLUMNS = (
    "band_hz",
    "power_level_db",
    "power_level_dba",
)
"""Nominal middle of the band, sound power levels [dB re 1 pW] of the plate in a rigid baffle."""

TOTAL = "total"
"""What stands for the band in the last row, the sum of all bands."""


def sound_power_rows(power: BandPower) -> list[dict[str, object]]:
    """Rows by `COLUMNS`, one a band and one of their sum.

    Parameters
    ----------
    power : BandPower

    Returns
    -------
    list of dict
        Levels in dB re 1 pW to 0.01 dB; None for a band without power.
    """
    levels = [power.level, power.level + a_weighting(power.centre)]
    first = NOMINAL_THIRD_OCTAVES.index(f"{power.centre[0]:.0f}")
    bands = (*NOMINAL_THIRD_OCTAVES[first : first + power.level.size], TOTAL)
    columns = [[*map(_level, column), _level(_sum(column))] for column in levels]
    return [dict(zip(COLUMNS, row, strict=True)) for row in zip(bands, *columns, strict=True)]


def _sum(levels: NDArray[np.float64]) -> float:
    with np.errstate(divide="ignore"):
        return float(10.0 * np.log10(np.sum(10.0 ** (levels / 10.0))))


def _level(value: float) -> float | None:
    return round(float(value), 2) if math.isfinite(value) else None
