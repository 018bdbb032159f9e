# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Compiled loops over one signal: its distribution, its lines and its bands.

Each goes over the samples once or twice where numpy would make an array for every step; what is
computed stands in `noise.diagnosis.evidence.channel_summary`.
"""

from __future__ import annotations

from numba import njit

from models.compilation import COMPILED, PART

_FAST = {"reassoc", "contract", "nsz"}
"""Sums in any order, which lets the processor add several numbers at once."""


@njit(fastmath=_FAST, cache=True, **COMPILED)
def describe_distribution(x, found) -> None:
    """Describe how the values of a signal are distributed.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit]
    found : ndarray, shape (12,), filled in
        Largest, least, mean, standard deviation and third central moment; shares [-] within 2 % of
        the span of the largest and of the least, and of steps below a thousandth of it; samples
        within 5 % of the largest and times that they are entered, then those of the least.
    """
    n = x.size
    top, bottom, total = x[0], x[0], 0.0
    for i in range(n):
        top = max(top, x[i])
        bottom = min(bottom, x[i])
        total += x[i]
    mean = total / n
    span = top - bottom + 1e-12
    high, low = top - 0.02 * span, bottom + 0.02 * span
    second, third, n_high, n_low, n_flat = 0.0, 0.0, 0, 0, 0
    for i in range(n):
        away = x[i] - mean
        second += away * away
        third += away * away * away
        n_high += x[i] > high
        n_low += x[i] < low
    for i in range(1, n):
        n_flat += abs(x[i] - x[i - 1]) < 1e-3 * span
    high, low = top - 0.05 * span, bottom + 0.05 * span
    stays, entries, low_stays, low_entries = x[0] > high, 0, x[0] < low, 0
    for i in range(1, n):
        stays += x[i] > high
        entries += (x[i] > high) & (x[i - 1] <= high)
        low_stays += x[i] < low
        low_entries += (x[i] < low) & (x[i - 1] >= low)
    found[0], found[1], found[2] = top, bottom, mean
    found[3], found[4] = (second / n) ** 0.5, third / n
    found[5], found[6], found[7] = n_high / n, n_low / n, n_flat / max(n - 1, 1)
    found[8], found[9], found[10], found[11] = stays, entries, low_stays, low_entries


@njit(fastmath=_FAST, cache=True, **COMPILED)
def detrend_and_window(x, window, windowed) -> None:
    """Take mean and trend off a signal, and multiply it by a window.

    Parameters
    ----------
    x, window : ndarray, shape (n,)
        [any unit], [-]
    windowed : ndarray, shape (n,), filled in
        [unit of the signal]
    """
    n = x.size
    middle = 0.5 * (n - 1)
    total, moment = 0.0, 0.0
    for i in range(n):
        total += x[i]
    mean = total / n
    for i in range(n):
        moment += (i - middle) * (x[i] - mean)
    slope = moment / max(n * (float(n) * n - 1.0) / 12.0, 1e-300)
    for i in range(n):
        windowed[i] = (x[i] - mean - slope * (i - middle)) * window[i]


@njit(fastmath=_FAST, cache=True, **COMPILED)
def thin_out(x, every, slow) -> None:
    """Average a signal over triangles that overlap by half.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit]
    every : int
        Samples from triangle to triangle.
    slow : ndarray, shape (n // every - 1,), filled in
        [unit of the signal]
    """
    before = 0.0
    for i in range(slow.size + 1):
        rising, falling = 0.0, 0.0
        for k in range(every):
            value = x[i * every + k]
            rising += (k + 0.5) * value
            falling += (every - k - 0.5) * value
        if i > 0:
            slow[i - 1] = (before + falling) / (every * every)
        before = rising


@njit(**PART)
def _select(values, n, place) -> None:
    """Reorder the first `n` values about the one that belongs to a place; Hoare's selection."""
    low, high = 0, n - 1
    while low < high:
        pivot, i, j = values[place], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if j < place:
            low = i
        if i > place:
            high = j


@njit(**PART)
def quantile_in_place(values, n, share):
    """Quantile of the first `n` values, linear between them, which are put in another order."""
    place = int(share * (n - 1))
    _select(values, n, place)
    below = values[place]
    if place + 1 >= n:
        return below
    above = values[place + 1]
    for i in range(place + 2, n):
        above = min(above, values[i])
    return below + (share * (n - 1) - place) * (above - below)


@njit(cache=True, **COMPILED)
def power_quantiles(spectra, first, share, scratch, found) -> None:
    """Quantile over the spectra of the power in each bin.

    Parameters
    ----------
    spectra : ndarray of complex, shape (n_spectra, n_bins)
        [any unit]
    first : int
        Bin to begin with.
    share : float
        From 0 to 1 [-].
    scratch : ndarray, shape (n_spectra,)
        [unit^2]
    found : ndarray, shape (n_asked,), filled in
        Of as many bins [unit^2].
    """
    n = spectra.shape[0]
    for k in range(found.size):
        for i in range(n):
            value = spectra[i, first + k]
            scratch[i] = value.real * value.real + value.imag * value.imag
        found[k] = quantile_in_place(scratch, n, share)


@njit(cache=True, **COMPILED)
def line_ratios(power, lines, ratios, beside) -> None:
    """Compare the power of lines with the median of what lies beside them.

    Parameters
    ----------
    power : ndarray, shape (n_bins,)
        [any unit]
    lines : ndarray of int, shape (n_lines,)
        Bins; a line is the largest of five about it, what is beside lies 5 to 12 bins away.
    ratios : ndarray, shape (n_lines,), filled in
        [-], 1 where the spectrum ends before.
    beside : ndarray, shape (16,), scratch
        [unit of the power]
    """
    for j in range(lines.size):
        k = lines[j]
        if k + 13 > power.size:
            ratios[j] = 1.0
            continue
        most, n = 0.0, 0
        for i in range(max(k - 2, 0), k + 3):
            most = max(most, power[i])
        for i in range(max(k - 12, 1), max(k - 4, 1)):
            beside[n] = power[i]
            n += 1
        for i in range(k + 5, k + 13):
            beside[n] = power[i]
            n += 1
        ratios[j] = (most + 1e-30) / (quantile_in_place(beside, n, 0.5) + 1e-30)


@njit(fastmath=_FAST, cache=True, **COMPILED)
def band_power_sums(spectra, first, last, sums) -> None:
    """Sum the power of spectra over bands.

    Parameters
    ----------
    spectra : ndarray of complex, shape (n_spectra, n_bins)
        [any unit]
    first, last : ndarray of int, shape (n_bands,)
        First bin of each band, and first after it.
    sums : ndarray, shape (n_spectra, n_bands), filled in
        [unit^2]
    """
    for i in range(spectra.shape[0]):
        for band in range(first.size):
            total = 0.0
            for k in range(first[band], last[band]):
                total += spectra[i, k].real ** 2 + spectra[i, k].imag ** 2
            sums[i, band] = total
