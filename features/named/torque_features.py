"""Features of the torque: how much, how it oscillates, and whether it sticks and slips.

Levels are in newton metres and need a calibrated channel. Everything else describes the oscillation
about the mean from 5 Hz to 7 kHz, so that neither the gain nor a drifting offset matters.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from features.kernels.bands import band_power, relative_db
from features.kernels.conditioning import usable_limit
from features.named.feature import THESIS_STICK_SLIP, THIS, Feature
from features.named.spectral_features import HARMONIC_FEATURES, LINE_FEATURES

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["TORQUE_FEATURES"]

_torque = partial(Feature, kinds=("torque",))

_HIGH_FROM = 2_000.0
"""A torque has little above [Hz] (thesis, 5.2.3)."""


def _high_band(p: Prepared) -> float:
    if usable_limit(p.rate) <= _HIGH_FROM:
        return math.nan
    part, whole = band_power(p.spectrum, [_HIGH_FROM, p.low], [p.limit, p.limit])
    return relative_db(float(part), float(whole))


TORQUE_FEATURES = (
    _torque("mean", "N m", "Mean torque, signed.",
            "thesis, Fig. 5.3", lambda p: p.mean, silent=None, calibrated=True),
    _torque("oscillation", "N m", "Rms value about the mean.",
            THESIS_STICK_SLIP, lambda p: p.rms, silent=None, calibrated=True),
    _torque("relative_oscillation", "1", "Rms value about the mean over the mean's magnitude.",
            THESIS_STICK_SLIP, lambda p: p.rms / abs(p.mean) if p.mean != 0.0 else math.nan,
            silent=None),
    *HARMONIC_FEATURES,
    *LINE_FEATURES,
    _torque("high_band", "dB", "Level above 2 kHz re that of the whole oscillation.",
            "thesis, 5.2.3", _high_band, tolerance=(0.0, 0.1)),
    _torque("kurtosis", "1",
            "Fourth moment of the oscillation over the squared second; 1.5 for a sine.",
            THIS, lambda p: p.kurtosis, tolerance=(0.05, 0.0)),
    _torque("asymmetry", "1",
            "Skewness of the slope away from zero torque; negative where slow rises end in drops.",
            THESIS_STICK_SLIP, lambda p: p.slips.asymmetry, tolerance=(0.05, 0.01)),
    _torque("slip_rate", "1/s", "Sudden drops in a second.",
            THESIS_STICK_SLIP, lambda p: p.slips.rate, silent=0.0),
    _torque("slip_interval", "s", "Mean time from one drop to the next.",
            THESIS_STICK_SLIP, lambda p: p.slips.mean_interval),
    _torque("slip_irregularity", "1", "Coefficient of variation of these times.",
            THIS, lambda p: p.slips.interval_variation),
    _torque("slip_glide", "octave/s", "Trend of the slip rate: median slope of its logarithm.",
            "Theil 1950", lambda p: p.slips.glide, tolerance=(0.02, 0.02)),
    _torque("drop", "N m", "Mean fall of the torque in a slip.",
            THESIS_STICK_SLIP, lambda p: p.slips.mean_drop, calibrated=True),
    _torque("drop_variation", "1", "Coefficient of variation of the falls.",
            THIS, lambda p: p.slips.drop_variation),
    _torque("stick_slope", "N m/s",
            "Median slope of the rising torque; k_EFF times the shaft's speed in true stick.",
            "thesis, (5.1)", lambda p: p.slips.stick_slope, calibrated=True),
    _torque("slope_ratio", "1",
            "That slope over k_EFF times the shaft's speed, where known; 1 in true stick.",
            "thesis, (5.1)", lambda p: p.slips.stick_slope / p.stick_rate, calibrated=True),
    _torque("stick_curvature", "1",
            "Slope in the later half of a rise over that in the earlier, median.",
            THESIS_STICK_SLIP, lambda p: p.slips.stick_curvature),
    _torque("stick_fraction", "1",
            "Share of the time between drops in which the torque is on its way up.",
            THESIS_STICK_SLIP, lambda p: p.slips.stick_fraction),
)  # fmt: skip
"""In the order of the feature vector."""
