"""Pitch over time by pYIN, for sounds whose fundamental changes.

A creak's pitch falls as the shaft slows down, and a hinge's glides. The computation takes about as
long as the sound; the first one also compiles librosa.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.conditioning import checked_signal, usable_limit
from models.show import short_repr

_HOP = 0.01
"""Time between estimates [s]."""


@short_repr
@dataclass(frozen=True, eq=False)
class PitchTrack:
    """Pitch over time.

    Parameters
    ----------
    time : ndarray, shape (n,)
        [s]
    frequency : ndarray, shape (n,)
        [Hz]; NaN where there is no pitch.
    """

    time: NDArray[np.float64]
    frequency: NDArray[np.float64]


def pitch_track(
    signal: ArrayLike, rate: float, *, lowest: float = 60.0, highest: float = 3000.0
) -> PitchTrack:
    """Estimate the pitch of a signal over time.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        In any unit.
    rate : float
        Sampling rate [Hz].
    lowest, highest : float
        Limits of the pitch [Hz].

    Returns
    -------
    PitchTrack
        One estimate every 10 ms.

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Notes
    -----
    M. Mauch and S. Dixon, pYIN: a fundamental frequency estimator using probabilistic threshold
    distributions, ICASSP 2014; as implemented in librosa.

    Examples
    --------
    A tone that glides from 200 to 400 Hz in a second is tracked within 3 %:

    >>> time = np.arange(16_000) / 16e3
    >>> track = pitch_track(np.sin(2 * np.pi * (200 * time + 100 * time**2)), 16e3)
    >>> inside = (track.time > 0.15) & (track.time < 0.85)
    >>> right = 200 + 200 * track.time[inside]
    >>> bool(np.all(abs(track.frequency[inside] / right - 1) < 0.03))
    True
    """
    import librosa

    x = checked_signal(signal, rate)
    hop = max(1, round(_HOP * rate))
    frame = 2 ** int(np.ceil(np.log2(4.0 * rate / lowest)))
    if not np.ptp(x) > 0.0 or usable_limit(rate) <= lowest:
        time = np.arange(1 + x.size // hop) * hop / rate
        return PitchTrack(time, np.full(time.size, np.nan))
    frequency, _, _ = librosa.pyin(
        x,
        fmin=lowest,
        fmax=min(highest, usable_limit(rate)),
        sr=rate,
        frame_length=frame,
        hop_length=hop,
    )
    return PitchTrack(np.arange(frequency.size) * hop / rate, np.asarray(frequency, dtype=float))
