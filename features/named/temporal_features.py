"""Features of how a sound or an acceleration changes: tones that stay, pulses that repeat.

A creak is impulsive at each slip (thesis, 5.2.3), a squeal a tone that stays. What tells background
sounds (speech, animals, rain, machines) from the noises of friction is mostly in here: tones that
move, pulses without a rhythm, loudness that comes and goes. All but one refer to the part from
150 Hz to 7 kHz.
"""

from __future__ import annotations

import math

from features.named.feature import PEETERS, PITCH, THESIS_NOISES, THIS, Feature

__all__ = ["TEMPORAL_FEATURES"]

TEMPORAL_FEATURES = (
    Feature("tone_share", "1",
            "Share of the power in the strongest line of each 64 ms, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time.tone_share, silent=0.0),
    Feature("tone_continuity", "1",
            "The same, counting lines still there (within a semitone) in the next 64 ms.",
            THIS, lambda p: p.short_time.continuity),
    Feature("tone_count", "1",
            "Lines in each 64 ms, within 20 dB of the strongest, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time.tone_count, silent=0.0),
    Feature("second_tone", "dB",
            "Level of the second line of each 64 ms re the strongest, -20 or more, mean by energy.",
            THESIS_NOISES, lambda p: p.short_time.second_tone, tolerance=(0.0, 0.1)),
    Feature("short_periodicity", "1",
            "Autocorrelation of each 64 ms at its fundamental's period, mean by energy.",
            "Boersma 1993", lambda p: p.short_time.periodicity, silent=0.0),
    Feature("fundamental_wander", "octave",
            "Robust standard deviation of the fundamental over time.",
            THIS, lambda p: p.short_time.fundamental_wander),
    Feature("flux", "1",
            "Share of the power that moves to other one-third octaves from one 64 ms to the next.",
            PEETERS, lambda p: p.short_time.flux),
    Feature("level_variation", "dB", "Standard deviation of the levels of 64 ms.",
            THIS, lambda p: p.short_time.level_variation, tolerance=(0.0, 0.1)),
    Feature("crest", "dB", "Peak of the envelope re the rms value; 3 for a tone.",
            THIS, lambda p: 20.0 * math.log10(p.pulses.crest_factor), tolerance=(0.0, 0.5)),
    Feature("kurtosis", "1", "Fourth moment over the squared second; 1.5 for a tone, 3 for noise.",
            THIS, lambda p: p.pulses.kurtosis, tolerance=(0.05, 0.0)),
    Feature("high_kurtosis", "1", "The same of the part from 2 to 7 kHz.",
            THESIS_NOISES, lambda p: p.pulses.high_kurtosis, tolerance=(0.05, 0.0)),
    Feature("top_kurtosis", "1", "The same of the part from 7 to 13 kHz; needs a rate of 29.8 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[0].kurtosis, tolerance=(0.05, 0.0)),
    Feature("burst_share", "1",
            "Share of the energy from 2 to 7 kHz in the loudest tenth of the time.",
            THESIS_NOISES, lambda p: p.pulses.concentration),
    Feature("pulse_rate", "1/s", "Pulses from 2 to 7 kHz in a second.",
            THESIS_NOISES, lambda p: p.pulses.rate, silent=0.0),
    Feature("pulse_irregularity", "1",
            "Median log ratio of neighbouring intervals; 0 for a clock, 1.1 for a Poisson process.",
            THIS, lambda p: p.pulses.irregularity, tolerance=(0.0, 0.02)),
    Feature("pulse_glide", "1/s", "Trend of the logarithm of the pulse rate.",
            THIS, lambda p: p.pulses.glide, tolerance=(0.0, 0.02)),
    Feature("modulation_rate", "Hz", "Repetition rate of the envelope, 2 to 400 Hz.",
            PITCH, lambda p: p.modulation.rate, tolerance=(0.002, 0.0)),
    Feature("modulation_strength", "1", "Autocorrelation of the envelope at that rate.",
            PITCH, lambda p: p.modulation.strength, silent=0.0, tolerance=(0.0, 0.02)),
    Feature("modulation_depth", "1",
            "Standard deviation of the envelope from 2 to 400 Hz over its mean.",
            THIS, lambda p: p.modulation.depth, silent=0.0),
)  # fmt: skip
"""Of sound and acceleration, in the order of the feature vector."""
