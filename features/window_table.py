"""Features of a half-second window, the second half of the table: what the classifier is given.

Each entry has a name, a unit, a definition and how it is computed of a part of the windows: how
the frames of 32 ms follow each other, the lines of the averaged spectrum, the rhythm of all of the
sound and of its part above 2 kHz, and what lies above 7 kHz. All are of sound and acceleration,
A-weighted. They are computed for hours of sound at once, in single precision and from other
segments than the features of `features.table`; so what has the same name there is the same idea
but another number, and neither can stand in for the other.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any

import numpy as np

from features.table import THIS, Feature
from features.windows.arithmetic import ordered_sum
from features.windows.frames import BANDS, MOST_DB

_RE_10, _RE_100, _RE_1000 = "octave re 10 Hz", "octave re 100 Hz", "octave re 1 kHz"


def _of(part: str) -> Callable[[str, str, str, Callable[[Any], Any]], Feature]:
    """Return what makes an entry that is computed of a part of windows; NaN where they lack it."""

    def entry(name: str, unit: str, definition: str, compute: Callable[[Any], Any]) -> Feature:
        def of_part(windows: dict[str, Any]) -> Any:
            return np.nan if windows[part] is None else compute(windows[part])

        return Feature(name, unit, definition, THIS, of_part)

    return entry


def _decibel(share: Any, least: float) -> Any:
    return 10.0 * np.log10(np.maximum(share.astype(np.float64), least))


def _band_level(i: int) -> Callable[[Any], Any]:
    return lambda c: c.band_levels[i]


def _octaves_above(i: int) -> Callable[[Any], Any]:
    return lambda x: _decibel(sum(x.octaves[i + 1 :]) / x.total, 1e-6)


_course = _of("course")

_COURSE = (
    _course("range", "dB", "95th less 10th percentile of the level.",
            lambda c: np.minimum(c.loud - c.quiet, MOST_DB)),
    _course("peak_above_median", "dB", "95th percentile of the level less its median.",
            lambda c: np.minimum(c.loud - c.median, MOST_DB)),
    _course("loud_share", "1", "Share of the frames within 10 dB of the loudest.",
            lambda c: (c.above > -10.0).sum(axis=0) / c.n),
    _course("fluctuation", "dB", "Standard deviation of the level.", lambda c: c.fluctuation),
    _course("steepest_rise", "dB", "Largest rise of the level from one frame to the next.",
            lambda c: np.clip(c.change.max(axis=0), 0.0, MOST_DB)),
    _course("steepest_fall", "dB", "Largest fall of the level from one frame to the next.",
            lambda c: np.clip(0.0 - c.change.min(axis=0), 0.0, MOST_DB)),
    _course("trend", "dB/s", "Slope of the level.", lambda c: c.trend),
    _course("flatness", "dB", "Geometric over arithmetic mean of the spectrum, mean by power.",
            lambda c: c.means[0]),
    _course("flatness_lowest", "dB", "Lowest flatness of a frame.",
            lambda c: np.where(c.weight > 0.01, c.flatness, 0.0).min(axis=0, initial=0.0)),
    _course("centroid", _RE_1000, "Mean frequency, median by power.", lambda c: c.centroid),
    _course("centroid_wander", "octave",
            "Mean distance of the centroid from its median, by power.",
            lambda c: c.centroid_wander),
    _course("peak_frequency", _RE_1000,
            "Frequency of the strongest maximum, median by its power.",
            lambda c: c.peak_frequency),
    _course("peak_wander", "octave", "Mean distance of that frequency from its median.",
            lambda c: c.peak_wander),
    _course("peak_drift", "octave/s", "Slope of that frequency.", lambda c: c.peak_drift),
    _course("peak_jump", "octave", "Median change of that frequency from one frame to the next.",
            lambda c: np.median(c.jump, axis=0)),
    _course("tone_share", "1", "Share of the power in the strongest maximum, mean by power.",
            lambda c: c.means[1]),
    _course("tonal_frames", "1", "Share of the power in frames where that is more than half.",
            lambda c: c.means[2]),
    _course("tone_second", "dB", "Level of the next maximum re the strongest, mean by power.",
            lambda c: np.maximum(c.means[3], -40.0)),
    _course("flux", "1",
            "One less the cosine between magnitudes of neighbouring frames, by power.",
            lambda c: c.means[4]),
    _course("voiced", "1", "Autocorrelation at the period of a voice, mean by power.",
            lambda c: c.means[5]),
    _course("voiced_frames", "1", "Share of the power in frames where that is more than 0.6.",
            lambda c: c.means[6]),
    _course("pitch", _RE_100, "Rate of that period, median by power.", lambda c: c.pitch),
    _course("pitch_wander", "octave", "Mean distance of the pitch from its median.",
            lambda c: c.pitch_wander),
    _course("pitch_drift", "octave/s", "Slope of the pitch.", lambda c: c.pitch_drift),
    _course("together", "1", "How far the half octaves rise and fall together, 0 to 1.",
            lambda c: c.together),
    _course("band_rise", "dB", "Most that a half octave's 95th percentile lies above its median.",
            lambda c: c.band_rises.max(axis=0)),
    _course("band_rising", "1", "Which half octave of 11 that is.",
            lambda c: c.band_rises.argmax(axis=0) + 1),
    _course("onset", "dB",
            "Mean rise of the half octaves from one frame to the next, the largest.",
            lambda c: c.onsets.max(axis=0)),
    _course("onset_mean", "dB", "The same, mean over the window.",
            lambda c: ordered_sum(c.onsets) / (c.n - 1)),
    _course("tone_steady", "1",
            "Longest run of frames whose maximum stays within 1/50 octave, share.",
            lambda c: c.longest_tone / c.n),
    *(
        _course(f"band_{i + 1}", "dB",
                f"Power of half octave {i + 1} of {BANDS} from 156 Hz to 7 kHz re all.",
                _band_level(i))
        for i in range(BANDS)
    ),
)  # fmt: skip

_line = _of("lines")

_LINES = (
    _line("line_count", "1", "Lines within 30 dB of the strongest.", lambda x: x.count),
    _line("strong_line_count", "1", "Lines within 18 dB of the strongest.",
          lambda x: x.strong_count),
    _line("line_frequency", _RE_1000, "Frequency of the strongest maximum.",
          lambda x: x.frequency),
    _line("line_share", "1", "Share of the power in the strongest maximum.",
          lambda x: x.line / x.total),
    _line("lines_share", "1", "Share of the power in all lines.", lambda x: x.share),
    _line("second_line", "dB", "Level of the second line re the strongest, -30 or more.",
          lambda x: x.next_levels[0]),
    _line("third_line", "dB", "Level of the third line re the strongest, -30 or more.",
          lambda x: x.next_levels[1]),
    _line("line_prominence", "dB", "Level of the strongest maximum re the floor about it.",
          lambda x: x.prominence),
    _line("line_width", "Hz", "Width of the strongest maximum at half its power.",
          lambda x: x.width),
    _line("fundamental", _RE_100, "Fundamental that explains most of the power in lines.",
          lambda x: x.fundamental),
    _line("harmonic_share", "1", "Share of the power at the fundamental's harmonics.",
          lambda x: x.harmonic_share),
    _line("harmonic_count", "1", "Lines that are harmonics of the fundamental.",
          lambda x: x.harmonic_count),
    _line("inharmonicity", "1",
          "Mean distance of these lines from the harmonics, over their order.",
          lambda x: x.inharmonicity),
    _line("harmonic_gain", "1", "Share at harmonics less that of evenly spread power.",
          lambda x: x.harmonic_gain),
    _line("below_line", "dB", "Power below the strongest maximum re that in it.",
          lambda x: _decibel(x.below / x.line, 1e-5)),
    _line("above_line", "dB", "Power above the strongest maximum re that in it.",
          lambda x: _decibel((x.total - (x.line + x.below)) / x.line.astype(np.float64), 1e-5)),
    _line("spectral_flatness", "dB", "Geometric over arithmetic mean of the spectrum.",
          lambda x: x.flatness),
    _line("spectral_slope", "dB/octave", "Slope of the spectrum's level.", lambda x: x.slope),
    _line("lowest_line", "octave", "Frequency of the lowest line re the strongest.",
          lambda x: x.lowest),
    _line("line_spacing_spread", "1", "Mean deviation of the lines' distances over their mean.",
          lambda x: x.spacing_spread),
    _line("clearest_line", "dB", "Level of the line that stands highest above the floor about it.",
          lambda x: x.clearest),
    _line("clearest_frequency", _RE_1000, "Frequency of that line.",
          lambda x: x.clearest_frequency),
    _line("clear_bins", "1", "Bins of 3.9 Hz that stand 10 dB above the floor about them.",
          lambda x: x.clear_bins),
    *(
        _line(f"above_{2**i}", "dB", f"Power above {2**i} kHz re all.",
              _octaves_above(i))
        for i in range(3)
    ),
)  # fmt: skip

_RHYTHM = (
    ("blow_rate", _RE_10, "Blows in a second."),
    ("blow_irregularity", "octave", "Median change from one interval to the next."),
    ("blow_glide", "octave/s", "Trend of the rate."),
    ("blow_spread", "octave", "Standard deviation of the intervals."),
    ("blow_heights", "dB", "Standard deviation of the blows' levels."),
    ("crest", "dB", "Peak of the power's envelope re its mean."),
    ("kurtosis", "dB", "Mean square of the power's envelope re its squared mean."),
    ("concentration", "1", "Share of the energy in the loudest tenth of the time."),
    ("period_strength", "1", "Highest autocorrelation of the amplitude's envelope."),
    ("period_rate", _RE_10, "Rate that belongs to it."),
    ("second_period", "1", "Autocorrelation of the envelope at twice that lag."),
    ("decay", "dB", "Median fall of the level within 4 ms after a blow."),
    *(
        (f"modulation_{i}", "1", f"Share of the modulation in band {i} of 7 from 4 to 1600 Hz.")
        for i in range(1, 8)
    ),
    ("modulation_depth", "1", "Standard deviation of the amplitude's envelope over its mean."),
)
"""Of the envelope of the power: each is the value of this name in `features.windows.rhythm`."""

_top = _of("top")

WINDOW_FEATURES: tuple[Feature, ...] = (
    *_COURSE,
    *_LINES,
    *(_of("rhythm")(*entry, itemgetter(entry[0])) for entry in _RHYTHM),
    *(
        _of("high")(f"high_{name}", unit, f"Above 2 kHz: {definition}", itemgetter(name))
        for name, unit, definition in _RHYTHM
    ),
    _top("top_1", "dB", "Power from 7 to 13 kHz re that below 7 kHz.", lambda t: t.shares[1]),
    _top("top_2", "dB", "Power from 13 to 19 kHz re that below 7 kHz.", lambda t: t.shares[2]),
    _top("top_together", "1", "Correlation of the amplitudes from 7 to 13 kHz and above 2 kHz.",
         lambda t: t.together),
    _top("high_share", "dB", "Power above 2 kHz re that below 7 kHz.", lambda t: t.shares[0]),
)  # fmt: skip
"""Of a window of sound or acceleration, in the order of the classifier's features."""
