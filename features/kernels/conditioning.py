"""Bands of a signal at their own rates, from one Fourier transform of the whole signal.

Recordings have rates from 16 to 96 kHz, and features of a noise must not depend on them. So the
features of its shape in frequency or time are computed from the part below `WORKING_LIMIT`,
resampled to `WORKING_RATE`; higher frequencies have features of their own. Masking bins of one
transform and transforming back to a sufficient length filters and resamples at once. A block cut
from a longer recording does not end where it began: it is faded in and out over 20 ms before the
transform, so that the cut does not click, and the fades are removed from every band. Reflections at
the ends are no alternative: a mirrored tone gets a kink, and noise reflected about its last sample
gets a step; both are louder than a quiet band.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from models.errors import ParameterError

WORKING_RATE = 16_000.0
"""Sampling rate of features that must not depend on the recording's rate [Hz]."""

ACOUSTIC_FROM = 150.0
"""Lower limit of the features of sound and acceleration [Hz], above hum and rumble."""

WORKING_LIMIT = 7_000.0
"""Upper limit of the features [Hz], which a rate of 16 kHz covers with a clean edge."""

USABLE_SHARE = WORKING_LIMIT / WORKING_RATE
"""Share of a sampling rate up to which its content is usable."""

NOTHING = 1e-9
"""Relative variation about the mean below which a signal is constant to rounding."""

_FADE = 0.02
"""Length of the fades, which are cut off again [s]; a hum leaks 60 dB less above 150 Hz ..."""

_FADE_SHARE = 0.1
"""... but at most this share of the signal each."""

_EDGE = 0.2
"""Width of the flank below a band, as a share of the band's lower limit."""

MIN_SAMPLES = 16
"""Fewest samples of a signal."""


@dataclass(frozen=True, eq=False)
class Transform:
    """Fourier transform of a signal, faded at its ends.

    Parameters
    ----------
    bins : ndarray of complex, shape (length // 2 + 1,)
        Scaled as by `scipy.fft.rfft`.
    length : int
        Length of the transform, including zeros at the end.
    lead : int
        Samples of the fade at the start.
    n_samples : int
        Samples between the fades.
    rate : float
        Sampling rate of the signal [Hz].
    """

    bins: NDArray[np.complex128]
    length: int
    lead: int
    n_samples: int
    rate: float


def usable_limit(rate: float) -> float:
    """Return the highest usable frequency of a sampling rate.

    Parameters
    ----------
    rate : float
        [Hz]

    Returns
    -------
    float
        [Hz]

    Examples
    --------
    >>> usable_limit(16e3), usable_limit(48e3)
    (7000.0, 21000.0)
    """
    return USABLE_SHARE * rate


def checked_signal(signal: ArrayLike, rate: float, first: int = 0) -> NDArray[np.float64]:
    """Return a signal as an array of floats, or raise if it cannot be analysed.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        One channel, in any unit.
    rate : float
        Sampling rate [Hz].
    first : int
        Index of the first sample in its recording, for messages.

    Returns
    -------
    ndarray, shape (n_samples,)
        In the signal's [unit].

    Raises
    ------
    ParameterError
        The signal is not one-dimensional, shorter than 16 samples or not finite, or the rate is not
        positive.

    Examples
    --------
    >>> checked_signal([1.0] * 5, 48e3)
    Traceback (most recent call last):
    models.errors.ParameterError: signal has 5 samples; an analysis needs at least 16
    """
    x = np.asarray(signal, dtype=np.float64)
    if x.ndim != 1:
        raise ParameterError(f"signal has shape {x.shape}; give one channel, shape (n_samples,)")
    if x.size < MIN_SAMPLES:
        raise ParameterError(
            f"signal has {x.size} samples; an analysis needs at least {MIN_SAMPLES}"
        )
    if not np.isfinite(x).all():
        bad = int(np.flatnonzero(~np.isfinite(x))[0])
        raise ParameterError(
            f"signal: sample {first + bad} is {x[bad]}; all samples must be finite"
        )
    if not (math.isfinite(rate) and rate > 0):
        raise ParameterError(f"rate is {rate}; a sampling rate is a positive number of hertz")
    return x


def forward(signal: NDArray[np.float64], rate: float) -> Transform:
    """Return the transform of a signal faded in and out over 20 ms, or a tenth of its length.

    Parameters
    ----------
    signal : ndarray, shape (n_samples,)
        Mean removed, in any [unit].
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    Transform

    Examples
    --------
    >>> import numpy as np
    >>> forward(np.zeros(4800), 48e3).n_samples
    3840
    """
    n = signal.size
    lead = min(int(_FADE_SHARE * n), round(_FADE * rate))
    fade = np.sin(0.5 * np.pi * (np.arange(lead) + 0.5) / lead) ** 2
    length = int(fft.next_fast_len(n, real=True))
    x = np.zeros(length)
    x[:n] = signal
    x[:lead] *= fade
    x[n - lead : n] *= fade[::-1]
    return Transform(fft.rfft(x), length, lead, n - 2 * lead, rate)


def band_signal(transform: Transform, low: float, high: float) -> tuple[NDArray[np.float64], float]:
    """Return a band of a signal at the lowest rate that contains it cleanly.

    Parameters
    ----------
    transform : Transform
    low, high : float
        Limits of the band [Hz]; with `low` 0 everything below `high`. The flanks outside them are
        raised cosines, 20 % wide below and 14 % above.

    Returns
    -------
    samples : ndarray, shape (n,)
        In the signal's [unit].
    rate : float
        [Hz]; `high` over `USABLE_SHARE`, rounded to whole samples, at most the rate of the signal.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4800) / 48e3
    >>> tones = np.sin(2 * np.pi * 1000 * t) + np.sin(2 * np.pi * 9000 * t)
    >>> below, rate = band_signal(forward(tones, 48e3), 0.0, 7000.0)
    >>> round(rate), round(float(np.mean(below**2)), 2)
    (16000, 0.5)
    """
    length = 2 * round(0.5 * transform.length * min(1.0, high / usable_limit(transform.rate)))
    bins = np.zeros(length // 2 + 1, dtype=np.complex128)
    first, mask = _mask(transform, low, high, bins.size)
    bins[first : first + mask.size] = transform.bins[first : first + mask.size] * mask
    ratio = length / transform.length
    samples = fft.irfft(bins, length) * ratio
    return samples[_interior(transform, ratio)], transform.rate * ratio


def band_analytic(
    transform: Transform, low: float, high: float
) -> tuple[NDArray[np.complex128], float]:
    """Return the analytic signal of a band at zero frequency; its magnitude is the envelope.

    Parameters
    ----------
    transform : Transform
    low, high : float
        Limits of the band [Hz], flanks as in `band_signal`.

    Returns
    -------
    analytic : ndarray of complex, shape (n,)
        In the signal's unit; the magnitude of a sinusoid in the band is its amplitude.
    rate : float
        [Hz]; about 1.25 times the band's width with its flanks.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4800) / 48e3
    >>> tone, _ = band_analytic(forward(3 * np.sin(2 * np.pi * 4000 * t), 48e3), 2e3, 7e3)
    >>> round(float(np.median(abs(tone))), 2)
    3.0
    """
    first, mask = _mask(transform, low, high, transform.bins.size)
    length = int(fft.next_fast_len(round(1.25 * mask.size) + 8))
    bins = np.zeros(length, dtype=np.complex128)
    bins[: mask.size] = transform.bins[first : first + mask.size] * mask
    ratio = length / transform.length
    samples = fft.ifft(bins) * (2.0 * ratio)
    return samples[_interior(transform, ratio)], transform.rate * ratio


def _mask(
    transform: Transform, low: float, high: float, n_bins: int
) -> tuple[int, NDArray[np.float64]]:
    """Return the first bin of a band with its flanks, and its gain from there on."""
    spacing = transform.rate / transform.length
    above = min(high * 0.5 / USABLE_SHARE, 0.5 * transform.rate)
    first = math.ceil((1.0 - _EDGE) * low / spacing)
    last = min(math.floor(above / spacing), n_bins - 1)
    mask = np.ones(last + 1 - first)
    full = min(math.ceil(low / spacing), last)
    if full > first:
        rising = (np.arange(first, full) * spacing / low - (1.0 - _EDGE)) / _EDGE
        mask[: full - first] = np.sin(0.5 * np.pi * rising) ** 2
    full = max(math.floor(high / spacing), first)
    if full < last:
        falling = (above - np.arange(full + 1, last + 1) * spacing) / (above - high)
        mask[full + 1 - first :] *= np.sin(0.5 * np.pi * falling) ** 2
    return first, mask


def _interior(transform: Transform, ratio: float) -> slice:
    """Return the slice of the signal without fades among the samples of a band."""
    start = round(transform.lead * ratio)
    return slice(start, start + max(1, round(transform.n_samples * ratio)))
