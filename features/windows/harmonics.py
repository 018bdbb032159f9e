"""The fundamental that most lines of a spectrum are harmonics of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from features.windows.arithmetic import OCTAVES, ordered_sum
from features.windows.spectra import FIRST, LOBE, SPACING, WindowSpectra

_DIVISORS = np.arange(1, 9)
"""The strongest bin is one of these harmonics."""

_LOWEST = 40.0
"""Fundamental [Hz]."""

_LOWER = 0.93
"""A lower fundamental has more multiples, so it must explain notably more [ratio]."""


def harmonic_features(
    spectra: WindowSpectra,
    at: NDArray[np.int64],
    height: NDArray[np.float32],
    count: NDArray[np.int64],
    place: NDArray[np.float64],
) -> dict[str, NDArray[np.float64]]:
    """Find the fundamental whose multiples hold most of the power in lines.

    Parameters
    ----------
    spectra : WindowSpectra
    at : ndarray of int, shape (n_windows, most)
        Bin of each line.
    height : ndarray of float32, shape (n_windows, most)
        Of each [dB re the strongest bin].
    count : ndarray of int, shape (n_windows,)
        Lines in each spectrum.
    place : ndarray, shape (n_windows,)
        Of the strongest bin's maximum [bins].

    Returns
    -------
    dict of str to ndarray, shape (n_windows,)
        ``fundamental`` [octave re 100 Hz], ``harmonic_share``, ``harmonic_count``,
        ``inharmonicity`` and ``harmonic_gain``, as `features.windows.tones.TONE_NAMES` has them;
        NaN where there is no fundamental.

    Examples
    --------
    >>> from features.windows.spectra import long_spectra, window_spectra
    >>> time = np.arange(8000) / 16e3
    >>> sound = np.sin(2 * np.pi * 1000 * time) + 0.5 * np.sin(2 * np.pi * 2000 * time)
    >>> spectra = long_spectra(sound.astype(np.float32), 3)
    >>> windows = window_spectra(spectra, np.array([0]), np.array([3]), 7000.0)
    >>> height = np.array([[0.0, -6.0]], dtype=np.float32)
    >>> found = harmonic_features(
    ...     windows, np.array([[256, 512]]), height, np.array([2]), np.array([256.0])
    ... )
    >>> found["harmonic_count"], found["harmonic_share"].round(2)
    (array([2.]), array([1.]))
    """
    base = place[:, None] / _DIVISORS
    ratio = at[:, None, :] / base[:, :, None]
    order = np.rint(ratio)
    off = np.abs(ratio - order)
    line = np.arange(at.shape[1]) < count[:, None]
    weight = np.where(line, 10.0 ** (0.1 * height.astype(np.float64)), 0.0)[:, None, :]
    fits = (order >= 1.0) & (off * base[:, :, None] <= (1.5 + 0.006 * at)[:, None, :])
    fits &= line[:, None, :]
    value = ordered_sum(np.where(fits, weight, 0.0), axis=2) * _LOWER**_DIVISORS
    value[base * SPACING < _LOWEST] = 0.0
    best = value.argmax(axis=1)
    rows = np.flatnonzero(value.max(axis=1) > 0.0)
    best = best[rows]
    fundamental, number = base[rows, best], fits[rows, best].sum(axis=1)
    off = np.where(fits[rows, best], off[rows, best] / np.maximum(order[rows, best], 1.0), 0.0)
    inside, bins = _in_multiples(spectra.power[rows], fundamental, spectra.end)
    share = np.minimum(1.0, inside / spectra.total[rows])
    expected = bins / (spectra.end - FIRST)
    found = {
        "fundamental": OCTAVES * np.log(fundamental * (SPACING / 100.0)),
        "harmonic_share": share,
        "harmonic_count": number,
        "inharmonicity": ordered_sum(off, axis=1) / np.maximum(number, 1),
        "harmonic_gain": share.astype(np.float32) - expected,
    }
    out = {name: np.full(count.size, np.nan) for name in found}
    for name, values in found.items():
        out[name][rows] = values
    return out


def _in_multiples(
    power: NDArray[np.float32], fundamental: NDArray[np.float64], end: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return power and number of the bins about the multiples of each fundamental [bins]."""
    most = int(end / fundamental.min(initial=end))
    multiple = np.arange(1, most + 1) * fundamental[:, None]
    centre = np.rint(multiple).astype(np.int64)
    counted = (multiple < end - LOBE) & (centre - LOBE >= FIRST)
    aside = np.arange(-LOBE, LOBE + 1)
    reach = np.minimum(LOBE, (0.4 * fundamental).astype(np.int64))
    inside = counted[:, :, None] & (np.abs(aside) <= reach[:, None, None])
    bins = np.where(inside, centre[:, :, None] + aside, 0).reshape(-1, most * aside.size)
    inside = inside.reshape(bins.shape)
    terms = np.where(inside, np.take_along_axis(power, bins, axis=1), 0.0).astype(np.float64)
    return ordered_sum(terms, axis=1), inside.sum(axis=1)
