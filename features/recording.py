"""Features of a channel or a recording, as listed in `features.table`.

A recording of 2^21 samples or more (44 s at 48 kHz) is analysed in equal pieces of at most 2^19,
whose features are combined.

A sticking contact transfers the whole motion of the shaft to the springs, so the torque rises at
k_EFF times the speed (thesis, 5.1); in sliding it rises slower. With the clamp bolted down a
simulated sticking contact reaches this rate within 1 %, on beams within some 10 % at 1 rad/s.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.prepared import prepare
from features.table import KINDS, Feature, features_of, pooled_levels
from models.blocks import Read, RecordingBlocks, in_pieces, reader_of
from models.errors import ParameterError
from models.recording import Recording
from models.rig import Rig, effective_stiffness
from models.rig_file import load_material_rig

LONG, PIECE = 1 << 21, 1 << 19
"""Samples from which a channel is analysed in pieces (44 s at 48 kHz), and the largest piece."""


def feature_vector(
    signal: ArrayLike,
    rate: float,
    kind: str,
    *,
    calibrated: bool = True,
    stick_rate: float = math.nan,
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
    stick_rate : float
        Rate of a torque in true stick [N m/s], if known: k_EFF times the shaft's speed.

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
    prepared = prepare(signal, rate, kind, calibrated=calibrated, stick_rate=stick_rate)
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
            stick_rate = stick_rate_of(recording) if kind == "torque" else math.nan
            of_channel = _in_pieces(
                reader_of(recording, row), recording.n_samples, [*by_name.values()],
                rate=recording.rate, kind=kind, calibrated=recording.calibrated,
                stick_rate=stick_rate,
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
    stick_rate: float,
) -> list[float]:
    """Return the features of a channel; those of a long one combine its pieces."""
    edges = np.linspace(0, n_samples, piece_count(n_samples) + 1).astype(int).tolist()
    values, power, moments = [], [], []
    for first, last in itertools.pairwise(edges):
        x = read(first, last)
        p = prepare(x, rate, kind, calibrated=calibrated, stick_rate=stick_rate, first=first)
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


_ANGLE_BLOCK = 0.02
"""Length of the blocks of angle whose means give the speed [s]."""

_LEAST_ANGLE_BLOCKS = 3

_MOST_SPEEDS = 1 << 21
"""Most samples for the median of a speed; longer ones are thinned."""

_AT_ONCE = 1 << 16
"""Samples read at a time."""


def stick_rate_of(recording: Recording | RecordingBlocks) -> float:
    """Return the rate of the torque in true stick, k_EFF times the shaft's speed (thesis, (5.1)).

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        Its condition states interference, support and material, whose shipped rig has the
        elastomer's stiffness.

    Returns
    -------
    float
        Magnitude [N m/s]; NaN if speed, interference, support or material is unknown.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> condition = Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon-thesis")
    >>> run = Recording(np.zeros((1, 480)), 48e3, (Channel("torque"),), condition)
    >>> round(stick_rate_of(run))
    2557
    """
    condition = recording.condition
    if condition.interference is None or condition.support_stiffness is None:
        return math.nan
    rig, speed = _shipped(condition.material), _speed(recording)
    if rig is None or speed is None or speed == 0.0:
        return math.nan
    fit = rig.fit(condition.interference)
    return effective_stiffness(fit, condition.support_stiffness) * speed


def _speed(recording: Recording | RecordingBlocks) -> float | None:
    """Return the magnitude of the shaft's speed: median of its channels, else the condition's.

    Labels average the speed over a segment, identification and diagnosis need its course: they
    compute it from the same channels in other ways, whose bits the shipped models learned.
    """
    speed, angle = recording.first("speed"), recording.first("angle")
    n = recording.n_samples
    if recording.calibrated and speed is not None:
        every = 1 + n // _MOST_SPEEDS
        pieces = in_pieces(reader_of(recording, speed), n, every * _AT_ONCE)
        run = [np.abs(piece[::every]) for piece in pieces]
        return float(np.median(np.concatenate(run)))
    block = max(1, round(_ANGLE_BLOCK * recording.rate))
    if recording.calibrated and angle is not None:
        n_blocks = n // block
        if n_blocks >= _LEAST_ANGLE_BLOCKS:
            # Means of blocks first, since differences of single samples are dominated by noise.
            read = reader_of(recording, angle)
            means = np.concatenate(
                [
                    piece[: piece.size // block * block].reshape(-1, block).mean(axis=1)
                    for piece in in_pieces(read, n, max(1, _AT_ONCE // block) * block)
                ]
            )
            return float(np.median(np.abs(np.diff(means)))) * recording.rate / block
    set_speed = recording.condition.speed
    return None if set_speed is None else abs(set_speed)


@lru_cache(maxsize=16)
def _shipped(material: str | None) -> Rig | None:
    """Return the shipped rig with a material, or None for an unknown one."""
    try:
        return None if material is None else load_material_rig(material)
    except ParameterError:
        return None
