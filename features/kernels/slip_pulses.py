"""Slips that are heard: pulses of sound or vibration, and their rhythm.

A creak is a sequence of impulses, one at each slip (thesis, 5.2.3), and what tells it from rain or
a crackling fire is less the spectrum than their rhythm: their rate, how regular they are about a
rate that may glide, how high they stand. Pulses are maxima of the envelope of the part above 2 kHz,
where hum and tones are weak and every pulse is short. The envelope is smoothed over 1 ms: pulses
that ring for 5 ms stay apart up to about 200 a second, and white noise, which after less smoothing
would be full of maxima, shows about 14 irregular ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter1d

from features.kernels.conditioning import (
    WORKING_LIMIT,
)
from models.show import short_repr

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Pulses"]

PULSE_BAND_FROM = 2_000.0
"""Lower limit of the band in which pulses are sought [Hz]; lower for a rate below 16 kHz."""

SMOOTHING = 0.0005
"""Standard deviation of the Gaussian that smooths the squared envelope [s]."""

PULSE_PROMINENCE_DB = 6.0
"""A pulse rises and falls by at least this much [dB]."""

_LEAST_PULSES = 4

LEAST_HIGH_SHARE = 1e-6
"""Power of the high band, relative to the whole, below which it holds leakage only."""

PULSE_RANGE_DB = 25.0
"""Pulses weaker than the strongest by more than this are not counted [dB]."""


@short_repr
@dataclass(frozen=True, eq=False)
class Pulses:
    """Pulses in a sound or an acceleration, one at each slip of a creak.

    Parameters
    ----------
    times : ndarray, shape (n_pulses,)
        From the start of the signal [s].
    rate : float
        Pulses in a second [1/s], 0 for fewer than two. The fades at the signal's ends do not count.
    irregularity : float
        Median magnitude of the logarithm of each interval's ratio to the one before: 0 for a clock
        even where its rate glides or a pulse is missing, 1.1 (the logarithm of 3) for a Poisson
        process. NaN for fewer than four pulses.
    glide : float
        Trend of the rate's logarithm [1/s]: 0.7 doubles the rate in a second. NaN likewise.
    crest_factor : float
        Peak of the envelope over the rms value of the signal [-]; 1.41 for a tone.
    kurtosis : float
        Of the signal's part below 7 kHz [-]: 1.5 for a tone, 3 for noise, more for pulses.
    high_kurtosis : float
        The same of the band in which pulses are sought; NaN where that holds less than a millionth
        of the power [-].
    concentration : float
        Share of that band's energy in the loudest tenth of the time, 0.1 to 1; NaN likewise.
    """

    times: NDArray[np.float64]
    rate: float
    irregularity: float
    glide: float
    crest_factor: float
    kurtosis: float
    high_kurtosis: float
    concentration: float


NO_PULSES = Pulses(np.empty(0), 0.0, *[math.nan] * 6)
"""Of a signal without content."""


def pulse_band_from(limit: float) -> float:
    """Lower limit of the band in which pulses are sought.

    Parameters
    ----------
    limit : float
        Upper limit [Hz].

    Returns
    -------
    float
        [Hz]

    Examples
    --------
    >>> pulse_band_from(7000.0), pulse_band_from(3500.0)
    (2000.0, 1000.0)
    """
    return PULSE_BAND_FROM * limit / WORKING_LIMIT


def pulses_of(
    whole: NDArray[np.complex128],
    high: NDArray[np.complex128],
    high_rate: float,
    *,
    start: float = 0.0,
) -> Pulses:
    """Find the pulses in a sound or an acceleration of which the analytic signals are at hand.

    Parameters
    ----------
    whole, high : ndarray of complex
        Analytic signal of all that counts, and of the band in which pulses are sought.
    high_rate : float
        Sampling rate of the latter [Hz].
    start : float
        Time of their first sample [s].

    Returns
    -------
    Pulses

    Examples
    --------
    >>> import numpy as np
    >>> pulses_of(np.ones(100, complex), np.ones(100, complex), 1e3).rate
    0.0
    """
    power = squared(whole)
    high_power = squared(high)
    mean = float(power.mean())
    if not mean > 0.0:
        return NO_PULSES
    crest_factor = math.sqrt(2.0 * float(power.max()) / mean)
    if float(high_power.mean()) < LEAST_HIGH_SHARE * mean:
        return replace(NO_PULSES, crest_factor=crest_factor, kurtosis=envelope_kurtosis(power))
    smooth = gaussian_filter1d(high_power, SMOOTHING * high_rate, mode="nearest", truncate=3.0)
    times = _pulse_times(smooth, high_rate)
    irregularity, glide = rhythm(times)
    tenth = max(1, smooth.size // 10)
    loudest = np.partition(smooth, -tenth)[-tenth:]
    return Pulses(
        times=start + times,
        rate=times.size / (high.size / high_rate) if times.size > 1 else 0.0,
        irregularity=irregularity,
        glide=glide,
        crest_factor=crest_factor,
        kurtosis=envelope_kurtosis(power),
        high_kurtosis=envelope_kurtosis(high_power),
        concentration=float(loudest.sum()) / float(smooth.sum()),
    )


def envelope_kurtosis(power: NDArray[np.float64]) -> float:
    """Kurtosis of a band-limited signal from its squared envelope; NaN without any.

    Half as much again as that of the envelope's square: for any signal whose phase is evenly
    spread the same as of its samples, but sampled at the band's own rate.

    Parameters
    ----------
    power : ndarray, shape (n,)
        Squared envelope [unit^2].

    Returns
    -------
    float
        [-]

    Examples
    --------
    >>> import numpy as np
    >>> envelope_kurtosis(np.ones(8))
    1.5
    """
    mean = float(power.mean())
    # Not power @ power: a long dot product wakes BLAS threads, which costs more than it saves.
    return 1.5 * float(np.mean(power**2)) / mean**2 if mean > 0.0 else math.nan


def squared(analytic: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Squared envelope of an analytic signal.

    Parameters
    ----------
    analytic : ndarray of complex, shape (n,)
        In any unit.

    Returns
    -------
    ndarray, shape (n,)
        [unit^2]

    Examples
    --------
    >>> import numpy as np
    >>> squared(np.array([3.0 + 4.0j])).tolist()
    [25.0]
    """
    return np.asarray(analytic.real**2 + analytic.imag**2)


def _pulse_times(smooth: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Find the maxima of a smoothed squared envelope; their times [s]."""
    from scipy.signal import find_peaks

    top = float(smooth.max())
    if not top > 0.0:
        return np.empty(0)
    level = 10.0 * np.log10(np.maximum(smooth / top, 1e-12))
    peaks, _ = find_peaks(level, height=-PULSE_RANGE_DB, prominence=PULSE_PROMINENCE_DB)
    return np.asarray(peaks / rate)


def rhythm(times: NDArray[np.float64]) -> tuple[float, float]:
    """Irregularity and glide of pulses, from the logarithms of their intervals.

    Parameters
    ----------
    times : ndarray, shape (n,)
        [s]

    Returns
    -------
    irregularity, glide : float
        As in `Pulses`: [-] and [1/s].
    """
    if times.size < _LEAST_PULSES:
        return math.nan, math.nan
    interval = np.log(np.diff(times))
    middle = 0.5 * (times[1:] + times[:-1])
    middle = middle - middle.mean()
    slope = float(middle @ interval / (middle @ middle))
    return float(np.median(np.abs(np.diff(interval)))), -slope
