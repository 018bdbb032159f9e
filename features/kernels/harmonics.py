"""Harmonic structure of a vibration: period, fundamental and power in the harmonics.

A friction vibration may repeat five to seven thousand times per second, and the line at its
fundamental may be the weakest of all: in stick-slip with feedback from the beams the third or
fourth harmonic of the slip frequency is the strongest (thesis, 5.2.1). So the period is that of the
autocorrelation of the signal. The signal is whitened by half (in decibels) in one-third octaves, so
that one strong resonance does not hide the period, and the autocorrelation is divided by the energy
of its overlap, so that a burst does not seem aperiodic. Among the maxima nearly as high as the
highest, the one at the shortest lag is the period. Discrete lines on its harmonics then refine it.
Harmonicity counts the power above the local noise floor, so noise on a dense grid of harmonics does
not count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft, ndimage

from features.kernels.conditioning import (
    NOTHING,
    band_signal,
    checked_signal,
    forward,
    usable_limit,
)
from features.kernels.lines import (
    MAIN_LOBE,
    PROMINENCE_DB,
    RANGE_DB,
    Lines,
    find_lines,
    line_powers,
    line_resolution,
    noise_floor,
)
from features.kernels.spectra import Spectrum, parabola_tops, welch
from models.errors import ParameterError
from models.show import short_repr

_NEARLY = 0.9
"""Height over the highest maximum from which a maximum at a shorter lag is the period."""

_PERIODS = 2.0
"""Fewest periods in a signal."""

_WHITENING = 0.5
"""Share of the level differences between one-third octaves that whitening removes."""

_SIXTH_OCTAVE = 2.0 ** (1.0 / 6.0) - 1.0

_LEAST_REACH = 20.0
"""Least half width of the whitening's average, where one-third octaves are narrower [Hz]."""

_OVERSAMPLING = 2
"""Values of an autocorrelation per lag."""

_TRACK_OVERSAMPLING = 4


class Period(NamedTuple):
    """Period of a signal.

    Parameters
    ----------
    frequency : float
        Repetition rate [Hz]; NaN if there is none.
    strength : float
        Normalised autocorrelation at the period [-]: 1 if all periods are equal, 0 if there is
        none.
    """

    frequency: float
    strength: float


_NONE = Period(math.nan, 0.0)


def strongest_period(
    x: NDArray[np.float64], rate: float, *, lowest: float, highest: float, whiten: bool = True
) -> Period:
    """Find the period of a signal.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Mean removed, in any [unit].
    rate : float
        Sampling rate [Hz].
    lowest, highest : float
        Limits of the search [Hz]. The signal must contain two periods, which may raise `lowest`.
    whiten : bool
        Whether to whiten the signal; not needed for an envelope.

    Returns
    -------
    Period

    Notes
    -----
    Normalisation: P. McLeod and G. Wyvill, A smarter way to find pitch, Proc. ICMC (2005).
    Compressing the spectrum before the autocorrelation: T. Tolonen and M. Karjalainen, IEEE Trans.
    Speech Audio Process. 8 (2000) 708-716.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(8000) / 16e3
    >>> missing = np.sin(2 * np.pi * 400 * t) + np.sin(2 * np.pi * 600 * t)
    >>> round(strongest_period(missing, 16e3, lowest=5.0, highest=7e3).frequency)
    200
    """
    n = x.size
    n_lags = min(int(n / _PERIODS), math.ceil(rate / lowest) + 1)
    length = int(fft.next_fast_len(n + n_lags, real=True))
    bins = fft.rfft(x, length)
    if whiten:
        bins *= _whitening_gain(bins.real**2 + bins.imag**2, rate / length)
        x = fft.irfft(bins, length)[:n]
    power = bins.real**2 + bins.imag**2
    correlation = fft.irfft(power, _OVERSAMPLING * length)[: _OVERSAMPLING * n_lags]
    energy = np.append(0.0, np.cumsum(x**2))
    if not energy[-1] > 0.0:
        return _NONE
    shared = 0.5 * (energy[n - n_lags :][::-1] + energy[-1] - energy[: n_lags + 1]) / energy[-1]
    if not correlation[0] > 0.0:
        return _NONE
    lags = np.arange(correlation.size) / _OVERSAMPLING
    overlap = np.interp(lags, np.arange(n_lags + 1), shared)
    normalised = correlation / (correlation[0] * np.maximum(overlap, 1e-3))
    crossing = np.flatnonzero(normalised < 0.0)
    if crossing.size == 0:
        return _NONE
    first = max(int(crossing[0]), math.floor(_OVERSAMPLING * rate / highest))
    peaks = _maxima(normalised, first)
    if peaks.size == 0:
        return _NONE
    places, heights = parabola_tops(normalised, peaks)
    highest_peak = float(heights.max())
    if not highest_peak > 0.0:
        return _NONE
    best = int(np.argmax(heights >= _NEARLY * highest_peak))
    lag = float(places[best]) / _OVERSAMPLING
    return Period(rate / lag, min(1.0, float(heights[best])))


def track_periods(
    power: NDArray[np.float64], spacing: float, *, lowest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Find the period of each of many short segments from their power spectra.

    Parameters
    ----------
    power : ndarray, shape (n_segments, n_bins)
        In any [unit^2], of Hann-windowed segments, from 0 Hz; bins to ignore are 0.
    spacing : float
        Distance between the bins [Hz].
    lowest : float
        Lower limit of the search [Hz], at least 3 times `spacing`.

    Returns
    -------
    frequency : ndarray, shape (n_segments,)
        [Hz]; NaN for a segment without a period.
    strength : ndarray, shape (n_segments,)
        Autocorrelation at the period over that of the window [-] (P. Boersma, Proc. Inst. Phonetic
        Sci. 17 (1993) 97-110).

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import segment_powers
    >>> tone = np.sin(2 * np.pi * 400 * np.arange(4096) / 16e3)
    >>> power, _ = segment_powers(tone, 1024)
    >>> track_periods(power, 16e3 / 1024, lowest=60.0)[0].round().tolist()
    [400.0, 400.0, 400.0, 400.0, 400.0, 400.0, 400.0]
    """
    length = 2 * (power.shape[1] - 1)
    correlation = fft.irfft(power, _TRACK_OVERSAMPLING * length, axis=1)
    rate = _TRACK_OVERSAMPLING * length * spacing
    n_lags = math.ceil(rate / lowest) + 2
    lags = np.arange(n_lags) / (_TRACK_OVERSAMPLING * length)
    window = (1.0 - lags) * (2.0 + np.cos(2.0 * np.pi * lags)) / 3.0
    window += np.sin(2.0 * np.pi * lags) / (2.0 * np.pi)
    energy = np.maximum(correlation[:, :1], np.finfo(float).tiny)
    normalised = correlation[:, :n_lags] / (energy * window)
    negative = normalised < 0.0
    first = np.where(negative.any(axis=1), negative.argmax(axis=1), n_lags)
    beyond = np.arange(1, n_lags - 1) >= first[:, np.newaxis]
    middle = normalised[:, 1:-1]
    rising = (middle > normalised[:, :-2]) & (middle >= normalised[:, 2:])
    heights = np.where(beyond & rising, middle, 0.0)
    top = heights.max(axis=1)
    best = np.argmax(heights >= _NEARLY * np.maximum(top, 1e-9)[:, np.newaxis], axis=1) + 1
    periodic = top > 0.0
    rows = np.arange(power.shape[0])
    left, centre, right = (normalised[rows, best + shift] for shift in (-1, 0, 1))
    curvature = np.where(periodic, left - 2.0 * centre + right, -1.0)
    curvature = np.minimum(curvature, -np.finfo(float).tiny)
    lag = best + np.where(periodic, np.clip(0.5 * (left - right) / curvature, -0.5, 0.5), 0.0)
    frequency = np.where(periodic, rate / lag, np.nan)
    return frequency, np.where(periodic, np.minimum(centre, 1.0), 0.0)


def _whitening_gain(power: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return the gain that whitens a spectrum by half in one-third octaves, and removes 0 Hz."""
    below = np.append(0.0, np.cumsum(power))
    index = np.arange(power.size)
    reach = np.maximum(index * _SIXTH_OCTAVE, _LEAST_REACH / spacing)
    start = np.maximum(index - reach, 0).astype(np.intp)
    stop = np.minimum(index + reach + 1, power.size).astype(np.intp)
    smooth = (below[stop] - below[start]) / (stop - start)
    least = max(1e-12 * float(smooth.max()), np.finfo(float).tiny)
    gain = np.asarray(np.maximum(smooth, least) ** (-0.5 * _WHITENING))
    gain[0] = 0.0
    return gain


def _maxima(values: NDArray[np.float64], first: int) -> NDArray[np.intp]:
    """Return the indices of local maxima from `first` on, without the ends."""
    first = max(first, 1)
    middle = values[first:-1]
    rising = (middle > values[first - 1 : -2]) & (middle >= values[first + 1 :])
    return np.flatnonzero(rising) + first


LOWEST = 5.0
"""Lowest fundamental [Hz]."""

HIGHEST = 8_000.0
"""Highest fundamental [Hz]."""

WEAKEST_PERIOD = 0.3
"""Autocorrelation below which a signal has no fundamental."""

_BINS_A_HARMONIC = 12.0
"""Least spacing of harmonics in bins; a line covers five."""

_RATIO_RANGE_DB = 30.0
"""Least distance of leakage below its line [dB]."""

_APART = 4.0
"""Least spacing of resolved harmonics in bins."""

_MOST = 0.5


@short_repr
@dataclass(frozen=True, eq=False)
class Harmonics:
    """Fundamental and harmonics of a vibration.

    Parameters
    ----------
    fundamental : float
        [Hz]; NaN for a signal without a period.
    strength : float
        Normalised autocorrelation at the period, 0 to 1 [-].
    harmonicity : float
        Share of the power in the harmonics above the noise floor, 0 to 1.
    count : int
        Harmonics within 30 dB of the strongest one and 10 dB above the local noise floor.
    inharmonicity : float
        Distance of a line from the nearest harmonic over half the fundamental, averaged over all
        lines by power: 0 if all are harmonics, 0.5 for random lines, 1 midway between harmonics.
        NaN without a fundamental or lines, or if harmonics are not resolved.
    """

    fundamental: float
    strength: float
    harmonicity: float
    count: int
    inharmonicity: float

    @property
    def harmonic_to_noise(self) -> float:
        """Power in the harmonics relative to all other power [dB], limited to +-30 dB.

        NaN without a fundamental; white noise masks that of a sawtooth less than 3 dB stronger.
        """
        if math.isnan(self.fundamental):
            return math.nan
        least = 10.0 ** (-0.1 * _RATIO_RANGE_DB)
        inside = max(self.harmonicity, least)
        return 10.0 * math.log10(inside / max(1.0 - self.harmonicity, least * inside))


def analyse_harmonics(signal: ArrayLike, rate: float) -> Harmonics:
    """Find the fundamental of a vibration, its harmonics and all discrete lines.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Samples in any unit; the mean is removed.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    Harmonics
        The fundamental lies between 5 Hz, or two periods per signal, and 8 kHz, or 0.4375 times the
        rate.

    Raises
    ------
    ParameterError
        The signal or its rate cannot be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(16000) / 16e3
    >>> sawtooth = (155.0 * t) % 1.0
    >>> harmonics = analyse_harmonics(sawtooth, 16e3)
    >>> round(harmonics.fundamental, 1), harmonics.count > 20, round(harmonics.harmonicity, 2)
    (155.0, True, 0.99)
    """
    x = checked_signal(signal, rate)
    highest = min(HIGHEST, usable_limit(rate))
    if highest <= LOWEST:
        raise ParameterError(f"rate is {rate:g} Hz, which holds no fundamental above {LOWEST:g} Hz")
    mean = float(x.mean())
    x = x - mean
    if float(np.abs(x).max()) <= NOTHING * abs(mean):
        x = np.zeros_like(x)
    x, rate = band_signal(forward(x, rate), LOWEST, usable_limit(rate))
    spectrum = welch(x, rate, line_resolution(x.size / rate))
    floor = noise_floor(spectrum)
    lines = find_lines(spectrum, low=LOWEST, high=usable_limit(rate), floor=floor)
    return harmonics_of(x, spectrum, floor, lines, highest=highest)


def harmonics_of(
    x: NDArray[np.float64],
    spectrum: Spectrum,
    floor: NDArray[np.float64],
    lines: Lines,
    *,
    highest: float,
) -> Harmonics:
    """Find the harmonics of a signal from its spectrum and lines, like `analyse_harmonics`.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Mean removed [unit].
    spectrum : Spectrum
        Spectrum of `x`.
    floor : ndarray, shape (n_bins,)
        `noise_floor` of the spectrum [unit^2/Hz].
    lines : Lines
        Lines of the spectrum; shares refer to their band.
    highest : float
        Upper limit of the fundamental [Hz].

    Returns
    -------
    Harmonics

    Examples
    --------
    >>> import numpy as np
    >>> x = np.sin(2 * np.pi * 500 * np.arange(8000) / 16e3)
    >>> spectrum = welch(x, 16e3, 4.0)
    >>> lines = find_lines(spectrum, low=5.0, high=7e3)
    >>> tone = harmonics_of(x, spectrum, noise_floor(spectrum), lines, highest=7e3)
    >>> round(tone.fundamental, 1), tone.count
    (500.0, 1)
    """
    rate = spectrum.rate
    period = strongest_period(x, rate, lowest=LOWEST, highest=highest)
    if lines.total <= 0.0 or period.strength < WEAKEST_PERIOD:
        return Harmonics(math.nan, period.strength, 0.0, 0, math.nan)
    refined = lines
    wanted = period.frequency / _BINS_A_HARMONIC
    if spectrum.spacing > 1.01 * wanted and x.size / rate > 1.01 / spectrum.spacing:
        spectrum = welch(x, rate, wanted)
        floor = noise_floor(spectrum)
        refined = find_lines(spectrum, low=LOWEST, high=usable_limit(rate), floor=floor)
    fundamental = _refined(period, refined)
    number = np.arange(1, max(1, math.floor(usable_limit(rate) / fundamental)) + 1)
    frequency = np.asarray(number * fundamental, dtype=np.float64)
    excess = line_powers(spectrum, floor, frequency, spacing=0.5 * fundamental)
    power = np.maximum(excess, 0.0)
    least = 10.0 ** (-0.1 * RANGE_DB) * float(power.max())
    nearby = ndimage.maximum_filter1d(spectrum.density / floor, 2 * round(MAIN_LOBE) + 1)
    bins = np.minimum(np.rint(frequency / spectrum.spacing).astype(np.intp), nearby.size - 1)
    standing = nearby[bins] >= 10.0 ** (0.1 * PROMINENCE_DB)
    count = int(np.count_nonzero(standing & (power > 0.0) & (power >= least)))
    harmonicity = min(1.0, max(0.0, float(excess.sum()) / lines.total))
    resolved = fundamental >= _APART * spectrum.spacing
    inharmonicity = _inharmonicity(fundamental, refined) if resolved else math.nan
    return Harmonics(fundamental, period.strength, harmonicity, count, inharmonicity)


def _inharmonicity(fundamental: float, lines: Lines) -> float:
    """Return the inharmonicity of lines; see `Harmonics`.

    G. Peeters, A large set of audio features for sound description, CUIDADO report, IRCAM (2004).
    The B of a stiff string, f_n = n f_0 sqrt(1 + B n^2), does not apply to friction, whose
    inharmonic lines are not stretched evenly but lie at the structure's modes.
    """
    order = lines.frequency / fundamental
    off = np.abs(order - np.maximum(np.rint(order), 1.0))
    power = float(lines.power.sum())
    return min(1.0, 2.0 * float((lines.power * off).sum()) / power) if power > 0.0 else math.nan


def _refined(period: Period, lines: Lines) -> float:
    """Return the least-squares fundamental of the lines on harmonics, weighted by amplitude.

    If all of them are multiples of a higher frequency and have most of the power, that frequency is
    the fundamental: the autocorrelation is coarse where a period has few samples.
    """
    fundamental = period.frequency
    for highest_number in (4, 16, 64):
        number = np.rint(lines.frequency / fundamental)
        off = np.abs(lines.frequency - number * fundamental)
        on = (number >= 1) & (number <= highest_number) & (off < 0.1 * fundamental)
        if on.any():
            weight = np.sqrt(lines.power[on]) * number[on]
            fundamental = float(weight @ lines.frequency[on] / (weight @ number[on]))
    number = np.rint(lines.frequency / fundamental).astype(np.intp)
    on = (number >= 1) & (np.abs(lines.frequency - number * fundamental) < 0.1 * fundamental)
    if on.any() and float(lines.power[on].sum()) > _MOST * lines.total:
        fundamental *= int(np.gcd.reduce(number[on]))
    return fundamental


_HOP = 0.01
"""Time between estimates [s]."""


def pitch_track(
    signal: ArrayLike, rate: float, *, lowest: float = 60.0, highest: float = 3000.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
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
    time : ndarray, shape (n,)
        One every 10 ms [s].
    frequency : ndarray, shape (n,)
        [Hz]; NaN where there is no pitch.

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
    >>> at, frequency = pitch_track(np.sin(2 * np.pi * (200 * time + 100 * time**2)), 16e3)
    >>> inside = (at > 0.15) & (at < 0.85)
    >>> bool(np.all(abs(frequency[inside] / (200 + 200 * at[inside]) - 1) < 0.03))
    True
    """
    import librosa

    x = checked_signal(signal, rate)
    hop = max(1, round(_HOP * rate))
    frame = 2 ** int(np.ceil(np.log2(4.0 * rate / lowest)))
    if not np.ptp(x) > 0.0 or usable_limit(rate) <= lowest:
        time = np.arange(1 + x.size // hop) * hop / rate
        return time, np.full(time.size, np.nan)
    frequency, _, _ = librosa.pyin(
        x,
        fmin=lowest,
        fmax=min(highest, usable_limit(rate)),
        sr=rate,
        frame_length=frame,
        hop_length=hop,
    )
    return np.arange(frequency.size) * hop / rate, np.asarray(frequency, dtype=float)
