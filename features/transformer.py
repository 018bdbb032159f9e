"""The features as a scikit-learn transformer, so that they can stand first in a pipeline.

Scikit-learn knows tables of samples by features. Here a sample is a waveform: the rows of X are
waveforms of one channel, its columns moments of time, and their rate is a parameter. Recordings
are taken as well, each with its own rate, length and channels. Nothing is learned: what `fit`
keeps is the number of columns, for scikit-learn's checks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import _check_feature_names_in, validate_data

from features.kernels.conditioning import MIN_SAMPLES
from features.recording import recording_features
from features.table import KINDS, feature_names
from models.errors import ParameterError
from models.recording import Channel, Recording


class RecordingFeatures(TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Features of waveforms or recordings, one row each.

    Parameters
    ----------
    kinds : tuple of str
        Kinds of channel to describe, each ``"pressure"``, ``"acceleration"`` or ``"torque"``; of a
        recording the first channel of each. Waveforms are of one kind.
    rate : float
        Sampling rate of waveforms [Hz]; recordings have their own.
    calibrated : bool
        Whether waveforms are in physical units; levels are NaN otherwise.

    Attributes
    ----------
    n_features_in_ : int
        Samples of a waveform. Not set by recordings.

    Notes
    -----
    A feature that is undefined is NaN, as in `feature_vector`; all are of a waveform of fewer than
    16 samples. Put an imputer behind it where the next step takes no NaN.

    Examples
    --------
    >>> hiss = np.random.default_rng(1).normal(size=(2, 4800))
    >>> table = RecordingFeatures(rate=48e3).fit_transform(hiss)
    >>> names = RecordingFeatures().fit(hiss).get_feature_names_out()
    >>> table.shape == (2, len(names)), names[2]
    (True, 'pressure_hum_share')
    """

    def __init__(
        self,
        kinds: tuple[str, ...] = ("pressure",),
        *,
        rate: float = 48_000.0,
        calibrated: bool = False,
    ) -> None:
        self.kinds = kinds
        self.rate = rate
        self.calibrated = calibrated

    def fit(self, X: ArrayLike | Sequence[Recording], y: object = None) -> RecordingFeatures:  # noqa: ARG002
        """Check parameters and input; nothing is learned.

        Parameters
        ----------
        X : array_like, shape (n_waveforms, n_samples), or sequence of Recording
        y : ignored

        Raises
        ------
        ParameterError
            Kinds or a rate that cannot be used.
        ValueError
            An input that scikit-learn refuses.
        """
        self._recordings(X, reset=True)
        return self

    def transform(self, X: ArrayLike | Sequence[Recording]) -> NDArray[np.float64]:
        """Compute the features.

        Parameters
        ----------
        X : array_like, shape (n_waveforms, n_samples), or sequence of Recording
            Of each kind that a recording does not have, all features are NaN.

        Returns
        -------
        ndarray, shape (n_waveforms, n_features)
            Columns as `get_feature_names_out` names them, in the units of the table.

        Raises
        ------
        ParameterError
            A channel that cannot be analysed.
        ValueError
            An input that scikit-learn refuses.
        """
        names = self.get_feature_names_out().tolist()
        rows = []
        for run in self._recordings(X, reset=not hasattr(self, "n_features_in_")):
            long_enough = run.samples.shape[1] >= MIN_SAMPLES
            found = recording_features(run, names=frozenset(names)) if long_enough else {}
            rows.append([found.get(name, math.nan) for name in names])
        return np.array(rows)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Names of the columns: the kind of channel and the feature.

        Parameters
        ----------
        input_features : array_like of str, optional
            Names of the columns of X, checked against those seen in `fit` and not used.
        """
        if input_features is not None:
            _check_feature_names_in(self, input_features)
        names = [f"{kind}_{name}" for kind in self.kinds for name in feature_names(kind)]
        return np.array(names, dtype=object)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.requires_fit = False
        return tags

    def _recordings(self, X: Any, *, reset: bool) -> Sequence[Recording]:
        """Check parameters and input; waveforms become recordings of one channel."""
        kinds = tuple(self.kinds) if isinstance(self.kinds, tuple | list) else (self.kinds,)
        if isinstance(self.kinds, str) or not kinds or not set(kinds) <= set(KINDS):
            raise ParameterError(f"kinds are {self.kinds!r}; give a tuple of {', '.join(KINDS)}")
        if not 0.0 < self.rate < math.inf:
            raise ParameterError(f"rate is {self.rate!r}; a sampling rate is a positive number")
        found = [isinstance(x, Recording) for x in X] if isinstance(X, list | tuple) else []
        if any(found):
            if not all(found):
                raise ParameterError(f"X mixes recordings with others (item {found.index(False)})")
            return list(X)
        if len(kinds) != 1:
            raise ParameterError(f"kinds are {self.kinds}; waveforms are of one kind")
        channels = (Channel(kinds[0]),)
        return [
            Recording(row[np.newaxis], self.rate, channels, calibrated=self.calibrated)
            for row in validate_data(self, X, dtype=np.float64, reset=reset)
        ]
