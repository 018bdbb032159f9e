"""The features of the torque: how much, how it oscillates, and whether it sticks and slips.

Levels are in newton metres and need a calibrated channel. Everything else describes the oscillation
about the mean from 5 Hz to 7 kHz, so that neither the gain nor a drifting offset matters.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.bands import band_power
from features.kernels.conditioning import usable_limit
from features.named.feature import Feature
from features.named.prepared import relative_db

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["TORQUE_FEATURES"]

_TORQUE = ("torque",)
_STICK_SLIP = "thesis, 5.1.1"
_SPECTRA = "thesis, 5.2.1"
_PEETERS = "Peeters 2004"
_PITCH = "McLeod & Wyvill 2005"
_THIS = "bushing-noise"

_HIGH_FROM = 2_000.0
"""A torque has little above [Hz] (thesis, 5.2.3)."""


def _high_band(p: Prepared) -> float:
    if usable_limit(p.rate) <= _HIGH_FROM:
        return math.nan
    part, whole = band_power(p.spectrum, [_HIGH_FROM, p.low], [p.limit, p.limit])
    return relative_db(float(part), float(whole))


def _kurtosis(p: Prepared) -> float:
    x, _ = p.in_band
    return float(np.mean(np.square(np.square(x / x.std()))))


TORQUE_FEATURES = (
    Feature(
        "mean",
        "N m",
        "Mean torque, signed.",
        "thesis, Fig. 5.3",
        lambda p: p.mean,
        silent=None,
        calibrated=True,
        kinds=_TORQUE,
    ),
    Feature(
        "oscillation",
        "N m",
        "Rms value about the mean.",
        _STICK_SLIP,
        lambda p: p.rms,
        silent=None,
        calibrated=True,
        kinds=_TORQUE,
    ),
    Feature(
        "relative_oscillation",
        "1",
        "Rms value about the mean over the mean's magnitude.",
        _STICK_SLIP,
        lambda p: p.rms / abs(p.mean) if p.mean != 0.0 else math.nan,
        silent=None,
        kinds=_TORQUE,
    ),
    Feature(
        "fundamental",
        "Hz",
        "Repetition rate of the oscillation.",
        _PITCH,
        lambda p: p.harmonics.fundamental,
        kinds=_TORQUE,
        tolerance=(0.002, 0.0),
    ),
    Feature(
        "periodicity",
        "1",
        "Autocorrelation at the fundamental's period.",
        _PITCH,
        lambda p: p.harmonics.strength,
        silent=0.0,
        kinds=_TORQUE,
        tolerance=(0.0, 0.02),
    ),
    Feature(
        "harmonicity",
        "1",
        "Share of the oscillation's power within harmonics, above the noise floor.",
        _SPECTRA,
        lambda p: p.harmonics.harmonicity,
        silent=0.0,
        kinds=_TORQUE,
    ),
    Feature(
        "harmonic_count",
        "1",
        "Harmonics within 30 dB of the strongest, 10 dB above the floor.",
        _SPECTRA,
        lambda p: p.harmonics.count,
        silent=0.0,
        kinds=_TORQUE,
    ),
    Feature(
        "harmonic_to_noise",
        "dB",
        "Power within harmonics, above the noise floor, re all other power, within 30 dB.",
        _THIS,
        lambda p: p.harmonics.harmonic_to_noise,
        kinds=_TORQUE,
        tolerance=(0.0, 0.2),
    ),
    Feature(
        "inharmonicity",
        "1",
        "Mean distance of lines from the nearest harmonic, by power; 0 on them, 1 midway.",
        _PEETERS,
        lambda p: p.harmonics.inharmonicity,
        kinds=_TORQUE,
    ),
    Feature(
        "line_count",
        "1",
        "Discrete lines within 30 dB of the strongest, 10 dB above the floor.",
        _SPECTRA,
        lambda p: p.lines.frequency.size,
        silent=0.0,
        kinds=_TORQUE,
    ),
    Feature(
        "line_frequency",
        "Hz",
        "Frequency of the strongest line.",
        _SPECTRA,
        lambda p: float(p.lines.frequency[0]) if p.lines.frequency.size else math.nan,
        kinds=_TORQUE,
        tolerance=(0.002, 0.0),
    ),
    Feature(
        "line_share",
        "1",
        "Share of the oscillation's power in the strongest line.",
        _SPECTRA,
        lambda p: p.lines.strongest_share,
        silent=0.0,
        kinds=_TORQUE,
    ),
    Feature(
        "high_band",
        "dB",
        "Level above 2 kHz re that of the whole oscillation.",
        "thesis, 5.2.3",
        _high_band,
        kinds=_TORQUE,
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "kurtosis",
        "1",
        "Fourth moment of the oscillation over the squared second; 1.5 for a sine.",
        _THIS,
        _kurtosis,
        kinds=_TORQUE,
        tolerance=(0.05, 0.0),
    ),
    Feature(
        "asymmetry",
        "1",
        "Skewness of the slope away from zero torque; negative where it rises slowly and drops.",
        _STICK_SLIP,
        lambda p: p.torque_slips.asymmetry,
        kinds=_TORQUE,
        tolerance=(0.05, 0.01),
    ),
    Feature(
        "slip_rate",
        "1/s",
        "Sudden drops in a second.",
        _STICK_SLIP,
        lambda p: p.torque_slips.rate,
        silent=0.0,
        kinds=_TORQUE,
    ),
    Feature(
        "slip_interval",
        "s",
        "Mean time from one drop to the next.",
        _STICK_SLIP,
        lambda p: p.torque_slips.mean_interval,
        kinds=_TORQUE,
    ),
    Feature(
        "slip_irregularity",
        "1",
        "Coefficient of variation of these times.",
        _THIS,
        lambda p: p.torque_slips.interval_variation,
        kinds=_TORQUE,
    ),
    Feature(
        "slip_glide",
        "octave/s",
        "Trend of the slip rate: median slope of its logarithm.",
        "Theil 1950",
        lambda p: p.torque_slips.glide,
        kinds=_TORQUE,
        tolerance=(0.02, 0.02),
    ),
    Feature(
        "drop",
        "N m",
        "Mean fall of the torque in a slip.",
        _STICK_SLIP,
        lambda p: p.torque_slips.mean_drop,
        calibrated=True,
        kinds=_TORQUE,
    ),
    Feature(
        "drop_variation",
        "1",
        "Coefficient of variation of the falls.",
        _THIS,
        lambda p: p.torque_slips.drop_variation,
        kinds=_TORQUE,
    ),
    Feature(
        "stick_slope",
        "N m/s",
        "Median slope of the rising torque; k_EFF times the shaft's speed in true stick.",
        "thesis, (5.1)",
        lambda p: p.torque_slips.stick_slope,
        calibrated=True,
        kinds=_TORQUE,
    ),
    Feature(
        "slope_ratio",
        "1",
        "That slope over k_EFF times the shaft's speed, where known; 1 in true stick.",
        "thesis, (5.1)",
        lambda p: p.torque_slips.stick_slope / p.stick_rate,
        calibrated=True,
        kinds=_TORQUE,
    ),
    Feature(
        "stick_curvature",
        "1",
        "Slope in the later half of a rise over that in the earlier, median.",
        _STICK_SLIP,
        lambda p: p.torque_slips.stick_curvature,
        kinds=_TORQUE,
    ),
    Feature(
        "stick_fraction",
        "1",
        "Share of the time between drops in which the torque is on its way up.",
        _STICK_SLIP,
        lambda p: p.torque_slips.stick_fraction,
        kinds=_TORQUE,
    ),
)
"""Entries in the order of the feature vector."""
