"""Features of a sound or an acceleration in bands of frequency: where its power lies.

Three sets stand side by side. Bands between 150 Hz and 7 kHz, and two above, describe any recording
in the same way, whatever its gain. The bands of the thesis tell torque from structure from creak
(5.2.3); the uppermost ends at half the thesis's own rate of 30 kHz, which no recorder measures, and
needs 34.3 kHz. One-third octaves are levels as `features.kernels.levels` has them, so they need a
calibrated signal. A band is missing where the rate does not reach it, or where the signal is too
short for four bins in it: of half a second, below 40 Hz.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from features.kernels.bands import NOMINAL_THIRD_OCTAVES, REFERENCES
from features.named.feature import Feature
from features.named.prepared import LEAST_SHARE_DB

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["BAND_FEATURES"]

_NOISES = "thesis, 5.2.3"
_IEC_OCTAVES = "IEC 61260-1:2014"
_THIS = "bushing-noise"


def _third_octave(name: str, p: Prepared) -> float:
    if p.rms == 0.0:
        return math.nan
    level = p.third_octaves[name]
    if math.isnan(level):
        return math.nan
    least = 20.0 * math.log10(p.rms) + LEAST_SHARE_DB
    return max(level, least) - 20.0 * math.log10(REFERENCES[p.kind])


BAND_FEATURES = (
    Feature(
        "band_150_500",
        "dB",
        "Level from 150 to 500 Hz re that from 150 Hz to 7 kHz.",
        _THIS,
        lambda p: p.share_db(150.0, 500.0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_500_1000",
        "dB",
        "Level from 500 Hz to 1 kHz re that from 150 Hz to 7 kHz.",
        _THIS,
        lambda p: p.share_db(500.0, 1_000.0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_1000_2000",
        "dB",
        "Level from 1 to 2 kHz re that from 150 Hz to 7 kHz.",
        _THIS,
        lambda p: p.share_db(1_000.0, 2_000.0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_2000_5000",
        "dB",
        "Level from 2 to 5 kHz re that from 150 Hz to 7 kHz.",
        _NOISES,
        lambda p: p.share_db(2_000.0, 5_000.0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_5000_7000",
        "dB",
        "Level from 5 to 7 kHz re that from 150 Hz to 7 kHz.",
        _NOISES,
        lambda p: p.share_db(5_000.0, 7_000.0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_7000_13000",
        "dB",
        "Level from 7 to 13 kHz re that from 150 Hz to 7 kHz; needs a rate of 29.8 kHz.",
        _NOISES,
        lambda p: p.top_bands[0][0],
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_13000_19000",
        "dB",
        "Level from 13 to 19 kHz re that from 150 Hz to 7 kHz; needs a rate of 43.5 kHz.",
        _NOISES,
        lambda p: p.top_bands[1][0],
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_0_2000",
        "dB",
        "Level below 2 kHz, hum included, re that from 150 Hz to 7 kHz.",
        _NOISES,
        lambda p: p.thesis_band(0),
        tolerance=(0.0, 0.1),
    ),
    Feature(
        "band_5000_15000",
        "dB",
        "Level from 5 to 15 kHz re that from 150 Hz to 7 kHz; needs a rate of 34.3 kHz.",
        _NOISES,
        lambda p: p.thesis_band(2),
        tolerance=(0.0, 0.2),
    ),
    *(
        Feature(
            f"third_octave_{name}",
            "dB",
            f"Level in the one-third octave at {name} Hz, re 20 uPa or 1 um/s2.",
            _IEC_OCTAVES,
            partial(_third_octave, name),
            silent=None,
            calibrated=True,
            tolerance=(0.0, 0.1),
        )
        for name in NOMINAL_THIRD_OCTAVES
    ),
)
"""Entries in the order of the feature vector."""
