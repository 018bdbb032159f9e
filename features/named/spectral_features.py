"""Features of a sound's or an acceleration's spectrum: its level, its shape and what lines it has.

Creak is broadband, squawk has several discrete frequencies, squeal one that predominates (thesis,
5.2.3). The entries follow these words: how the power is spread, how much of it is in lines and in
how many, whether they are harmonics of one vibration. All but the levels refer to the part from
150 Hz to 7 kHz.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from features.kernels.bands import REFERENCES, overall_level
from features.named.feature import Feature
from features.named.prepared import relative_db

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["SPECTRAL_FEATURES"]

_NOISES = "thesis, 5.2.3"
_IEC_A = "IEC 61672-1:2013"
_PEETERS = "Peeters 2004"
_PITCH = "McLeod & Wyvill 2005"
_THIS = "bushing-noise"

_NO_SECOND_LINE_DB = -40.0
"""Level of a second line that is not there: below all that count [dB]."""


def _level(p: Prepared) -> float:
    return 20.0 * math.log10(p.rms / REFERENCES[p.kind]) if p.rms > 0.0 else math.nan


def _level_a(p: Prepared) -> float:
    if p.rms == 0.0:
        return math.nan
    return overall_level(p.level_spectrum, reference=REFERENCES[p.kind], weighting="A")


def _hum(p: Prepared) -> float:
    return 1.0 - min(1.0, p.in_band_share) if p.rms > 0.0 and p.low < p.limit else math.nan


def _strongest_line(p: Prepared) -> float:
    return float(p.lines.frequency[0]) if p.lines.frequency.size else math.nan


def _second_line(p: Prepared) -> float:
    power = p.lines.power
    if power.size == 0:
        return math.nan
    if power.size == 1:
        return _NO_SECOND_LINE_DB
    return max(_NO_SECOND_LINE_DB, relative_db(float(power[1]), float(power[0])))


def _line_order(p: Prepared) -> float:
    return _strongest_line(p) / p.harmonics.fundamental


SPECTRAL_FEATURES = (
    Feature(
        "level",
        "dB",
        "Level of the whole signal about its mean, re 20 uPa or 1 um/s2.",
        "ISO 1683",
        _level,
        silent=None,
        calibrated=True,
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "level_a",
        "dB",
        "A-weighted level of the whole signal, re 20 uPa.",
        _IEC_A,
        _level_a,
        silent=None,
        calibrated=True,
        kinds=("pressure",),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "hum_share",
        "1",
        "Share of the power below 7 kHz that lies below 150 Hz.",
        _THIS,
        _hum,
        silent=None,
        tolerance=(0.0, 0.02),
    ),
    Feature(
        "centroid",
        "Hz",
        "Mean frequency, weighted by power.",
        _PEETERS,
        lambda p: p.shape.centroid,
    ),
    Feature(
        "spread",
        "Hz",
        "Standard deviation of the frequency, weighted by power.",
        _PEETERS,
        lambda p: p.shape.spread,
    ),
    Feature(
        "flatness",
        "1",
        "Geometric over arithmetic mean of the spectral density.",
        _PEETERS,
        lambda p: p.shape.flatness,
    ),
    Feature(
        "roll_off",
        "Hz",
        "Frequency below which 85 % of the power lies.",
        _PEETERS,
        lambda p: p.shape.roll_off,
    ),
    Feature(
        "line_count",
        "1",
        "Discrete lines within 30 dB of the strongest, 10 dB above the floor.",
        _NOISES,
        lambda p: p.lines.frequency.size,
        silent=0.0,
    ),
    Feature(
        "line_frequency",
        "Hz",
        "Frequency of the strongest line.",
        _NOISES,
        _strongest_line,
        tolerance=(0.002, 0.0),
    ),
    Feature(
        "line_share",
        "1",
        "Share of the power in the strongest line.",
        _NOISES,
        lambda p: p.lines.strongest_share,
        silent=0.0,
    ),
    Feature(
        "lines_share",
        "1",
        "Share of the power in all lines.",
        _NOISES,
        lambda p: p.lines.share,
        silent=0.0,
    ),
    Feature(
        "second_line",
        "dB",
        "Level of the second line re the strongest, -40 if there is one only.",
        _NOISES,
        _second_line,
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "fundamental",
        "Hz",
        "Repetition rate of the vibration, from 5 Hz on.",
        _PITCH,
        lambda p: p.harmonics.fundamental,
        tolerance=(0.002, 0.0),
    ),
    Feature(
        "periodicity",
        "1",
        "Autocorrelation at the fundamental's period.",
        _PITCH,
        lambda p: p.harmonics.strength,
        silent=0.0,
        tolerance=(0.0, 0.02),
    ),
    Feature(
        "harmonicity",
        "1",
        "Share of the power within harmonics, above the noise floor.",
        _THIS,
        lambda p: p.harmonics.harmonicity,
        silent=0.0,
    ),
    Feature(
        "harmonic_count",
        "1",
        "Harmonics within 30 dB of the strongest, 10 dB above the floor.",
        _THIS,
        lambda p: p.harmonics.count,
        silent=0.0,
    ),
    Feature(
        "harmonic_to_noise",
        "dB",
        "Power within harmonics, above the noise floor, re all other power, within 30 dB.",
        _THIS,
        lambda p: p.harmonics.harmonic_to_noise,
        tolerance=(0.0, 0.2),
    ),
    Feature(
        "inharmonicity",
        "1",
        "Mean distance of lines from the nearest harmonic, by power; 0 on them, 1 midway.",
        _PEETERS,
        lambda p: p.harmonics.inharmonicity,
    ),
    Feature(
        "line_order",
        "1",
        "Frequency of the strongest line over the fundamental.",
        "thesis, 5.2.1",
        _line_order,
    ),
)
"""Entries in the order of the feature vector."""
