"""Features of a spectrum: its level, its shape, its lines and whether they are harmonics of one.

Creak is broadband, squawk has several discrete frequencies, squeal one that predominates (thesis,
5.2.3). The entries follow these words: how the power is spread, how much of it is in lines and in
how many, whether they are harmonics of one vibration. Lines and harmonics describe a torque as
well, from 5 Hz; of sound and acceleration all but the levels refer to the part from 150 Hz to
7 kHz.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from features.kernels.bands import REFERENCES, relative_db
from features.named.feature import PEETERS, PITCH, THESIS_NOISES, THESIS_SPECTRA, THIS, Feature
from features.named.prepared import ACOUSTIC_KINDS

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["HARMONIC_FEATURES", "LINE_FEATURES", "SPECTRAL_FEATURES"]

_ALL_KINDS = (*ACOUSTIC_KINDS, "torque")
_TENTH_DB = (0.0, 0.1)

_NO_SECOND_LINE_DB = -40.0
"""Level of a second line that is not there: below all that count [dB]."""


def _level(p: Prepared) -> float:
    return 20.0 * math.log10(p.rms / REFERENCES[p.kind]) if p.rms > 0.0 else math.nan


def _level_a(p: Prepared) -> float:
    if p.rms == 0.0:
        return math.nan
    return p.level_a


def _hum(p: Prepared) -> float:
    return 1.0 - min(1.0, p.in_band_share) if p.rms > 0.0 and p.low < p.limit else math.nan


def _second_line(p: Prepared) -> float:
    power = p.lines.power
    if power.size == 0:
        return math.nan
    if power.size == 1:
        return _NO_SECOND_LINE_DB
    return max(_NO_SECOND_LINE_DB, relative_db(float(power[1]), float(power[0])))


LINE_FEATURES = (
    Feature("line_count", "1",
            "Discrete lines within 30 dB of the strongest, 10 dB above the floor.",
            THESIS_NOISES, lambda p: p.lines.frequency.size, silent=0.0, kinds=_ALL_KINDS),
    Feature("line_frequency", "Hz", "Frequency of the strongest line.",
            THESIS_NOISES, lambda p: p.lines.strongest, kinds=_ALL_KINDS, tolerance=(0.002, 0.0)),
    Feature("line_share", "1", "Share of the power in the strongest line.",
            THESIS_NOISES, lambda p: p.lines.strongest_share, silent=0.0, kinds=_ALL_KINDS),
)  # fmt: skip
"""Of all kinds of channel."""

HARMONIC_FEATURES = (
    Feature("fundamental", "Hz", "Repetition rate of the vibration, from 5 Hz on.",
            PITCH, lambda p: p.harmonics.fundamental, kinds=_ALL_KINDS, tolerance=(0.002, 0.0)),
    Feature("periodicity", "1", "Autocorrelation at the fundamental's period.",
            PITCH, lambda p: p.harmonics.strength, silent=0.0, kinds=_ALL_KINDS,
            tolerance=(0.0, 0.02)),
    Feature("harmonicity", "1", "Share of the power within harmonics, above the noise floor.",
            THESIS_SPECTRA, lambda p: p.harmonics.harmonicity, silent=0.0, kinds=_ALL_KINDS),
    Feature("harmonic_count", "1",
            "Harmonics within 30 dB of the strongest, 10 dB above the floor.",
            THESIS_SPECTRA, lambda p: p.harmonics.count, silent=0.0, kinds=_ALL_KINDS),
    Feature("harmonic_to_noise", "dB",
            "Power within harmonics, above the noise floor, re all other power, within 30 dB.",
            THIS, lambda p: p.harmonics.harmonic_to_noise, kinds=_ALL_KINDS, tolerance=(0.0, 0.2)),
    Feature("inharmonicity", "1",
            "Mean distance of lines from the nearest harmonic, by power; 0 on them, 1 midway.",
            PEETERS, lambda p: p.harmonics.inharmonicity, kinds=_ALL_KINDS),
)  # fmt: skip
"""Of all kinds of channel."""

SPECTRAL_FEATURES = (
    Feature("level", "dB", "Level of the whole signal about its mean, re 20 uPa or 1 um/s2.",
            "ISO 1683", _level, silent=None, calibrated=True, tolerance=_TENTH_DB),
    Feature("level_a", "dB", "A-weighted level of the whole signal, re 20 uPa.",
            "IEC 61672-1:2013", _level_a, silent=None, calibrated=True, kinds=("pressure",),
            tolerance=_TENTH_DB),
    Feature("hum_share", "1", "Share of the power below 7 kHz that lies below 150 Hz.",
            THIS, _hum, silent=None, tolerance=(0.0, 0.02)),
    Feature("centroid", "Hz", "Mean frequency, weighted by power.",
            PEETERS, lambda p: p.shape.centroid),
    Feature("spread", "Hz", "Standard deviation of the frequency, weighted by power.",
            PEETERS, lambda p: p.shape.spread),
    Feature("flatness", "1", "Geometric over arithmetic mean of the spectral density.",
            PEETERS, lambda p: p.shape.flatness),
    Feature("roll_off", "Hz", "Frequency below which 85 % of the power lies.",
            PEETERS, lambda p: p.shape.roll_off),
    *LINE_FEATURES,
    Feature("lines_share", "1", "Share of the power in all lines.",
            THESIS_NOISES, lambda p: p.lines.share, silent=0.0),
    Feature("second_line", "dB", "Level of the second line re the strongest; -40 without one.",
            THESIS_NOISES, _second_line, tolerance=_TENTH_DB),
    *HARMONIC_FEATURES,
    Feature("line_order", "1", "Frequency of the strongest line over the fundamental.",
            THESIS_SPECTRA, lambda p: p.lines.strongest / p.harmonics.fundamental),
)  # fmt: skip
"""Of sound and acceleration, in the order of the feature vector."""
