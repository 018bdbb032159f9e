"""All features by kind of channel, and their values for a signal or a recording.

The entries are the only list there is. Tables, documentation and classifiers read it, so adding a
feature is adding an entry. Names carry the kind of channel as a prefix only where several kinds
stand side by side, in `recording_features`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from features.long.parts import LONG, n_samples_of, reader_of
from features.named.band_features import BAND_FEATURES
from features.named.prepared import ACOUSTIC_KINDS, prepare
from features.named.spectral_features import SPECTRAL_FEATURES
from features.named.temporal_features import TEMPORAL_FEATURES
from features.named.torque_features import TORQUE_FEATURES
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import ArrayLike

    from features.long.parts import Parts
    from features.named.feature import Feature
    from features.named.prepared import Prepared
    from models.recording import Recording
    from models.rig import Rig

__all__ = [
    "FEATURES",
    "KINDS",
    "feature_names",
    "feature_vector",
    "features_of",
    "recording_feature_names",
    "recording_features",
]

KINDS = (*ACOUSTIC_KINDS, "torque")
"""Kinds of channel that have features."""


_ACOUSTIC: tuple[Feature, ...] = (*SPECTRAL_FEATURES, *BAND_FEATURES, *TEMPORAL_FEATURES)

FEATURES: tuple[Feature, ...] = tuple(dict.fromkeys((*_ACOUSTIC, *TORQUE_FEATURES)))
"""All features of all kinds; those of several kinds stand once."""


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
    table = TORQUE_FEATURES if kind == "torque" else _ACOUSTIC
    return tuple(feature for feature in table if kind in feature.kinds)


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


def recording_features(
    recording: Recording | Parts, *, rig: Rig | None = None, names: Collection[str] | None = None
) -> dict[str, float]:
    """Features of the first channel of each kind in a recording.

    Parameters
    ----------
    recording : Recording or Parts
        In memory, or one of which parts can be had, such as `noise.recordings.blocks` opens. From
        2 million samples on it is described piece by piece, which gives the same numbers, much
        closer than those of different sampling rates agree.
    rig : Rig, optional
        What the stiffness of the bushing is taken from; without it, the shipped rig with the
        material that the recording names.
    names : collection of str, optional
        Those to compute, which saves the time of the others; all by default.

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
    from features.kernels.stick_rate import stick_rate_of

    found: dict[str, float] = {}
    for kind in KINDS:
        wanted = {f"{kind}_{feature.name}": feature for feature in features_of(kind)}
        if names is not None:
            wanted = {name: feature for name, feature in wanted.items() if name in names}
        row = recording.first(kind)
        if row is None or not wanted:
            found |= dict.fromkeys(wanted, math.nan)
            continue
        try:
            stick_rate = stick_rate_of(recording, rig) if kind == "torque" else math.nan
            signal = _prepared(recording, row, kind, stick_rate)
            found |= {name: feature(signal) for name, feature in wanted.items()}
        except ParameterError as error:
            channel = recording.channels[row].name
            raise ParameterError(
                f"recording {recording.name!r}, channel {channel!r}: {error}"
            ) from error
    return found


def _prepared(recording: Recording | Parts, row: int, kind: str, stick_rate: float) -> Prepared:
    read, n = reader_of(recording, row), n_samples_of(recording)
    rate, calibrated = recording.rate, recording.calibrated
    if n < LONG:
        return prepare(read(0, n), rate, kind, calibrated=calibrated, stick_rate=stick_rate)
    from features.long.prepared import prepare_long

    return prepare_long(read, n, rate, kind, calibrated=calibrated, stick_rate=stick_rate)
