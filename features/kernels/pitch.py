"""Pitch over time, by pYIN: on request, since it takes as long as the sound.

The fundamental of `features.kernels.harmonics` is one number a segment, found in some milliseconds.
Where the pitch moves, as a creak's does when the shaft slows down, its track tells more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.conditioning import checked_signal, usable_limit
from models.show import short_repr

_HOP = 0.01
"""Time from one estimate to the next [s]."""


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

    @property
    def median(self) -> float:
        """Median pitch [Hz]; NaN without one."""
        voiced = self.frequency[np.isfinite(self.frequency)]
        return float(np.median(voiced)) if voiced.size else float("nan")

    @property
    def voiced_share(self) -> float:
        """Share of the time that has a pitch."""
        return float(np.mean(np.isfinite(self.frequency)))

    @property
    def range(self) -> float:
        """From the 5th to the 95th percentile of the pitch [octaves]; NaN without one."""
        voiced = self.frequency[np.isfinite(self.frequency)]
        if not voiced.size:
            return float("nan")
        low, high = np.percentile(voiced, [5.0, 95.0])
        return float(np.log2(high / low))


def pitch_track(
    signal: ArrayLike, rate: float, *, lowest: float = 60.0, highest: float = 3000.0
) -> PitchTrack:
    """Follow the pitch of a signal.

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
        A signal that can't be analysed.

    Notes
    -----
    M. Mauch and S. Dixon, pYIN: a fundamental frequency estimator using probabilistic threshold
    distributions, ICASSP 2014; as implemented in librosa.

    Examples
    --------
    >>> t = np.arange(8000) / 16e3
    >>> track = pitch_track(np.sin(2 * np.pi * 250 * t), 16e3)
    >>> round(track.median), track.voiced_share > 0.8
    (250, True)
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
