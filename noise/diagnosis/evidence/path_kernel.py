# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Compiled loops over a channel and its prediction: cross spectra, and how a signal is spread.

What is made of them stands in `noise.diagnosis.evidence.path_summary`.
"""

from __future__ import annotations

from numba import njit

from models.compilation import COMPILED

_FAST = {"reassoc", "contract", "nsz"}
"""Sums in any order, which lets the processor add several numbers at once."""


@njit(fastmath=_FAST, cache=True, **COMPILED)
def cross_powers(one, other, powers, cross) -> None:
    """Average the powers and the cross power of two signals' segments.

    Parameters
    ----------
    one, other : ndarray of complex, shape (n_segments, n_bins)
        [any unit]
    powers : ndarray, shape (3, n_bins), filled in
        Of the first, of the other, and of the other less the first [unit^2].
    cross : ndarray of complex, shape (n_bins,), filled in
        Of the conjugated first with the other [unit^2].
    """
    powers[:] = 0.0
    cross[:] = 0.0
    n = one.shape[0]
    for i in range(n):
        for k in range(one.shape[1]):
            a, b, c, d = one[i, k].real, one[i, k].imag, other[i, k].real, other[i, k].imag
            powers[0, k] += a * a + b * b
            powers[1, k] += c * c + d * d
            powers[2, k] += (c - a) * (c - a) + (d - b) * (d - b)
            cross[k] += complex(a * c + b * d, a * d - b * c)
    for k in range(one.shape[1]):
        powers[0, k] /= n
        powers[1, k] /= n
        powers[2, k] /= n
        cross[k] /= n


@njit(fastmath=_FAST, cache=True, **COMPILED)
def quarter_moments(x, found) -> None:
    """Describe how the values of a signal are spread, as a whole and quarter by quarter.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit]
    found : ndarray, shape (6,), filled in
        Variance [unit^2], fourth central moment [unit^4], and the standard deviations of the four
        quarters, each about its own mean [unit]; up to three samples at the end are in none.
    """
    n, total = x.size, 0.0
    for i in range(n):
        total += x[i]
    mean, second, fourth = total / n, 0.0, 0.0
    for i in range(n):
        square = (x[i] - mean) * (x[i] - mean)
        second += square
        fourth += square * square
    found[0], found[1] = second / n, fourth / n
    m = n // 4
    for part in range(4):
        total = 0.0
        for i in range(part * m, (part + 1) * m):
            total += x[i]
        mean, second = total / m, 0.0
        for i in range(part * m, (part + 1) * m):
            second += (x[i] - mean) * (x[i] - mean)
        found[2 + part] = (second / m) ** 0.5
