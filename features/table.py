"""Table of all features of signals, recordings and half-second windows, from `features.csv`.

A new feature is a row there: name, unit, definition and source, the kinds of channel or ``window``,
and the path to its value in the prepared signal, such as ``harmonics/count``. The value for a
silent signal may be a number, or the one at the path (``value``); otherwise it is undefined. Creak
is broadband, squawk has several discrete frequencies, squeal one predominant frequency, and a creak
is impulsive at each slip (thesis, 5.2.3); the rows follow these definitions. For sound and
acceleration all features except levels refer to the band from 150 Hz to 7 kHz, for a torque to its
oscillation about the mean from 5 Hz to 7 kHz, so neither gain nor a drifting offset matters. A band
is missing if the rate does not reach it, or if the signal is too short for four bins in it.

The features of windows are the input of the classifier. They are computed for hours of sound at
once (`features.windows`), A-weighted, in single precision and from other segments; a feature of the
same name there is the same quantity but another number, and neither can replace the other.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from features.kernels.spectra import weighted_median
from features.prepared import ACOUSTIC_KINDS, Prepared
from models.errors import ParameterError
from models.show import short_repr

KINDS = (*ACOUSTIC_KINDS, "torque")
"""Kinds of channel that have features."""


def _mean_by_power(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Return the mean weighted by power."""
    return float(np.average(values, weights=power))


def _mean_over_time(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    return float(values.mean())


def pooled_levels(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    """Return the level of the mean power [dB] of levels, shape (n,); NaN counts as silence."""
    return 10.0 * math.log10(float(np.mean(np.nan_to_num(10.0 ** (0.1 * values)))))


def _level_of_part(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Return the level of a part of the power relative to the whole, from such levels."""
    return 10.0 * math.log10(_mean_by_power(10.0 ** (0.1 * values), power))


def _peak(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Return the peak relative to the rms value [dB], from such levels."""
    return float(np.max(values + 10.0 * np.log10(power / power.mean())))


def _hum_share(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    rest = np.maximum(1.0 - values, np.finfo(np.float64).tiny)
    return 1.0 - float(power.sum() / (power / rest).sum())


def _kurtosis(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    return float(np.mean(values * power**2) / power.mean() ** 2)


Pooling = Callable[[NDArray[np.float64], NDArray[np.float64]], float]
"""Function of the values of pieces and their power that combines them."""

_POOLING: dict[str, Pooling | None] = {
    "": _mean_by_power,
    "time": _mean_over_time,
    "median": weighted_median,
    "levels": pooled_levels,
    "part": _level_of_part,
    "peak": _peak,
    "hum": _hum_share,
    "kurtosis": _kurtosis,
    "whole": None,
}
"""Pooling functions by name in the column ``pooled``."""


@short_repr
@dataclass(frozen=True)
class Feature:
    """Feature of a signal: a row of the table.

    Parameters
    ----------
    name : str
    unit : str
        "1" for dimensionless numbers.
    definition : str
        Definition in one line.
    source : str
        Source of the definition.
    value : str
        Path to the value: attributes, keys and indices, separated by "/", of a `Prepared` signal,
        or of the parts of windows (`features.windows.table`).
    silent : float, optional
        Value for a signal without content [unit]; None if the path has it.
    calibrated : bool
        Whether it needs a calibrated signal; all others do not depend on the gain.
    kinds : tuple of str
        Kinds of channel; ``window`` for windows of sound or acceleration.
    tolerance : tuple of 2 floats
        Agreement of values of the same sound at sampling rates from 16 to 192 kHz: within this
        share, or within this much [unit], whichever is more. It refers to the common band, so for
        `level` and `level_a` to sounds without content above 7 kHz.
    pooled : callable, optional
        Function that combines the values of a long recording's pieces, given their power in the
        described band; by default the mean by power. None for features of mean and rms value.

    Examples
    --------
    >>> from features.prepared import prepare
    >>> highest = Feature("highest", "Hz", "Upper limit.", "-", "limit", None)
    >>> highest(prepare([0.0] * 480, 48e3, "torque"))
    7000.0
    """

    name: str
    unit: str
    definition: str
    source: str
    value: str
    silent: float | None = math.nan
    calibrated: bool = False
    kinds: tuple[str, ...] = ACOUSTIC_KINDS
    tolerance: tuple[float, float] = (0.02, 0.01)
    pooled: Pooling | None = _mean_by_power

    def __call__(self, signal: Prepared) -> float:
        """Return the value for a signal; NaN if undefined."""
        if self.calibrated and not signal.calibrated:
            return math.nan
        if self.silent is not None and signal.silent:
            return self.silent
        return float(self.of(signal))

    def of(self, described: Any) -> Any:
        """Return the value at the feature's path; NaN if a part of it is None."""
        for step in self.value.split("/"):
            if isinstance(described, Mapping):
                described = described[step]
            elif step.isdecimal():
                described = described[int(step)]
            else:
                described = getattr(described, step)
            if described is None:
                return math.nan
        return described

    def hertz(self, octaves: float) -> float:
        """Convert a value in octaves to a frequency.

        Parameters
        ----------
        octaves : float
            Value in the unit of the feature, such as ``"octave re 100 Hz"`` [octave].

        Returns
        -------
        float
            [Hz]

        Examples
        --------
        >>> Feature("pitch", "octave re 1 kHz", "Pitch.", "-", "pitch").hertz(1.0)
        2000.0
        """
        number, unit = self.unit.removeprefix("octave re ").split()
        return float(number) * (1e3 if unit == "kHz" else 1.0) * float(2.0**octaves)


def _row(cells: Mapping[str, str]) -> Feature:
    silent = cells["silent"]
    return Feature(
        name=cells["name"],
        unit=cells["unit"],
        definition=cells["definition"],
        source=cells["source"],
        value=cells["value"],
        silent=None if silent == "value" else float(silent or math.nan),
        calibrated=cells["calibrated"] == "yes",
        kinds=tuple(cells["kinds"].split()),
        tolerance=(float(cells["within_share"] or 0.0), float(cells["within"] or 0.0)),
        pooled=_POOLING[cells["pooled"]],
    )


with Path(__file__).with_name("features.csv").open(encoding="utf-8", newline="") as _file:
    _ROWS = tuple(map(_row, csv.DictReader(_file)))

FEATURES = tuple(feature for feature in _ROWS if feature.kinds != ("window",))
"""Features of signals, in the order of the feature vector; those of a torque come last."""

WINDOW_FEATURES = tuple(feature for feature in _ROWS if feature.kinds == ("window",))
"""Features of windows of sound or acceleration, in the order of the classifier's inputs."""


def features_of(kind: str) -> tuple[Feature, ...]:
    """Return the features of a kind of channel, in the order of the feature vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

    Returns
    -------
    tuple of Feature

    Raises
    ------
    ParameterError
        The kind has no features.

    Examples
    --------
    >>> features_of("torque")[0].unit
    'N m'
    """
    if kind not in KINDS:
        raise ParameterError(f"channels of kind {kind!r} have no features; use {', '.join(KINDS)}")
    return tuple(feature for feature in FEATURES if kind in feature.kinds)


def feature_names(kind: str) -> tuple[str, ...]:
    """Return the names of the features of a kind of channel, in the order of the vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

    Returns
    -------
    tuple of str

    Raises
    ------
    ParameterError
        The kind has no features.

    Examples
    --------
    >>> "harmonicity" in feature_names("pressure")
    True
    """
    return tuple(feature.name for feature in features_of(kind))


def recording_feature_names() -> tuple[str, ...]:
    """Return the names of all features of a recording, in the order of `recording_features`.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> recording_feature_names()[0]
    'pressure_level'
    """
    return tuple(f"{kind}_{name}" for kind in KINDS for name in feature_names(kind))
