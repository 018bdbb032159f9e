"""Features of a channel or a recording, as listed in `features.table`.

A recording of 2^21 samples or more (44 s at 48 kHz) is analysed in equal pieces of at most 2^19,
whose features are combined.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.prepared import prepare
from features.table import KINDS, Feature, features_of, pooled_levels
from models.blocks import Read, RecordingBlocks, reader_of
from models.errors import ParameterError
from models.recording import Recording

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
