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
once (`features.windows`), A-weighted, in single precision and from other segments. A feature of the
same name there is another number, of some by another formula; neither can replace the other.

A recording of 2^21 samples or more (44 s at 48 kHz) is analysed in equal pieces of at most 2^19,
whose features are combined.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.spectra import weighted_median
from features.prepared import ACOUSTIC_KINDS, Prepared, prepare
from models.errors import ParameterError
from models.recording import Read, Recording, RecordingBlocks, reader_of
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


LONG, PIECE = 1 << 21, 1 << 19
"""Samples from which a channel is analysed in pieces (44 s at 48 kHz), and the largest piece."""


def feature_vector(
    signal: ArrayLike,
    rate: float,
    kind: str,
    *,
    calibrated: bool = True,
) -> dict[str, float]:
    """Return all features of one channel.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        In the channel's unit or, if not calibrated, in fractions of full scale; 20 ms or more.
        Features that need a longer signal are NaN.
    rate : float
        Sampling rate [Hz]. From 16 kHz on acoustic features do not depend on it, except that top
        bands beyond it are NaN.
    kind : {"pressure", "acceleration", "torque"}
    calibrated : bool
        Whether the samples are in physical units; levels are NaN otherwise.

    Returns
    -------
    dict of str to float
        By the names of `feature_names`, in the units of `features.table` [unit]. NaN for an
        undefined feature.

    Raises
    ------
    ParameterError
        The signal cannot be analysed, or its kind has no features.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(48000) / 48e3
    >>> squeal = feature_vector(np.sin(2 * np.pi * 1046 * t), 48e3, "pressure")
    >>> round(squeal["line_frequency"]), round(squeal["line_share"], 2), squeal["line_count"]
    (1046, 1.0, 1.0)
    """
    features = features_of(kind)
    prepared = prepare(signal, rate, kind, calibrated=calibrated)
    return {feature.name: feature(prepared) for feature in features}


def piece_count(n_samples: int) -> int:
    """Return the number of pieces in which a channel is analysed.

    Examples
    --------
    >>> piece_count(48_000), piece_count(2**21)
    (1, 4)
    """
    return -(-n_samples // PIECE) if n_samples >= LONG else 1


def recording_features(
    recording: Recording | RecordingBlocks,
) -> dict[str, float]:
    """Return the features of the first channel of each kind in a recording.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        Recording in memory, or read in parts as `noise.recordings` opens it. From 2^21 samples on
        it is analysed in pieces.

    Returns
    -------
    dict of str to float
        By the names of `recording_feature_names`, which have the kind as prefix, in the units of
        `features.table` [unit]. NaN for kinds that
        the recording does not have.

    Raises
    ------
    ParameterError
        A channel cannot be analysed; the message names it.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> hiss = np.random.default_rng(1).normal(size=(1, 4800))
    >>> features = recording_features(Recording(hiss, 48e3, (Channel("pressure"),)))
    >>> features["pressure_line_count"], features["torque_slip_rate"]
    (0.0, nan)
    """
    values: dict[str, float] = {}
    for kind in KINDS:
        by_name = {f"{kind}_{feature.name}": feature for feature in features_of(kind)}
        row = recording.first(kind)
        if row is None:
            values |= dict.fromkeys(by_name, math.nan)
            continue
        try:
            of_channel = _in_pieces(
                reader_of(recording, row), recording.n_samples, [*by_name.values()],
                rate=recording.rate, kind=kind, calibrated=recording.calibrated,
            )  # fmt: skip
            values |= zip(by_name, of_channel, strict=True)
        except ParameterError as error:
            channel = recording.channels[row].name
            raise ParameterError(
                f"recording {recording.name!r}, channel {channel!r}: {error}"
            ) from error
    return values


def _in_pieces(
    read: Read,
    n_samples: int,
    features: list[Feature],
    *,
    rate: float,
    kind: str,
    calibrated: bool,
) -> list[float]:
    """Return the features of a channel; those of a long one combine its pieces."""
    edges = np.linspace(0, n_samples, piece_count(n_samples) + 1).astype(int).tolist()
    values, power, moments = [], [], []
    for first, last in itertools.pairwise(edges):
        x = read(first, last)
        p = prepare(x, rate, kind, calibrated=calibrated, first=first)
        values.append([feature(p) for feature in features])
        power.append(0.0 if p.silent else p.rms**2 * p.in_band_power)
        moments.append((p.mean, p.rms))
    if len(values) == 1:
        return values[0]
    mean, rms = np.array(moments).T
    whole = replace(
        p, samples=np.empty(0), mean=float(mean.mean()),
        rms=math.sqrt(float(np.mean(rms**2) + np.var(mean))),
    )  # fmt: skip
    weights = np.array(power) if any(power) else np.ones(len(power))
    return [
        feature(whole) if feature.pooled is None else _pooled(feature.pooled, column, weights)
        for feature, column in zip(features, np.array(values).T, strict=True)
    ]


def _pooled(
    pooled: Callable[[NDArray[np.float64], NDArray[np.float64]], float],
    values: NDArray[np.float64],
    power: NDArray[np.float64],
) -> float:
    """Combine the values of all pieces; a piece without a value does not count."""
    defined = ~np.isnan(values)
    if not defined.any():
        return math.nan
    if pooled is pooled_levels:
        defined[:] = True
    elif power[defined].any():
        return pooled(values[defined], power[defined])
    return pooled(values[defined], np.ones(int(defined.sum())))
