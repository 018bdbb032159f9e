"""Features of a half-second window, declared by name: what the classifier is given.

The order is that in which `features.windows.table` puts them side by side: how the frames of 32 ms
follow each other, the lines of the averaged spectrum, the rhythm of all of the sound and of its
part above 2 kHz, and what lies above 7 kHz. All is A-weighted. They are computed for hours of sound
at once, in single precision and from other segments than the features of `features.table`; so
what has the same name there is the same idea but another number, and neither can stand in for the
other.
"""

from __future__ import annotations

from typing import NamedTuple

_RE_10, _RE_100, _RE_1000 = "octave re 10 Hz", "octave re 100 Hz", "octave re 1 kHz"

_REFERENCES = {_RE_10: 10.0, _RE_100: 100.0, _RE_1000: 1000.0}
"""Frequency that octaves count from [Hz]."""


class WindowFeature(NamedTuple):
    """A number that describes a window.

    Parameters
    ----------
    name : str
    unit : str
        "1" for pure numbers.
    definition : str
        In one line.

    Examples
    --------
    >>> WINDOW_FEATURES[0]
    WindowFeature(name='range', unit='dB', definition='95th less 10th percentile of the level.')
    """

    name: str
    unit: str
    definition: str

    def hertz(self, octaves: float) -> float:
        """Frequency of a value that counts in octaves.

        Parameters
        ----------
        octaves : float
            In the unit of the feature [octave].

        Returns
        -------
        float
            [Hz]

        Examples
        --------
        >>> WindowFeature("pitch", "octave re 100 Hz", "Pitch.").hertz(1.0)
        200.0
        """
        return _REFERENCES[self.unit] * float(2.0**octaves)


_F = WindowFeature

TRAJECTORY_FEATURES = (
    _F("range", "dB", "95th less 10th percentile of the level."),
    _F("peak_above_median", "dB", "95th percentile of the level less its median."),
    _F("loud_share", "1", "Share of the frames within 10 dB of the loudest."),
    _F("fluctuation", "dB", "Standard deviation of the level."),
    _F("steepest_rise", "dB", "Largest rise of the level from one frame to the next."),
    _F("steepest_fall", "dB", "Largest fall of the level from one frame to the next."),
    _F("trend", "dB/s", "Slope of the level."),
    _F("flatness", "dB", "Geometric over arithmetic mean of the spectrum, mean by power."),
    _F("flatness_lowest", "dB", "Lowest flatness of a frame."),
    _F("centroid", _RE_1000, "Mean frequency, median by power."),
    _F("centroid_wander", "octave", "Mean distance of the centroid from its median, by power."),
    _F("peak_frequency", _RE_1000, "Frequency of the strongest maximum, median by its power."),
    _F("peak_wander", "octave", "Mean distance of that frequency from its median."),
    _F("peak_drift", "octave/s", "Slope of that frequency."),
    _F("peak_jump", "octave", "Median change of that frequency from one frame to the next."),
    _F("tone_share", "1", "Share of the power in the strongest maximum, mean by power."),
    _F("tonal_frames", "1", "Share of the power in frames where that is more than half."),
    _F("tone_second", "dB", "Level of the next maximum re the strongest, mean by power."),
    _F("flux", "1", "One less the cosine between magnitudes of neighbouring frames, by power."),
    _F("voiced", "1", "Autocorrelation at the period of a voice, mean by power."),
    _F("voiced_frames", "1", "Share of the power in frames where that is more than 0.6."),
    _F("pitch", _RE_100, "Rate of that period, median by power."),
    _F("pitch_wander", "octave", "Mean distance of the pitch from its median."),
    _F("pitch_drift", "octave/s", "Slope of the pitch."),
    _F("together", "1", "How far the half octaves rise and fall together, 0 to 1."),
    _F("band_rise", "dB", "Most that a half octave's 95th percentile lies above its median."),
    _F("band_rising", "1", "Which half octave of 11 that is."),
    _F("onset", "dB", "Mean rise of the half octaves from one frame to the next, the largest."),
    _F("onset_mean", "dB", "The same, mean over the window."),
    _F("tone_steady", "1", "Longest run of frames whose maximum stays within 1/50 octave, share."),
    *(_F(f"band_{i}", "dB", f"Power of half octave {i} of 11 from 156 Hz to 7 kHz re all.")
      for i in range(1, 12)),
)  # fmt: skip
"""Of the frames of a window: strength, tone and pitch, and how they wander."""

TONE_FEATURES = (
    _F("line_count", "1", "Lines within 30 dB of the strongest."),
    _F("strong_line_count", "1", "Lines within 18 dB of the strongest."),
    _F("line_frequency", _RE_1000, "Frequency of the strongest maximum."),
    _F("line_share", "1", "Share of the power in the strongest maximum."),
    _F("lines_share", "1", "Share of the power in all lines."),
    _F("second_line", "dB", "Level of the second line re the strongest, -30 or more."),
    _F("third_line", "dB", "Level of the third line re the strongest, -30 or more."),
    _F("line_prominence", "dB", "Level of the strongest maximum re the floor about it."),
    _F("line_width", "Hz", "Width of the strongest maximum at half its power."),
    _F("fundamental", _RE_100, "Fundamental that explains most of the power in lines."),
    _F("harmonic_share", "1", "Share of the power at the fundamental's harmonics."),
    _F("harmonic_count", "1", "Lines that are harmonics of the fundamental."),
    _F("inharmonicity", "1", "Mean distance of these lines from the harmonics, over their order."),
    _F("harmonic_gain", "1", "Share at harmonics less that of evenly spread power."),
    _F("below_line", "dB", "Power below the strongest maximum re that in it."),
    _F("above_line", "dB", "Power above the strongest maximum re that in it."),
    _F("spectral_flatness", "dB", "Geometric over arithmetic mean of the spectrum."),
    _F("spectral_slope", "dB/octave", "Slope of the spectrum's level."),
    _F("lowest_line", "octave", "Frequency of the lowest line re the strongest."),
    _F("line_spacing_spread", "1", "Mean deviation of the lines' distances over their mean."),
    _F("clearest_line", "dB", "Level of the line that stands highest above the floor about it."),
    _F("clearest_frequency", _RE_1000, "Frequency of that line."),
    _F("clear_bins", "1", "Bins of 3.9 Hz that stand 10 dB above the floor about them."),
    *(_F(f"above_{i}", "dB", f"Power above {i} kHz re all.") for i in (1, 2, 4)),
)  # fmt: skip
"""Of the lines of its averaged spectrum."""

RHYTHM_FEATURES = (
    _F("blow_rate", _RE_10, "Blows in a second."),
    _F("blow_irregularity", "octave", "Median change from one interval to the next."),
    _F("blow_glide", "octave/s", "Trend of the rate."),
    _F("blow_spread", "octave", "Standard deviation of the intervals."),
    _F("blow_heights", "dB", "Standard deviation of the blows' levels."),
    _F("crest", "dB", "Peak of the power's envelope re its mean."),
    _F("kurtosis", "dB", "Mean square of the power's envelope re its squared mean."),
    _F("concentration", "1", "Share of the energy in the loudest tenth of the time."),
    _F("period_strength", "1", "Highest autocorrelation of the amplitude's envelope."),
    _F("period_rate", _RE_10, "Rate that belongs to it."),
    _F("second_period", "1", "Autocorrelation of the envelope at twice that lag."),
    _F("decay", "dB", "Median fall of the level within 4 ms after a blow."),
    *(_F(f"modulation_{i}", "1", f"Share of the modulation in band {i} of 7 from 4 to 1600 Hz.")
      for i in range(1, 8)),
    _F("modulation_depth", "1", "Standard deviation of the amplitude's envelope over its mean."),
)  # fmt: skip
"""Of the envelope of its power: blows and their rhythm."""

TOP_FEATURES = (
    _F("top_1", "dB", "Power from 7 to 13 kHz re that below 7 kHz."),
    _F("top_2", "dB", "Power from 13 to 19 kHz re that below 7 kHz."),
    _F("top_together", "1", "Correlation of the amplitudes from 7 to 13 kHz and above 2 kHz."),
    _F("high_share", "dB", "Power above 2 kHz re that below 7 kHz."),
)
"""Of what lies above 7 kHz, and above 2 kHz."""

WINDOW_FEATURES = (
    *TRAJECTORY_FEATURES,
    *TONE_FEATURES,
    *RHYTHM_FEATURES,
    *(_F(f"high_{f.name}", f.unit, f"Above 2 kHz: {f.definition}") for f in RHYTHM_FEATURES),
    *TOP_FEATURES,
)
"""Of a window of sound or acceleration, in the order of the classifier's features."""
