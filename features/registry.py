"""All features by kind of channel, and their values for a signal or a recording.

The entries are the only list there is. Tables, documentation and classifiers read it, so adding a
feature is adding an entry. Names carry the kind of channel as a prefix only where several kinds
stand side by side, in `recording_features`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from features.prepared import ACOUSTIC_KINDS, prepare
from features.spectral_features import SPECTRAL_FEATURES
from features.temporal_features import TEMPORAL_FEATURES
from features.torque_features import TORQUE_FEATURES
from models.errors import ParameterError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from features.feature import Feature
    from models.recording import Recording

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


FEATURES: tuple[Feature, ...] = (*SPECTRAL_FEATURES, *TEMPORAL_FEATURES, *TORQUE_FEATURES)
"""All features of all kinds."""


def features_of(kind: str) -> tuple[Feature, ...]:
    """Entries of the features of a kind of channel, in the order of the feature vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

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
    return tuple(f for f in FEATURES if kind in f.kinds)


def feature_names(kind: str) -> tuple[str, ...]:
    """Names of the features of a kind of channel, in the order of the feature vector.

    Parameters
    ----------
    kind : {"pressure", "acceleration", "torque"}

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
    signal: ArrayLike, rate: float, kind: str, *, calibrated: bool = True
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
    prepared = prepare(signal, rate, kind, calibrated=calibrated)
    return {feature.name: feature(prepared) for feature in features}


def recording_feature_names() -> tuple[str, ...]:
    """Names in the order of `recording_features`.

    Examples
    --------
    >>> recording_feature_names()[0]
    'pressure_level'
    """
    return tuple(f"{kind}_{name}" for kind in KINDS for name in feature_names(kind))


def recording_features(recording: Recording) -> dict[str, float]:
    """Features of the first channel of each kind in a recording.

    Parameters
    ----------
    recording : Recording

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
        name = next((channel.name for channel in recording.channels if channel.kind == kind), None)
        if name is None:
            values = dict.fromkeys(feature_names(kind), math.nan)
        else:
            try:
                values = feature_vector(
                    recording[name], recording.rate, kind, calibrated=recording.calibrated
                )
            except ParameterError as error:
                raise ParameterError(
                    f"recording {recording.name!r}, channel {name!r}: {error}"
                ) from error
        found.update({f"{kind}_{key}": value for key, value in values.items()})
    return found
