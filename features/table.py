"""Features of a signal or a recording: one table of all, and their values.

The table is the only list there is, its second half for half-second windows
(`features.window_table`): a further feature is an entry with name, unit, computation and kinds of
channel. Creak is broadband, squawk has
several discrete frequencies, squeal one that predominates, and a creak is impulsive at each slip
(thesis, 5.2.3); the entries follow these words. Of sound and acceleration all but levels refer to
the part from 150 Hz to 7 kHz, of a torque to its oscillation about the mean from 5 Hz to 7 kHz, so
that neither the gain nor a drifting offset matters. A band is missing where the rate does not
reach it, or where the signal is too short for four bins in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from features.kernels.conditioning import usable_limit
from features.kernels.levels import (
    LEAST_SHARE_DB,
    NOMINAL_THIRD_OCTAVES,
    REFERENCES,
    a_weighted_level,
    band_power,
    relative_db,
)
from features.kernels.spectra import weighted_median as _median
from features.prepared import ACOUSTIC_KINDS, Prepared
from models.errors import ParameterError
from models.show import short_repr

KINDS = (*ACOUSTIC_KINDS, "torque")
"""Kinds of channel that have features."""

THESIS_STICK_SLIP = "thesis, 5.1.1"
THESIS_SPECTRA = "thesis, 5.2.1"
THESIS_NOISES = "thesis, 5.2.3"
PEETERS = "Peeters 2004"
PITCH = "McLeod & Wyvill 2005"
THIS = "bushing-noise"


def _by_power(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Mean weighted by power."""
    return float(np.average(values, weights=power))


def _over_time(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    return float(values.mean())


def pooled_levels(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    """Level of the mean power [dB], of levels of shape (n,); an empty piece counts as silent."""
    return 10.0 * math.log10(float(np.mean(np.nan_to_num(10.0 ** (0.1 * values)))))


def _part(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Level of a part of the power relative to all of it, of such levels."""
    return 10.0 * math.log10(_by_power(10.0 ** (0.1 * values), power))


def _peak(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Peak relative to the rms value [dB], of such levels."""
    return float(np.max(values + 10.0 * np.log10(power / power.mean())))


def _hum_share(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    rest = np.maximum(1.0 - values, np.finfo(np.float64).tiny)
    return 1.0 - float(power.sum() / (power / rest).sum())


def _kurtosis(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    return float(np.mean(values * power**2) / power.mean() ** 2)


@short_repr
@dataclass(frozen=True)
class Feature:
    """One number that describes a signal.

    Parameters
    ----------
    name : str
    unit : str
        "1" for pure numbers.
    definition : str
        In one line.
    source : str
        Where the definition comes from.
    compute : callable
        Of a `Prepared` signal; in `features.window_table` of the parts of windows.
    silent : float, optional
        Value for a signal without content [unit]; None where `compute` knows itself.
    calibrated : bool
        Whether it needs a calibrated signal; all others do not depend on the gain.
    kinds : tuple of str
        Kinds of channel it applies to.
    tolerance : tuple of 2 floats
        How closely values agree that come from the same sound at different sampling rates, 16 to
        192 kHz: within this share, or within this much [unit], whichever is more. It holds for
        what the rates have in common, so for `level` and `level_a` where nothing lies above 7 kHz.
    pooled : callable, optional
        Puts the values of a long recording's pieces together, given their power within the band
        described; by default their mean by power. None where mean and rms value make the feature.

    Examples
    --------
    >>> from features.prepared import prepare
    >>> length = Feature("length", "s", "Duration.", "-", lambda p: p.samples.size / p.rate, None)
    >>> length(prepare([0.0] * 480, 48e3, "pressure"))
    0.01
    """

    name: str
    unit: str
    definition: str
    source: str
    compute: Callable[[Any], Any]
    silent: float | None = math.nan
    calibrated: bool = False
    kinds: tuple[str, ...] = ACOUSTIC_KINDS
    tolerance: tuple[float, float] = (0.02, 0.01)
    pooled: Callable[[NDArray[np.float64], NDArray[np.float64]], float] | None = _by_power

    def __call__(self, signal: Prepared) -> float:
        """Value for a signal; NaN where it is undefined."""
        if self.calibrated and not signal.calibrated:
            return math.nan
        if self.silent is not None and signal.silent:
            return self.silent
        return float(self.compute(signal))

    def hertz(self, octaves: float) -> float:
        """Frequency of a value that counts in octaves.

        Parameters
        ----------
        octaves : float
            In the unit of the feature, such as ``"octave re 100 Hz"`` [octave].

        Returns
        -------
        float
            [Hz]

        Examples
        --------
        >>> Feature("pitch", "octave re 1 kHz", "Pitch.", "-", lambda p: 0.0).hertz(1.0)
        2000.0
        """
        number, unit = self.unit.removeprefix("octave re ").split()
        return float(number) * (1e3 if unit == "kHz" else 1.0) * float(2.0**octaves)


_RE_ALL = "re that from 150 Hz to 7 kHz"
_TENTH_DB = (0.0, 0.1)


def _third_octave(name: str, p: Prepared) -> float:
    if p.rms == 0.0:
        return math.nan
    level = p.third_octaves[name]
    if math.isnan(level):
        return math.nan
    least = 20.0 * math.log10(p.rms) + LEAST_SHARE_DB
    return max(level, least) - 20.0 * math.log10(REFERENCES[p.kind])


BAND_FEATURES = (
    *(
        Feature(f"band_{low}_{high}", "dB", f"Level from {low} to {high} Hz {_RE_ALL}.",
                source, partial(Prepared.share_db, low=float(low), high=float(high)),
                tolerance=_TENTH_DB, pooled=_part)
        for low, high, source in ((150, 500, THIS), (500, 1000, THIS), (1000, 2000, THIS),
                                  (2000, 5000, THESIS_NOISES), (5000, 7000, THESIS_NOISES))
    ),
    Feature("band_7000_13000", "dB", f"Level from 7 to 13 kHz {_RE_ALL}; needs a rate of 29.8 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[0].level, tolerance=_TENTH_DB, pooled=_part),
    Feature("band_13000_19000", "dB",
            f"Level from 13 to 19 kHz {_RE_ALL}; needs a rate of 43.5 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[1].level, tolerance=_TENTH_DB, pooled=_part),
    Feature("band_0_2000", "dB", f"Level below 2 kHz, hum included, {_RE_ALL}.",
            THESIS_NOISES, lambda p: p.thesis_band(0), tolerance=_TENTH_DB, pooled=_part),
    Feature("band_5000_15000", "dB", f"Level from 5 to 15 kHz {_RE_ALL}; needs a rate of 34.3 kHz.",
            THESIS_NOISES, lambda p: p.thesis_band(2), tolerance=(0.0, 0.2), pooled=_part),
    *(
        Feature(f"third_octave_{name}", "dB",
                f"Level in the one-third octave at {name} Hz, re 20 uPa or 1 um/s2.",
                "IEC 61260-1:2014", partial(_third_octave, name), silent=None, calibrated=True,
                tolerance=_TENTH_DB, pooled=pooled_levels)
        for name in NOMINAL_THIRD_OCTAVES
    ),
)  # fmt: skip


_NO_SECOND_LINE_DB = -40.0
"""Level of a second line that is not there: below all that count [dB]."""


def _level(p: Prepared) -> float:
    return 20.0 * math.log10(p.rms / REFERENCES[p.kind]) if p.rms > 0.0 else math.nan


def _level_a(p: Prepared) -> float:
    reference = REFERENCES[p.kind]
    return a_weighted_level(p.samples, p.rate, reference=reference) if p.rms > 0.0 else math.nan


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
            THESIS_NOISES, lambda p: p.lines.frequency.size, silent=0.0, kinds=KINDS,
            pooled=_median),
    Feature("line_frequency", "Hz", "Frequency of the strongest line.",
            THESIS_NOISES, lambda p: p.lines.strongest, kinds=KINDS, tolerance=(0.002, 0.0),
            pooled=_median),
    Feature("line_share", "1", "Share of the power in the strongest line.",
            THESIS_NOISES, lambda p: p.lines.strongest_share, silent=0.0, kinds=KINDS),
)  # fmt: skip

HARMONIC_FEATURES = (
    Feature("fundamental", "Hz", "Repetition rate of the vibration, from 5 Hz on.",
            PITCH, lambda p: p.harmonics.fundamental, kinds=KINDS, tolerance=(0.002, 0.0),
            pooled=_median),
    Feature("periodicity", "1", "Autocorrelation at the fundamental's period.",
            PITCH, lambda p: p.harmonics.strength, silent=0.0, kinds=KINDS,
            tolerance=(0.0, 0.02)),
    Feature("harmonicity", "1", "Share of the power within harmonics, above the noise floor.",
            THESIS_SPECTRA, lambda p: p.harmonics.harmonicity, silent=0.0, kinds=KINDS),
    Feature("harmonic_count", "1",
            "Harmonics within 30 dB of the strongest, 10 dB above the floor.",
            THESIS_SPECTRA, lambda p: p.harmonics.count, silent=0.0, kinds=KINDS, pooled=_median),
    Feature("harmonic_to_noise", "dB",
            "Power within harmonics, above the noise floor, re all other power, within 30 dB.",
            THIS, lambda p: p.harmonics.harmonic_to_noise, kinds=KINDS, tolerance=(0.0, 0.2),
            pooled=_median),
    Feature("inharmonicity", "1",
            "Mean distance of lines from the nearest harmonic, by power; 0 on them, 1 midway.",
            PEETERS, lambda p: p.harmonics.inharmonicity, kinds=KINDS),
)  # fmt: skip

SPECTRAL_FEATURES = (
    Feature("level", "dB", "Level of the whole signal about its mean, re 20 uPa or 1 um/s2.",
            "ISO 1683", _level, silent=None, calibrated=True, tolerance=_TENTH_DB, pooled=None),
    Feature("level_a", "dB", "A-weighted level of the whole signal, re 20 uPa.",
            "IEC 61672-1:2013", _level_a, silent=None, calibrated=True, kinds=("pressure",),
            tolerance=_TENTH_DB, pooled=pooled_levels),
    Feature("hum_share", "1", "Share of the power below 7 kHz that lies below 150 Hz.",
            THIS, _hum, silent=None, tolerance=(0.0, 0.02), pooled=_hum_share),
    Feature("centroid", "Hz", "Mean frequency, weighted by power.",
            PEETERS, lambda p: p.shape.centroid),
    Feature("spread", "Hz", "Standard deviation of the frequency, weighted by power.",
            PEETERS, lambda p: p.shape.spread),
    Feature("flatness", "1", "Geometric over arithmetic mean of the spectral density.",
            PEETERS, lambda p: p.shape.flatness),
    Feature("roll_off", "Hz", "Frequency below which 85 % of the power lies.",
            PEETERS, lambda p: p.shape.roll_off, pooled=_median),
    *LINE_FEATURES,
    Feature("lines_share", "1", "Share of the power in all lines.",
            THESIS_NOISES, lambda p: p.lines.share, silent=0.0),
    Feature("second_line", "dB", "Level of the second line re the strongest; -40 without one.",
            THESIS_NOISES, _second_line, tolerance=_TENTH_DB, pooled=_median),
    *HARMONIC_FEATURES,
    Feature("line_order", "1", "Frequency of the strongest line over the fundamental.",
            THESIS_SPECTRA, lambda p: p.lines.strongest / p.harmonics.fundamental, pooled=_median),
)  # fmt: skip


TEMPORAL_FEATURES = (
    Feature("tone_share", "1",
            "Share of the power in the strongest line of each 64 ms, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time["tone_share"], silent=0.0),
    Feature("tone_continuity", "1",
            "The same, counting lines still there (within a semitone) in the next 64 ms.",
            THIS, lambda p: p.short_time["continuity"]),
    Feature("tone_count", "1",
            "Lines in each 64 ms, within 20 dB of the strongest, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time["tone_count"], silent=0.0),
    Feature("second_tone", "dB",
            "Level of the second line of each 64 ms re the strongest, -20 or more, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time["second_tone"], tolerance=(0.0, 0.1)),
    Feature("short_periodicity", "1",
            "Autocorrelation of each 64 ms at its fundamental's period, mean by energy.",
            "Boersma 1993", lambda p: p.short_time["periodicity"], silent=0.0),
    Feature("fundamental_wander", "octave",
            "Robust standard deviation of the fundamental over time.",
            THIS, lambda p: p.short_time["fundamental_wander"]),
    Feature("flux", "1",
            "Share of the power that moves to other one-third octaves from one 64 ms to the next.",
            PEETERS, lambda p: p.short_time["flux"]),
    Feature("level_variation", "dB", "Standard deviation of the levels of 64 ms.",
            THIS, lambda p: p.short_time["level_variation"], tolerance=(0.0, 0.1),
            pooled=_over_time),
    Feature("crest", "dB", "Peak of the envelope re the rms value; 3 for a tone.",
            THIS, lambda p: 20.0 * math.log10(p.pulses.crest_factor), tolerance=(0.0, 0.5),
            pooled=_peak),
    Feature("kurtosis", "1", "Fourth moment over the squared second; 1.5 for a tone, 3 for noise.",
            THIS, lambda p: p.pulses.kurtosis, tolerance=(0.05, 0.0), pooled=_kurtosis),
    Feature("high_kurtosis", "1", "The same of the part from 2 to 7 kHz.",
            THESIS_NOISES, lambda p: p.pulses.high_kurtosis, tolerance=(0.05, 0.0)),
    Feature("top_kurtosis", "1", "The same of the part from 7 to 13 kHz; needs a rate of 29.8 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[0].kurtosis, tolerance=(0.05, 0.0)),
    Feature("burst_share", "1",
            "Share of the energy from 2 to 7 kHz in the loudest tenth of the time.",
            THESIS_NOISES, lambda p: p.pulses.concentration),
    Feature("pulse_rate", "1/s", "Pulses from 2 to 7 kHz in a second.",
            THESIS_NOISES, lambda p: p.pulses.rate, silent=0.0, pooled=_over_time),
    Feature("pulse_irregularity", "1",
            "Median log ratio of neighbouring intervals; 0 for a clock, 1.1 for a Poisson process.",
            THIS, lambda p: p.pulses.irregularity, tolerance=(0.0, 0.02)),
    Feature("pulse_glide", "1/s", "Trend of the logarithm of the pulse rate.",
            THIS, lambda p: p.pulses.glide, tolerance=(0.0, 0.02)),
    Feature("modulation_rate", "Hz", "Repetition rate of the envelope, 2 to 400 Hz.",
            PITCH, lambda p: p.modulation.rate, tolerance=(0.002, 0.0), pooled=_median),
    Feature("modulation_strength", "1", "Autocorrelation of the envelope at that rate.",
            PITCH, lambda p: p.modulation.strength, silent=0.0, tolerance=(0.0, 0.02)),
    Feature("modulation_depth", "1",
            "Standard deviation of the envelope from 2 to 400 Hz over its mean.",
            THIS, lambda p: p.modulation.depth, silent=0.0),
)  # fmt: skip


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
            "thesis, Fig. 5.3", lambda p: p.mean, silent=None, calibrated=True, pooled=None),
    _torque("oscillation", "N m", "Rms value about the mean.",
            THESIS_STICK_SLIP, lambda p: p.rms, silent=None, calibrated=True, pooled=None),
    _torque("relative_oscillation", "1", "Rms value about the mean over the mean's magnitude.",
            THESIS_STICK_SLIP, lambda p: p.rms / abs(p.mean) if p.mean != 0.0 else math.nan,
            silent=None, pooled=None),
    *HARMONIC_FEATURES,
    *LINE_FEATURES,
    _torque("high_band", "dB", "Level above 2 kHz re that of the whole oscillation.",
            "thesis, 5.2.3", _high_band, tolerance=(0.0, 0.1), pooled=_part),
    _torque("kurtosis", "1",
            "Fourth moment of the oscillation over the squared second; 1.5 for a sine.",
            THIS, lambda p: p.kurtosis, tolerance=(0.05, 0.0), pooled=_kurtosis),
    _torque("asymmetry", "1",
            "Skewness of the slope away from zero torque; negative where slow rises end in drops.",
            THESIS_STICK_SLIP, lambda p: p.slips.asymmetry, tolerance=(0.05, 0.01)),
    _torque("slip_rate", "1/s", "Sudden drops in a second.",
            THESIS_STICK_SLIP, lambda p: p.slips.rate, silent=0.0, pooled=_over_time),
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
            "thesis, (5.1)", lambda p: p.slips.stick_slope, calibrated=True, pooled=_median),
    _torque("slope_ratio", "1",
            "That slope over k_EFF times the shaft's speed, where known; 1 in true stick.",
            "thesis, (5.1)", lambda p: p.slips.stick_slope / p.stick_rate, calibrated=True,
            pooled=_median),
    _torque("stick_curvature", "1",
            "Slope in the later half of a rise over that in the earlier, median.",
            THESIS_STICK_SLIP, lambda p: p.slips.stick_curvature),
    _torque("stick_fraction", "1",
            "Share of the time between drops in which the torque is on its way up.",
            THESIS_STICK_SLIP, lambda p: p.slips.stick_fraction),
)  # fmt: skip


_ACOUSTIC: tuple[Feature, ...] = (*SPECTRAL_FEATURES, *BAND_FEATURES, *TEMPORAL_FEATURES)

FEATURES: tuple[Feature, ...] = tuple(dict.fromkeys((*_ACOUSTIC, *TORQUE_FEATURES)))
"""All features of all kinds; those of several kinds stand once."""


def features_of(kind: str) -> tuple[Feature, ...]:
    """Entries of the features of a kind of channel, in the order of the feature vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

    Returns
    -------
    tuple of Feature

    Raises
    ------
    ParameterError
        A kind that has no features.

    Examples
    --------
    >>> features_of("torque")[0].unit
    'N m'
    """
    if kind not in KINDS:
        raise ParameterError(f"channels of kind {kind!r} have no features; use {', '.join(KINDS)}")
    table = TORQUE_FEATURES if kind == "torque" else _ACOUSTIC
    return tuple(feature for feature in table if kind in feature.kinds)


def feature_names(kind: str) -> tuple[str, ...]:
    """Names of the features of a kind of channel, in the order of the feature vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

    Returns
    -------
    tuple of str

    Raises
    ------
    ParameterError
        A kind that has no features.

    Examples
    --------
    >>> "harmonicity" in feature_names("pressure")
    True
    """
    return tuple(feature.name for feature in features_of(kind))


def recording_feature_names() -> tuple[str, ...]:
    """Names in the order of `recording_features`.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> recording_feature_names()[0]
    'pressure_level'
    """
    return tuple(f"{kind}_{name}" for kind in KINDS for name in feature_names(kind))
