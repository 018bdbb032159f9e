"""Numbers of a channel: distribution, noise floor, hum, and deviation from the predicted channel.

Clipping, offset, hum and noise floor need no model, since a sensor fault shows in its own signal.

Acceleration and sound are predicted from the measured torque with the transfer functions of the
rig file, so that the behaviour of the contact cancels. Gain, delay and coherence by band follow,
and spectrum, timing and decay of the residual.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from features.kernels.spectra import segment_spectra
from noise.base.arrays import Array

BAND_EDGES = np.array([
    30.0, 60.0, 120.0, 180.0, 260.0, 350.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 2800.0, 4000.0,
    5600.0, 8000.0, 10000.0,
])  # fmt: skip
"""[Hz]; band 1 lies between the first two."""

USABLE = 0.42
"""Highest usable frequency over the sampling rate [-]; anti-alias filters fade above; assumed."""


def band_levels(x: Array, rate: float) -> dict[str, float]:
    """Return the level of a signal in each band.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of amplitudes in the channel's unit.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(30_000) / 30e3)
    >>> levels = band_levels(tone, 30e3)
    >>> max(levels, key=levels.get)  # from 350 to 500 Hz
    'band_6'
    """
    spectra = segment_spectra(x, segment_frequency(rate)[0])
    numbers, first, last = band_bins(rate)
    power = band_sums(powers(spectra).mean(axis=0), first, last) / (last - first)
    return {
        f"band_{i}": level
        for i, level in zip(numbers, (0.5 * np.log(power + 1e-14)).tolist(), strict=True)
    }


@lru_cache(maxsize=8)
def segment_frequency(rate: float) -> tuple[int, Array]:
    """Return the segment length for band levels, and the frequency of each bin.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    length : int
        Samples of a segment.
    frequency : ndarray, shape (length // 2 + 1,)
        [Hz]

    Examples
    --------
    >>> segment_frequency(30e3)[0], segment_frequency(48e3)[0]
    (2048, 4096)
    """
    length = 2048 if rate < 40e3 else 4096
    return length, np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)


def powers(spectra: NDArray[np.complex128]) -> Array:
    """Return the power of each line of spectra.

    Parameters
    ----------
    spectra : ndarray of complex, shape (...)
        [any unit]

    Returns
    -------
    ndarray, shape (...)
        [unit^2]

    Examples
    --------
    >>> powers(np.array([3.0 + 4.0j]))
    array([25.])
    """
    return np.asarray(spectra.real**2 + spectra.imag**2)


def band_sums(values: Array, first: NDArray[np.int64], last: NDArray[np.int64]) -> Array:
    """Sum the last axis over bands.

    Parameters
    ----------
    values : ndarray, shape (..., n_bins)
        [any unit]
    first, last : ndarray of int, shape (n_bands,)
        First bin of each band, and the bin after its last.

    Returns
    -------
    ndarray, shape (..., n_bands)
        [unit of the values]

    Examples
    --------
    >>> band_sums(np.arange(5.0), np.array([0, 2]), np.array([2, 5]))
    array([1., 9.])
    """
    return np.stack(
        [values[..., a:b].sum(axis=-1) for a, b in zip(first, last, strict=True)], axis=-1
    )


@lru_cache(maxsize=8)
def band_bins(rate: float) -> tuple[tuple[int, ...], NDArray[np.int64], NDArray[np.int64]]:
    """Return the bins of each band below the usable frequency.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    numbers : tuple of int
        Numbers of the bands, from 1.
    first, last : ndarray of int, shape (n_bands,)
        First bin of each band, as of `segment_frequency`, and the bin after its last.

    Examples
    --------
    >>> band_bins(10e3)[0][-1]
    12
    """
    edges = np.searchsorted(segment_frequency(rate)[1], BAND_EDGES)
    reached = (BAND_EDGES[1:] < USABLE * rate) & (np.diff(edges) > 0)
    numbers = tuple((np.flatnonzero(reached) + 1).tolist())
    return numbers, edges[:-1][reached], edges[1:][reached]


def bins_between(frequency: Array, band: tuple[float, float]) -> slice:
    """Return the bins between two frequencies.

    Parameters
    ----------
    frequency : ndarray, shape (n_bins,)
        Rising [Hz].
    band : tuple of float
        Lower and upper frequency, exclusive [Hz].

    Returns
    -------
    slice

    Examples
    --------
    >>> bins_between(np.array([0.0, 10.0, 20.0, 30.0]), (5.0, 30.0))
    slice(1, 3, None)
    """
    first = int(np.searchsorted(frequency, band[0], "right"))
    return slice(first, max(first, int(np.searchsorted(frequency, band[1]))))


Numbers = dict[str, float]

_FLOOR_BANDS = ((100.0, 700.0), (700.0, 2500.0), (2500.0, 6000.0), (6000.0, 10000.0))
"""[Hz]"""

_FLOOR_LENGTH = 1024
"""Length of the segments for the noise floor [samples]; assumed."""

_QUIET = 0.1
"""Quantile of the power over segments that is the noise floor [-]; assumed."""

_MAINS = (50, 60)
"""[Hz]"""

_HUM_RATE = 4e3
"""Least sampling rate of the signal in which mains harmonics are searched [Hz]."""


def channel_summary(x: Array, rate: float) -> Numbers:
    """Summarise a signal's distribution and its noise floor.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        [-], but ``floor_*``: logarithms of amplitudes in the channel's unit.

    Examples
    --------
    >>> sound = np.sin(2 * np.pi * 440 * np.arange(30_000) / 30e3)
    >>> clipped = channel_summary(np.clip(sound, -0.5, 0.5), 30e3)
    >>> clipped["top"] > channel_summary(sound, 30e3)["top"]
    True
    """
    top, bottom, mean = float(x.max()), float(x.min()), float(x.mean())
    median = float(quantile(x, 0.5))
    away, span = x - mean, top - bottom + 1e-12
    spread = math.sqrt(float(away @ away) / x.size) + 1e-12
    numbers = {
        "top": _log_share(x > top - 0.02 * span),
        "bottom": _log_share(x < bottom + 0.02 * span),
        "crest": math.log(max(top - mean, mean - bottom, 1e-12) / spread),
        "asymmetry": math.log((top - median + 1e-12) / (median - bottom + 1e-12)),
        "skewness": float(np.mean(away**3)) / spread**3,
        "flat": _log_share(np.abs(np.diff(x)) < 1e-3 * span),
        "dwell_top": _dwell(x > top - 0.05 * span),
        "dwell_bottom": _dwell(x < bottom + 0.05 * span),
        "offset": mean / spread,
    }
    spectra = segment_spectra(x, _FLOOR_LENGTH)
    inside, *bands = _floor_bins(rate)
    quiet = quantile(powers(spectra[:, inside]), _QUIET)
    for i, band in enumerate(bands):
        numbers[f"floor_{i}"] = 0.5 * math.log(float(quiet[band].mean()) + 1e-16)
    return numbers


@lru_cache(maxsize=8)
def _floor_bins(rate: float) -> tuple[slice, ...]:
    """Bins from the lowest to the highest floor, and which of them lie in each."""
    frequency = np.asarray(np.fft.rfftfreq(_FLOOR_LENGTH, 1.0 / rate), np.float64)
    whole = bins_between(frequency, (_FLOOR_BANDS[0][0], _FLOOR_BANDS[-1][1]))
    return whole, *(bins_between(frequency[whole], band) for band in _FLOOR_BANDS)


def hum_summary(x: Array, rate: float) -> Numbers:
    """Return the power of mains harmonics over that of neighbouring lines.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of power ratios [-]; ``hum_level`` is that of an amplitude in the channel's unit.

    Examples
    --------
    >>> hum = 0.01 * np.sin(2 * np.pi * 50 * np.arange(30_000) / 30e3)
    >>> hum = hum_summary(hum + np.random.default_rng(0).normal(size=30_000), 30e3)
    >>> hum["hum_50"] > hum["hum_60"]
    True
    """
    # Harmonics lie in the lowest bins; the power of others is not needed.
    every = max(1, int(rate / _HUM_RATE))
    slow = _thinned(x, every)
    n = slow.size
    lines, first, last = _hum_lines(rate / every / n)
    power = powers(rfft(_detrended(slow) * np.hanning(n))[: int(lines.max()) + 13])
    best = first + int(np.argmax(power[first : last + 1]))
    logarithms = np.log([_line_ratio(power, line) for line in [*lines.tolist(), best]])
    numbers: Numbers = {}
    for mains, of_mains in zip(_MAINS, logarithms[:-1].reshape(len(_MAINS), -1), strict=True):
        numbers[f"hum_{mains}"] = float(of_mains[0])
        numbers[f"hum_odd_{mains}"] = float(of_mains[2::2].mean())
        numbers[f"hum_even_{mains}"] = float(of_mains[1::2].mean())
    numbers["hum_best"] = float(logarithms[-1])
    numbers["hum_level"] = 0.5 * math.log(16.0 * float(power[best]) / n**2 + 1e-14)
    return numbers


def _thinned(x: Array, every: int) -> Array:
    """Reduce the sampling rate by averages over triangles that overlap by half."""
    blocks = x[: x.size // every * every].reshape(-1, every)
    rise = (np.arange(every) + 0.5) / every**2
    return np.asarray((blocks @ rise)[:-1] + (blocks @ rise[::-1])[1:])


def _detrended(x: Array) -> Array:
    away = np.arange(x.size) - 0.5 * (x.size - 1)
    centred = x - x.mean()
    return np.asarray(centred - away * float(away @ centred) / max(float(away @ away), 1e-300))


def _line_ratio(power: Array, line: int) -> float:
    """Return the power of a line over the median power 5 to 12 bins beside it [-].

    The largest of five bins counts. The ratio is 1 where the spectrum ends before.
    """
    if line + 13 > power.size:
        return 1.0
    below = power[max(line - 12, 1) : max(line - 4, 1)]
    beside = np.concatenate([below, power[line + 5 : line + 13]])
    most = float(power[max(line - 2, 0) : line + 3].max())
    return (most + 1e-30) / (float(quantile(beside, 0.5)) + 1e-30)


@lru_cache(maxsize=16)
def _hum_lines(spacing: float) -> tuple[NDArray[np.int64], int, int]:
    """Return the bins of the mains harmonics, and the first and last bin of the fundamental."""
    lines = [round(k * mains / spacing) for mains in _MAINS for k in range(1, 8)]
    return np.array(lines), math.ceil(44.0 / spacing), math.floor(66.0 / spacing)


def _log_share(those: NDArray[np.bool_]) -> float:
    return math.log(np.count_nonzero(those) / max(those.size, 1) + 1e-4)


def _dwell(there: NDArray[np.bool_]) -> float:
    """Return the logarithm of the mean length of a stay in samples [-]."""
    entries = int(np.count_nonzero(there[1:] & ~there[:-1]))
    return math.log(max(int(np.count_nonzero(there)), 1) / max(entries, 1))


def quantile(x: Array, share: float) -> Array:
    """Return a quantile along the first axis, as `numpy.quantile` without its checks.

    Parameters
    ----------
    x : ndarray, shape (n, ...)
        [any unit], no NaN.
    share : float
        From 0 to 1 [-].

    Returns
    -------
    ndarray, shape (...)
        Linear between values [unit of the values].

    Examples
    --------
    >>> float(quantile(np.array([3.0, 1.0, 2.0, 9.0]), 0.5))
    2.5
    """
    place = share * (len(x) - 1)
    low = int(place)
    high = min(low + 1, len(x) - 1)
    parted = np.partition(x, (low, high), axis=0)
    return np.asarray(parted[low] + (place - low) * (parted[high] - parted[low]))


_LEAD, _TAIL = 0.08, 0.01
"""Lengths left out at the start, where earlier vibration still decays, and at the end [s];
assumed."""

_LONGEST_DELAY = 2.5e-3
_COARSE, _FINE = 4, 16
"""Resolution of the delay: steps per sample, first coarse, then fine."""

_REFERENCE_BAND = (80.0, 6000.0)
"""Band of the broadband gain and delay [Hz]; assumed."""

_ECHO = (6e-4, 2e-2)
"""Range of delays of echoes after the direct sound [s]; assumed."""

_SHORT = 256
"""Length of the segments that separate impacts from continuous sound [samples]; assumed."""

_LOW, _HIGHEST = (-1.0, 2500.0), 12e3
"""Low band of short segments, and upper limit of the high band above it [Hz]; assumed."""

_CROSS_BANDS = ((100.0, 600.0), (600.0, 2000.0), (2000.0, 6000.0))


def path_summary(
    predicted: Array, measured: Array, rate: float, slips: Array
) -> tuple[Numbers, Array]:
    """Compare a channel with its prediction from the measured torque.

    Parameters
    ----------
    predicted, measured : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].
    slips : ndarray, shape (n_slips,)
        Times at which the contact begins to slip [s].

    Returns
    -------
    numbers : dict of str to float
        By name, with the number of the band where there is one: ratios and coherences as logarithms
        [-], ``delay`` in microseconds, ``*_at`` as logarithms of seconds or hertz. Empty for a
        recording that is shorter than a segment.
    residual : ndarray, shape (n_kept,)
        Measured less predicted, without its ends [unit of the channel].

    Examples
    --------
    >>> sound = np.random.default_rng(0).normal(size=30_000)
    >>> numbers, residual = path_summary(sound, 2.0 * sound, 30e3, np.empty(0))
    >>> round(math.exp(numbers["gain"]), 3), residual.size
    (2.0, 27300)
    """
    ends = slice(int(_LEAD * rate), predicted.size - int(_TAIL * rate))
    p, m = predicted[ends], measured[ends]
    residual = m - p
    size = segment_frequency(rate)[0]
    if p.size < size:
        return {}, residual
    of_p, of_m = segment_spectra(p, size), segment_spectra(m, size)
    pp, mm, left = (powers(x).mean(axis=0) for x in (of_p, of_m, of_m - of_p))
    pm = (of_p.conj() * of_m).mean(axis=0)
    numbers = _by_band(pp, mm, pm, left, rate)
    numbers |= _transfer(size, pp, mm, pm, rate)
    numbers |= _by_time(p, m, residual)
    numbers |= _impacts(residual, rate, slips - ends.start / rate)
    return numbers, residual


def common_residual(one: Array, other: Array, rate: float) -> Numbers:
    """Return the coherence of the residuals of two channels by band.

    Parameters
    ----------
    one, other : ndarray, shape (n,)
        Residuals as `path_summary` returns them, each in its unit.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of coherences [-]; empty for residuals that are shorter than a segment.

    Examples
    --------
    >>> one, other = np.random.default_rng(0).normal(size=(2, 30_000))
    >>> common_residual(one, one, 30e3)["common_0"] > common_residual(one, other, 30e3)["common_0"]
    True
    """
    size = 2048
    if one.size < size:
        return {}
    x, y = segment_spectra(one, size), segment_spectra(other, size)
    shared = powers((x.conj() * y).mean(axis=0))
    coherence = shared / (powers(x).mean(axis=0) * powers(y).mean(axis=0) + 1e-30)
    return {
        f"common_{i}": math.log(float(coherence[inside].mean()) + 1e-9)
        for i, band in enumerate(_CROSS_BANDS)
        if (inside := _bins(band, size, rate)).start < inside.stop
    }


@lru_cache(maxsize=32)
def _bins(band: tuple[float, float], length: int, rate: float) -> slice:
    """Return the bins of a spectrum of `length` samples between two frequencies [Hz]."""
    return bins_between(np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64), band)


def _by_band(pp: Array, mm: Array, pm: NDArray[np.complex128], left: Array, rate: float) -> Numbers:
    coherent = np.abs(pm) ** 2 / (pp * mm + 1e-30) * mm
    band_numbers, first, last = band_bins(rate)
    rows = np.stack([pp, mm, coherent, left, pm.real, pm.imag])[:, : last[-1]]
    sums = np.add.reduceat(rows, first, axis=1).T  # each band begins where one ends
    numbers: Numbers = {}
    for i, n, (a, c, shared, wrong, real, imaginary) in zip(
        band_numbers, (last - first).tolist(), sums.tolist(), strict=True
    ):
        a, c = a + 1e-30, c + 1e-30
        share = min(shared / c, 0.99999)
        numbers[f"gain_{i}"] = 0.5 * math.log(c / a)
        numbers[f"incoherent_{i}"] = math.log(1.0 - share + 1e-5)
        numbers[f"transfer_{i}"] = math.log(1e-4 + abs(complex(real, imaginary) / a - 1.0))
        numbers[f"left_{i}"] = 0.5 * math.log(wrong / c + 1e-9)
        numbers[f"excess_{i}"] = 0.5 * math.log(wrong / n + 1e-14)
        numbers[f"level_{i}"] = 0.5 * math.log((c - 1e-30) / n + 1e-14)
    return numbers


def _transfer(size: int, pp: Array, mm: Array, pm: NDArray[np.complex128], rate: float) -> Numbers:
    """Return gain, tilt, delay and decay of the transfer function from predicted to measured."""
    inside, n_bins = _bins(_REFERENCE_BAND, size, rate), size // 2 + 1
    octaves, taper = _weights(size, rate)
    h = pm[inside] / np.maximum(pp[inside], 1e-30)
    coherence = np.abs(pm[inside]) ** 2 / (pp[inside] * mm[inside] + 1e-30)
    weight = coherence / np.maximum(1.0 - coherence, 1e-3)
    total = float(weight.sum()) + 1e-12
    absolute = np.abs(h)
    magnitude = np.log(np.maximum(absolute, 1e-6))
    gain = float((weight * magnitude).sum()) / total
    phases = np.zeros(n_bins, complex)
    phases[inside] = weight * h / np.maximum(absolute, 1e-30)
    delay, match = _strongest(phases, inside, int(_LONGEST_DELAY * rate))
    impulse = np.zeros(n_bins, complex)
    impulse[inside] = h * np.sqrt(weight / (weight.max() + 1e-30)) * taper
    answer = irfft(impulse)
    energy = answer**2
    whole = float(energy.sum()) + 1e-30

    def between(start: float, end: float) -> float:
        return math.log(float(energy[int(start * rate) : int(end * rate)].sum()) / whole + 1e-6)

    return {
        "gain": gain,
        "gain_spread": math.sqrt(float((weight * (magnitude - gain) ** 2).sum()) / total),
        "tilt": float((weight * octaves * magnitude).sum())
        / max(float((weight * octaves**2).sum()), 1e-12),
        "delay": 1e6 * delay / rate,
        "phase_match": match / total,
        "ring_early": between(6e-4, 2e-3),
        "ring_middle": between(2e-3, 6e-3),
        "ring_late": between(6e-3, 20e-3),
        "ring_before": math.log(float(energy[-int(0.02 * rate) :].sum()) / whole + 1e-6),
    } | _echo(answer, rate)


def _strongest(spectrum: NDArray[np.complex128], inside: slice, most: int) -> tuple[float, float]:
    """Find the lag at which the transform of a one-sided spectrum is largest, up to `most` samples.

    Returns
    -------
    place, value : float
        To `_FINE` parts of a sample [-]; real part of the sum [unit of the spectrum].
    """
    size, reach = 2 * (spectrum.size - 1), _COARSE * most
    coarse = irfft(spectrum, _COARSE * size)
    about = int(np.argmax(np.concatenate([coarse[-reach:], coarse[: reach + 1]]))) - reach
    place = about / _COARSE
    turn = np.exp(2j * np.pi / size * place * np.arange(inside.start, inside.stop))
    fine = ((spectrum[inside] * turn) @ _turns(size, inside.start, inside.stop)).real
    best = int(np.argmax(fine))
    return place + (best - fine.size // 2) / _FINE, float(fine[best])


@lru_cache(maxsize=8)
def _turns(size: int, first: int, last: int) -> NDArray[np.complex128]:
    """Return the phase factors of the lines for the fine steps about a coarse one."""
    around = _FINE // _COARSE
    parts = np.arange(-around, around + 1) / _FINE
    return np.asarray(np.exp(2j * np.pi / size * np.outer(np.arange(first, last), parts)))


@lru_cache(maxsize=8)
def _weights(size: int, rate: float) -> tuple[Array, Array]:
    """Return the octaves from 700 Hz [-] and a taper [-] over the reference band."""
    frequency = np.fft.rfftfreq(size, 1.0 / rate)[_bins(_REFERENCE_BAND, size, rate)]
    return np.log2(frequency / 700.0), np.hanning(frequency.size) ** 0.25


def _echo(answer: Array, rate: float) -> Numbers:
    """Describe the late part of an impulse response: single echoes, and ringing at a frequency."""
    first = int(_ECHO[0] * rate)
    late = answer[first : int(_ECHO[1] * rate)]
    size = np.abs(late)
    most = int(np.argmax(size))
    power = np.abs(rfft(late)) ** 2
    line = int(np.argmax(power))
    return {
        "echo_crest": math.log(float(size[most]) / (float(late.std()) + 1e-30) + 1e-9),
        "echo_kurtosis": math.log(_kurtosis(late)),
        "echo_at": math.log((first + most) / rate),
        "echo_most": float(late[most]) / (float(np.abs(answer).max()) + 1e-30),
        "ring_line": float(power[line] / (power.sum() + 1e-30)),
        "ring_line_at": math.log(max(line, 1) * rate / late.size),
    }


def _by_time(p: Array, m: Array, residual: Array) -> Numbers:
    """Return the size of the residual, and its kurtosis."""
    return {
        "residual": math.log(float(residual.std()) / (float(m.std()) + 1e-12) + 1e-9),
        "residual_kurtosis": math.log(_kurtosis(residual)),
        "kurtosis": math.log(_kurtosis(m) / _kurtosis(p)),
    }


def _impacts(residual: Array, rate: float, slips: Array) -> Numbers:
    """Return levels of the residual in short segments above and below 2.5 kHz, and after slips."""
    spectra = segment_spectra(residual, _SHORT)
    bins = [_bins(band, _SHORT, rate) for band in (_LOW, (_LOW[1], min(_HIGHEST, USABLE * rate)))]
    first, last = np.array([[inside.start, inside.stop] for inside in bins]).T
    low, high = band_sums(powers(spectra), first, last).T
    numbers = {
        "high_floor": _half_log(float(quantile(high, 0.1))),
        "high_most": _half_log(float(quantile(high, 0.98))),
        "high_mean": _half_log(float(high.mean())),
        "low_floor": _half_log(float(quantile(low, 0.1))),
    }
    if slips.size > 3:
        middle = (np.arange(high.size) + 1) * (_SHORT // 2) / rate
        last = np.searchsorted(slips, middle) - 1
        since = np.where(last >= 0, middle - slips[np.maximum(last, 0)], 1.0)
        after, later = high[since < 2.5e-3], high[since > 5e-3]
        if after.size > 5 and later.size > 5:
            numbers["high_at_slips"] = math.log(
                (float(after.mean()) + 1e-14) / (float(later.mean()) + 1e-14)
            )
    return numbers


def _kurtosis(x: Array) -> float:
    square = (x - x.mean()) ** 2
    return float(square @ square) / x.size / (float(square.mean()) ** 2 + 1e-30) + 1e-9


def _half_log(power: float) -> float:
    return 0.5 * math.log(power + 1e-14)
