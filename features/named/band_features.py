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

from features.kernels.bands import LEAST_SHARE_DB, NOMINAL_THIRD_OCTAVES, REFERENCES
from features.named.feature import THESIS_NOISES, THIS, Feature

if TYPE_CHECKING:
    from features.named.prepared import Prepared

__all__ = ["BAND_FEATURES"]

_RE_ALL = "re that from 150 Hz to 7 kHz"
_TENTH_DB = (0.0, 0.1)


def _share(low: float, high: float, p: Prepared) -> float:
    return p.share_db(low, high)


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
                source, partial(_share, float(low), float(high)), tolerance=_TENTH_DB)
        for low, high, source in ((150, 500, THIS), (500, 1000, THIS), (1000, 2000, THIS),
                                  (2000, 5000, THESIS_NOISES), (5000, 7000, THESIS_NOISES))
    ),
    Feature("band_7000_13000", "dB", f"Level from 7 to 13 kHz {_RE_ALL}; needs a rate of 29.8 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[0].level, tolerance=_TENTH_DB),
    Feature("band_13000_19000", "dB",
            f"Level from 13 to 19 kHz {_RE_ALL}; needs a rate of 43.5 kHz.",
            THESIS_NOISES, lambda p: p.top_bands[1].level, tolerance=_TENTH_DB),
    Feature("band_0_2000", "dB", f"Level below 2 kHz, hum included, {_RE_ALL}.",
            THESIS_NOISES, lambda p: p.thesis_band(0), tolerance=_TENTH_DB),
    Feature("band_5000_15000", "dB", f"Level from 5 to 15 kHz {_RE_ALL}; needs a rate of 34.3 kHz.",
            THESIS_NOISES, lambda p: p.thesis_band(2), tolerance=(0.0, 0.2)),
    *(
        Feature(f"third_octave_{name}", "dB",
                f"Level in the one-third octave at {name} Hz, re 20 uPa or 1 um/s2.",
                "IEC 61260-1:2014", partial(_third_octave, name), silent=None, calibrated=True,
                tolerance=_TENTH_DB)
        for name in NOMINAL_THIRD_OCTAVES
    ),
)  # fmt: skip
"""Of sound and acceleration, in the order of the feature vector."""
