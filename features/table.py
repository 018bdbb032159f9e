"""Features of a signal, a recording or a half-second window: one table of all, `features.csv`.

A further feature is a row there: name, unit, definition and source, the kinds of channel or
``window``, and where its value stands in what has been computed, as a path such as
``harmonics/count``. The value of a silent signal may be a number, or what stands there all the
same (``value``); without either it is undefined. Creak is broadband, squawk has several discrete
frequencies, squeal one that predominates, and a creak is impulsive at each slip (thesis, 5.2.3);
the rows follow these words. Of sound and acceleration all but levels refer to the part from 150 Hz
to 7 kHz, of a torque to its oscillation about the mean from 5 Hz to 7 kHz, so that neither the gain
nor a drifting offset matters. A band is missing where the rate does not reach it, or where the
signal is too short for four bins in it.

The features of windows are what the classifier is given. They are computed for hours of sound at
once (`features.windows`), A-weighted, in single precision and from other segments; so what has the
same name there is the same idea but another number, and neither can stand in for the other.
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
    """Mean weighted by power."""
    return float(np.average(values, weights=power))


def _mean_over_time(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    return float(values.mean())


def pooled_levels(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:  # noqa: ARG001
    """Level of the mean power [dB], of levels of shape (n,); an empty piece counts as silent."""
    return 10.0 * math.log10(float(np.mean(np.nan_to_num(10.0 ** (0.1 * values)))))


def _level_of_part(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Level of a part of the power relative to all of it, of such levels."""
    return 10.0 * math.log10(_mean_by_power(10.0 ** (0.1 * values), power))


def _peak(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Peak relative to the rms value [dB], of such levels."""
    return float(np.max(values + 10.0 * np.log10(power / power.mean())))


def _hum_share(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    rest = np.maximum(1.0 - values, np.finfo(np.float64).tiny)
    return 1.0 - float(power.sum() / (power / rest).sum())


def _kurtosis(values: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    return float(np.mean(values * power**2) / power.mean() ** 2)


Pooling = Callable[[NDArray[np.float64], NDArray[np.float64]], float]
"""Puts the values of pieces together, given their power."""

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
"""By the name in the column ``pooled``."""


@short_repr
@dataclass(frozen=True)
class Feature:
    """One number that describes a signal: a row of the table.

    Parameters
    ----------
    name : str
    unit : str
        "1" for pure numbers.
    definition : str
        In one line.
    source : str
        Where the definition comes from.
    value : str
        Path to it: attributes, keys and places, divided by "/", of a `Prepared` signal, or of the
        parts of windows (`features.windows.table`).
    silent : float, optional
        Value for a signal without content [unit]; None where `value` knows itself.
    calibrated : bool
        Whether it needs a calibrated signal; all others do not depend on the gain.
    kinds : tuple of str
        Kinds of channel it applies to; ``window`` for windows of sound or acceleration.
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
        """Value for a signal; NaN where it is undefined."""
        if self.calibrated and not signal.calibrated:
            return math.nan
        if self.silent is not None and signal.silent:
            return self.silent
        return float(self.of(signal))

    def of(self, described: Any) -> Any:
        """Return the value in what has been computed; NaN where a part of that is missing."""
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
"""Features of signals, in the order of the feature vector; those of a torque last."""

WINDOW_FEATURES = tuple(feature for feature in _ROWS if feature.kinds == ("window",))
"""Of a window of sound or acceleration, in the order of the classifier's features."""


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
    return tuple(feature for feature in FEATURES if kind in feature.kinds)


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
