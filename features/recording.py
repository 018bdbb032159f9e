"""Features of a channel or a recording: the values of the entries of `features.table`.

A recording of 2^21 samples or more (44 s at 48 kHz) is described in equal pieces of at most 2^19,
each by the same functions, and its features are those of the pieces put together.

A contact that sticks takes the shaft's whole motion into the springs, so that the torque rises at
k_EFF times the speed (thesis, 5.1); one that slides rises slower. With the clamp bolted down a
simulated contact that sticks reaches the rate within 1 %, on beams within some 10 % at 1 rad/s.
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
"""Samples of a channel from which on it is described in pieces, and the most in a piece: 44 s and
11 s at 48 kHz."""


def feature_vector(
    signal: ArrayLike,
    rate: float,
    kind: str,
    *,
    calibrated: bool = True,
    stick_rate: float = math.nan,
) -> dict[str, float]:
    """All features of one channel.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        In the channel's unit or, not calibrated, in fractions of full scale. 20 ms and more; what
        needs longer to be told is NaN.
    rate : float
        Sampling rate [Hz]. Values of acoustic features do not depend on it from 16 kHz on, but
        those of the top bands are NaN where it does not reach them.
    kind : {"pressure", "acceleration", "torque"}
    calibrated : bool
        Whether the samples are in physical units; levels are NaN otherwise.
    stick_rate : float
        How fast a torque rises in true stick [N m/s], if known: k_EFF times the shaft's speed.

    Returns
    -------
    dict of str to float
        By name, as `feature_names` has them. NaN where a feature is undefined.

    Raises
    ------
    ParameterError
        A signal that can't be analysed, or a kind without features.

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
    """Pieces in which a channel of so many samples is described.

    Examples
    --------
    >>> piece_count(48_000), piece_count(2**21)
    (1, 4)
    """
    return -(-n_samples // PIECE) if n_samples >= LONG else 1


def recording_features(
    recording: Recording | RecordingBlocks,
) -> dict[str, float]:
    """Features of the first channel of each kind in a recording.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        In memory, or one of which parts can be had, as `noise.recordings` opens. From
        2^21 samples on it is described in pieces.

    Returns
    -------
    dict of str to float
        By name with the kind as prefix, as `recording_feature_names` has them. NaN for kinds that
        the recording does not have.

    Raises
    ------
    ParameterError
        A channel that can't be analysed; the message names it.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> hiss = np.random.default_rng(1).normal(size=(1, 4800))
    >>> found = recording_features(Recording(hiss, 48e3, (Channel("pressure"),)))
    >>> found["pressure_line_count"], found["torque_slip_rate"]
    (0.0, nan)
    """
    found: dict[str, float] = {}
    for kind in KINDS:
        wanted = {f"{kind}_{feature.name}": feature for feature in features_of(kind)}
        row = recording.first(kind)
        if row is None:
            found |= dict.fromkeys(wanted, math.nan)
            continue
        try:
            stick_rate = stick_rate_of(recording) if kind == "torque" else math.nan
            values = _in_pieces(
                reader_of(recording, row), recording.n_samples, [*wanted.values()],
                rate=recording.rate, kind=kind, calibrated=recording.calibrated,
                stick_rate=stick_rate,
            )  # fmt: skip
            found |= zip(wanted, values, strict=True)
        except ParameterError as error:
            channel = recording.channels[row].name
            raise ParameterError(
                f"recording {recording.name!r}, channel {channel!r}: {error}"
            ) from error
    return found


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
    """Features of a channel, of a long one put together from those of its pieces."""
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
        feature(whole) if feature.pooled is None else _together(feature.pooled, column, weights)
        for feature, column in zip(features, np.array(values).T, strict=True)
    ]


def _together(
    pooled: Callable[[NDArray[np.float64], NDArray[np.float64]], float],
    values: NDArray[np.float64],
    power: NDArray[np.float64],
) -> float:
    """One value of those of all pieces; where a piece has none, it does not count."""
    known = ~np.isnan(values)
    if not known.any():
        return math.nan
    if pooled is pooled_levels:
        known[:] = True
    elif power[known].any():
        return pooled(values[known], power[known])
    return pooled(values[known], np.ones(int(known.sum())))


_ANGLE_BLOCK = 0.02
"""Length over which the angle is averaged before its slope is taken [s]."""

_LEAST_ANGLE_BLOCKS = 3

_MOST_SPEEDS = 1 << 21
"""Samples of a speed of which the median is taken; of more, every so many-th."""

_AT_ONCE = 1 << 16
"""Samples looked at together."""


def stick_rate_of(recording: Recording | RecordingBlocks) -> float:
    """Product of k_EFF and the shaft's speed (thesis, (5.1)).

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        Its condition tells interference, support and material, whose shipped rig has the
        elastomer's stiffness.

    Returns
    -------
    float
        [N m/s], without sign; NaN where speed, interference, support or material is not known.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> known = Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon-thesis")
    >>> run = Recording(np.zeros((1, 480)), 48e3, (Channel("torque"),), known)
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
    """Magnitude of the shaft's speed: median of its channels, or as it was set."""
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
            # Means of blocks first: the difference of single samples would be that of their noise.
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
    """Return the shipped rig with a material; nothing where the program does not know it."""
    try:
        return None if material is None else load_material_rig(material)
    except ParameterError:
        return None
