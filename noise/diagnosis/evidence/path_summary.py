"""Differences of a channel from what the torque should have made of it, in numbers.

The torque that was measured is sent through the transfer function that the rig file has, so that
nothing the contact does enters: gain, delay and coherence by band, the shape of what the channel
has too much, when it comes, and how it decays.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from features.kernels.spectra import segment_spectra
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import (
    USABLE,
    band_bins,
    band_sums,
    bins_between,
    powers,
    quantile,
    segment_frequency,
)

Numbers = dict[str, float]

_LEAD, _TAIL = 0.08, 0.01
"""Left out at the ends, where the structure rings from before and nothing follows [s]; assumed."""

_LONGEST_DELAY = 2.5e-3
_COARSE, _FINE = 4, 16
"""Resolution of the delay, in parts of a sample."""

_REFERENCE_BAND = (80.0, 6000.0)
"""In which gain and delay are those of the whole channel [Hz]; assumed."""

_ECHO = (6e-4, 2e-2)
"""In which echoes are looked for, after what is direct [s]; assumed."""

_SHORT = 256
"""Samples of a short segment, which separate impacts from lasting sound; assumed."""

_LOW, _HIGHEST = (-1.0, 2500.0), 12e3
"""Bands of short segments: low from the constant on, high from there up to the highest [Hz];
assumed."""

_CROSS_BANDS = ((100.0, 600.0), (600.0, 2000.0), (2000.0, 6000.0))


def path_summary(
    predicted: Array, measured: Array, rate: float, slips: Array
) -> tuple[Numbers, Array]:
    """Compare a channel with its prediction.

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
        By name, those of a band with its number; ratios and coherences as logarithms [-], ``delay``
        in microseconds, ``*_at`` as logarithms of seconds or hertz; none of a recording that is
        shorter than the segments by which bands are told.
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
    """Coherence, by band, of what two channels have too much.

    Parameters
    ----------
    one, other : ndarray, shape (n,)
        Residuals as `path_summary` gives them, each in its unit.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of coherences [-]; none of residuals that are shorter than a segment.

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
    """Bins of a spectrum of `length` samples between two frequencies [Hz]."""
    return bins_between(np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64), band)


def _by_band(pp: Array, mm: Array, pm: NDArray[np.complex128], left: Array, rate: float) -> Numbers:
    coherent = np.abs(pm) ** 2 / (pp * mm + 1e-30) * mm
    bands = band_bins(rate)
    rows = np.stack([pp, mm, coherent, left, pm.real, pm.imag])[:, : bands.last[-1]]
    sums = np.add.reduceat(rows, bands.first, axis=1).T  # each band begins where one ends
    numbers: Numbers = {}
    for i, n, (a, c, shared, wrong, real, imaginary) in zip(
        bands.numbers, (bands.last - bands.first).tolist(), sums.tolist(), strict=True
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
    """Gain, tilt, delay and decay of the transfer function from predicted to measured."""
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
    """Find where one side of a spectrum adds up to most, within so many samples of the start.

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
    """By what lines turn over the fine parts of a sample next to a coarse one."""
    around = _FINE // _COARSE
    parts = np.arange(-around, around + 1) / _FINE
    return np.asarray(np.exp(2j * np.pi / size * np.outer(np.arange(first, last), parts)))


@lru_cache(maxsize=8)
def _weights(size: int, rate: float) -> tuple[Array, Array]:
    """Octaves from the middle of the reference band [-], and a taper towards its ends [-]."""
    frequency = np.fft.rfftfreq(size, 1.0 / rate)[_bins(_REFERENCE_BAND, size, rate)]
    return np.log2(frequency / 700.0), np.hanning(frequency.size) ** 0.25


def _echo(answer: Array, rate: float) -> Numbers:
    """Tell what comes back at certain times from what rings at certain frequencies."""
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
    """Size of the residual, and how unevenly it comes."""
    return {
        "residual": math.log(float(residual.std()) / (float(m.std()) + 1e-12) + 1e-9),
        "residual_kurtosis": math.log(_kurtosis(residual)),
        "kurtosis": math.log(_kurtosis(m) / _kurtosis(p)),
    }


def _impacts(residual: Array, rate: float, slips: Array) -> Numbers:
    """Level of the residual in short segments above and below 2.5 kHz, and after slips."""
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
