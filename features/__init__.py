"""From a signal to the numbers that an NVH engineer reads.

Spectra, bands, lines, harmonics and slip events each have a function and a frozen result of their
own; `feature_vector` and `recording_features` gather what tells one noise from another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import lazy_loader

if TYPE_CHECKING:
    from features.bands import (
        NOMINAL_THIRD_OCTAVES,
        REFERENCES,
        THESIS_BANDS,
        a_weighting,
        band_levels,
        band_power,
        overall_level,
        third_octave_edges,
        third_octave_levels,
    )
    from features.feature import Feature
    from features.harmonics import Harmonics, analyse_harmonics
    from features.lines import Lines, find_lines
    from features.registry import (
        FEATURES,
        feature_names,
        feature_vector,
        features_of,
        recording_feature_names,
        recording_features,
    )
    from features.slip_drops import TorqueSlips, torque_slips
    from features.slip_pulses import Pulses, acoustic_slips
    from features.spectra import SpectralShape, Spectrum, autospectrum, spectral_shape

__all__ = [
    "FEATURES",
    "NOMINAL_THIRD_OCTAVES",
    "REFERENCES",
    "THESIS_BANDS",
    "Feature",
    "Harmonics",
    "Lines",
    "Pulses",
    "SpectralShape",
    "Spectrum",
    "TorqueSlips",
    "a_weighting",
    "acoustic_slips",
    "analyse_harmonics",
    "autospectrum",
    "band_levels",
    "band_power",
    "feature_names",
    "feature_vector",
    "features_of",
    "find_lines",
    "overall_level",
    "recording_feature_names",
    "recording_features",
    "spectral_shape",
    "third_octave_edges",
    "third_octave_levels",
    "torque_slips",
]

__getattr__, __dir__, _ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "bands": [
            "NOMINAL_THIRD_OCTAVES",
            "REFERENCES",
            "THESIS_BANDS",
            "a_weighting",
            "band_levels",
            "band_power",
            "overall_level",
            "third_octave_edges",
            "third_octave_levels",
        ],
        "feature": ["Feature"],
        "harmonics": ["Harmonics", "analyse_harmonics"],
        "lines": ["Lines", "find_lines"],
        "registry": [
            "FEATURES",
            "feature_names",
            "feature_vector",
            "features_of",
            "recording_feature_names",
            "recording_features",
        ],
        "slip_drops": ["TorqueSlips", "torque_slips"],
        "slip_pulses": ["Pulses", "acoustic_slips"],
        "spectra": ["SpectralShape", "Spectrum", "autospectrum", "spectral_shape"],
    },
)
