"""Every feature is one entry: its name, unit, definition, source, and how it is computed.

The registry is the only list. Tables, documentation and classifiers read it, so adding a feature
is adding an entry. Names carry the kind of channel as a prefix only where several kinds stand side
by side, in `recording_features`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from features.prepared import ACOUSTIC_KINDS, prepare
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from features.prepared import Prepared
    from models.recording import Recording

__all__ = [
    "KINDS",
    "Feature",
    "feature_names",
    "feature_vector",
    "features_of",
    "recording_feature_names",
    "recording_features",
]

KINDS = (*ACOUSTIC_KINDS, "torque")
"""Kinds of channel that have features."""


@dataclass(frozen=True)
class Feature:
    """One number that describes a signal.

    Parameters
    ----------
    name : str
    unit : str
        "1" for pure numbers.
    definition : str
        In one line.
    source : str
        Where the definition comes from.
    compute : callable
        Of a `Prepared` signal.
    silent : float, optional
        Value for a signal without content; None where `compute` knows itself.
    calibrated : bool
        Whether it needs a calibrated signal; all others do not depend on the gain.
    kinds : tuple of str
        Kinds of channel it applies to.
    """

    name: str
    unit: str
    definition: str
    source: str
    compute: Callable[[Prepared], float]
    silent: float | None = math.nan
    calibrated: bool = False
    kinds: tuple[str, ...] = ACOUSTIC_KINDS

    def __call__(self, signal: Prepared) -> float:
        """Value for a signal; NaN where it is undefined."""
        if self.calibrated and not signal.calibrated:
            return math.nan
        if signal.silent and self.silent is not None:
            return self.silent
        return float(self.compute(signal))


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
    # The entries need Feature, so they can only be imported once this module is complete.
    from features.acoustic_features import ACOUSTIC_FEATURES
    from features.torque_features import TORQUE_FEATURES

    if kind not in KINDS:
        raise ParameterError(f"channels of kind {kind!r} have no features; use {', '.join(KINDS)}")
    return tuple(f for f in (*ACOUSTIC_FEATURES, *TORQUE_FEATURES) if kind in f.kinds)


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
