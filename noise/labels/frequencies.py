"""Frequency of a segment, and what is kept of the windows of a recording to tell it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.named.prepared import ACOUSTIC_KINDS
from features.windows.declared import WINDOW_FEATURES
from noise.labels.windows import FEATURE_NAMES

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FREQUENCY_NAMES", "TELLING", "segment_frequency"]

_WANTED = (
    "high_period_strength", "high_period_rate", "period_strength", "period_rate", "high_blow_rate",
    "fundamental", "line_frequency", "line_count",
)  # fmt: skip

FREQUENCY_NAMES = (
    *(f"{kind}_{name}" for kind in ACOUSTIC_KINDS for name in _WANTED),
    "torque_fundamental", "torque_line_frequency",
)  # fmt: skip
"""Features of windows by which the frequency is told; of `noise.labels.windows.FEATURE_NAMES`."""

TELLING = [FEATURE_NAMES.index(name) for name in FREQUENCY_NAMES]
"""Their columns among the others."""

_PERIODIC = 0.3
"""Least autocorrelation of an envelope for its period to be that of slips."""

_LEAST_BLOWS = math.log2(3.0 / 10.0)
"""Fewer blows a second tell no rate [octave re 10 Hz]."""

_COLUMN = {name: i for i, name in enumerate(FREQUENCY_NAMES)}
_DECLARED = {feature.name: feature for feature in WINDOW_FEATURES}


def segment_frequency(features: NDArray[np.float32], label: str) -> float | None:
    """Return slip frequency of creak and squawk, else of the strongest line [Hz].

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the segment's windows, by `FREQUENCY_NAMES` [unit of each feature].
    label : str

    Returns
    -------
    float or None
        [Hz], of the torque where most windows have one; ``None`` for ``none``, or where nothing is
        found.

    Examples
    --------
    >>> features = np.full((2, len(FREQUENCY_NAMES)), np.nan, dtype=np.float32)
    >>> features[:, FREQUENCY_NAMES.index("pressure_line_frequency")] = 1.0
    >>> features[:, FREQUENCY_NAMES.index("pressure_line_count")] = 1.0
    >>> segment_frequency(features, "squeal")
    2000.0
    """
    if label == "none":
        return None
    slips = label in ("creak", "squawk")
    torque = "torque_fundamental" if slips else "torque_line_frequency"
    known = np.isfinite(features[:, _COLUMN[torque]])
    if 2 * known.sum() > len(known):  # one window in many tells of chance, not of the segment
        return _median(features, torque)
    for kind in ("pressure", "acceleration"):
        found = None
        if label == "creak":
            found = _blow_rate(features, kind)
        if slips and found is None:
            found = _frequency(features, kind, "fundamental")
        if found is None:
            counted = features[features[:, _COLUMN[f"{kind}_line_count"]] > 0]
            found = _frequency(counted, kind, "line_frequency")
        if found is not None:
            return found
    return None


def _blow_rate(features: NDArray[np.float32], kind: str) -> float | None:
    """Rate of a creak's blows [Hz], of their period where most windows have one."""
    for part in ("high_", ""):
        strength = features[:, _COLUMN[f"{kind}_{part}period_strength"]]
        periodic = features[strength > _PERIODIC]
        if 2 * len(periodic) > len(features):
            return _frequency(periodic, kind, f"{part}period_rate")
    rate = features[:, _COLUMN[f"{kind}_high_blow_rate"]]
    return _frequency(features[rate > _LEAST_BLOWS], kind, "high_blow_rate")


def _frequency(features: NDArray[np.float32], kind: str, name: str) -> float | None:
    """Median of a window feature that counts in octaves [Hz]."""
    octave = _median(features, f"{kind}_{name}")
    return None if octave is None else _DECLARED[name].hertz(octave)


def _median(features: NDArray[np.float32], name: str) -> float | None:
    """Median of what is known of a column, in the column's unit."""
    values = features[:, _COLUMN[name]]
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else None
