"""Discrete lines of a spectrum.

Squawk has several discrete frequencies and squeal one predominant frequency, so spectra are first
searched for lines. A line must exceed the median of its surroundings by 10 dB, or by more if noise
alone could do that because few segments were averaged, and fall by 10 dB on either side before the
next maximum, so that a broad resonance filled with noise is not a line. Its power is that within
the window's main lobe and half a per cent of its frequency, since a friction tone wanders by about
that much in a second.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, special

from features.kernels.spectra import DEFAULT_RESOLUTION, Spectrum, parabola_tops
from models.show import short_repr

PROMINENCE_DB = 10.0
"""Least height of a line above the local floor, and above the saddle to the next line [dB]."""

RANGE_DB = 30.0
"""Largest distance of a line below the strongest [dB]."""

WANDER = 0.005
"""Half the width of a line beyond the window's main lobe, as a share of its frequency."""

MAIN_LOBE = 2.0
"""Half the width of a Hann window's main lobe in bins."""

_FLOOR_WIDTH = 200.0
"""Width of the running median of the floor [Hz] ..."""

_FLOOR_BINS = 31
"""... but at least this number of bins."""

_FALSE_LINES = 1e-7
"""Probability that noise makes one bin a line."""

_LEAST_FLOOR = 1e-12
"""Lowest floor relative to the strongest bin, the rounding error of zero."""


_NO_SECOND_LINE = 1e-4
"""Relative power in place of a missing second line, below that of any line."""


@short_repr
@dataclass(frozen=True, eq=False)
class Lines:
    """Discrete spectral lines, the strongest first.

    Parameters
    ----------
    frequency : ndarray, shape (n_lines,)
        [Hz], interpolated between bins.
    power : ndarray, shape (n_lines,)
        Mean square of each [unit^2].
    total : float
        Mean square of the searched band [unit^2].
    """

    frequency: NDArray[np.float64]
    power: NDArray[np.float64]
    total: float

    @property
    def count(self) -> int:
        """Number of lines."""
        return self.frequency.size

    @property
    def strongest(self) -> float:
        """Frequency of the strongest line [Hz]; NaN if there is none."""
        return float(self.frequency[0]) if self.frequency.size else math.nan

    @property
    def strongest_share(self) -> float:
        """Share of the band's power in the strongest line; 0 if there is none."""
        return float(self.power[0] / self.total) if self.power.size else 0.0

    @property
    def second_level(self) -> float:
        """Level of the second line re the strongest [dB], at least -40; NaN without lines."""
        if self.power.size == 0:
            return math.nan
        ratio = float(self.power[1] / self.power[0]) if self.power.size > 1 else 0.0
        return 10.0 * math.log10(max(ratio, _NO_SECOND_LINE))

    @property
    def share(self) -> float:
        """Share of the band's power in all lines."""
        return min(1.0, float(self.power.sum() / self.total)) if self.power.size else 0.0


def line_resolution(duration: float) -> float:
    """Return the spacing of the bins for a search of lines.

    Segments have a quarter of a second, or less if there would be fewer than three: in a single one
    noise exceeds its mean by up to 13 dB.

    Parameters
    ----------
    duration : float
        Duration of the signal [s].

    Returns
    -------
    float
        [Hz]

    Examples
    --------
    >>> line_resolution(1.0), line_resolution(0.25)
    (4.0, 8.0)
    """
    return max(DEFAULT_RESOLUTION, 2.0 / duration)


def noise_floor(spectrum: Spectrum) -> NDArray[np.float64]:
    """Return the density of the noise between the lines.

    Parameters
    ----------
    spectrum : Spectrum

    Returns
    -------
    ndarray, shape (n_bins,)
        [unit^2/Hz]

    Notes
    -----
    Running median over 200 Hz or 31 bins, divided by the median of the chi-square law for the
    number of averages, which gives the mean of noise.

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> noise = autospectrum(np.random.default_rng(1).normal(size=64_000), 16e3)
    >>> bool(abs(noise_floor(noise).mean() / noise.density.mean() - 1.0) < 0.05)
    True
    """
    p = spectrum.density
    width = min(max(_FLOOR_BINS, 2 * round(0.5 * _FLOOR_WIDTH / spectrum.spacing) + 1), p.size)
    half = 0.5 * spectrum.degrees_of_freedom
    median_of_noise = float(special.gammaincinv(half, 0.5)) / half
    floor = ndimage.median_filter(p, size=width, mode="reflect") / median_of_noise
    return np.asarray(np.maximum(floor, _LEAST_FLOOR * p.max()))


def find_lines(
    spectrum: Spectrum, *, low: float, high: float, floor: NDArray[np.float64] | None = None
) -> Lines:
    """Find the discrete lines of a spectrum between two frequencies.

    Parameters
    ----------
    spectrum : Spectrum
    low, high : float
        Limits of the search [Hz].
    floor : ndarray, shape (n_bins,), optional
        `noise_floor` of the spectrum, if already computed [unit^2/Hz].

    Returns
    -------
    Lines
        Lines within 30 dB of the strongest and at least 10 dB above the floor.

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> t = np.arange(16000) / 16e3
    >>> tones = np.sin(2 * np.pi * 700 * t) + 0.5 * np.sin(2 * np.pi * 1130 * t)
    >>> lines = find_lines(autospectrum(tones, 16e3), low=150.0, high=7000.0)
    >>> lines.frequency.round().tolist(), round(lines.strongest_share, 2)
    ([700.0, 1130.0], 0.8)
    """
    from scipy.signal import find_peaks

    p, f, spacing = spectrum.density, spectrum.frequency, spectrum.spacing
    floor = noise_floor(spectrum) if floor is None else floor
    inside = (f >= low) & (f <= high)
    total = float(p[inside].sum()) * spacing
    if not total > 0.0:
        return Lines(np.empty(0), np.empty(0), 0.0)
    level = 10.0 * np.log10(np.maximum(p, _LEAST_FLOOR * p.max()))
    above = level - 10.0 * np.log10(floor)
    peaks, _ = find_peaks(
        level,
        height=float(level[inside].max()) - RANGE_DB,
        prominence=PROMINENCE_DB,
        wlen=max(9, 2 * round(_FLOOR_WIDTH / spacing) + 1),
    )
    inside &= f >= MAIN_LOBE * spacing
    half = 0.5 * spectrum.degrees_of_freedom
    chance = 10.0 * float(np.log10(special.gammainccinv(half, _FALSE_LINES) / half))
    peaks = peaks[inside[peaks] & (above[peaks] >= max(PROMINENCE_DB, chance))]
    peaks = _separate(peaks, level, f, spacing)
    if peaks.size == 0:
        return Lines(np.empty(0), np.empty(0), total)
    gaps = np.concatenate([[np.inf], np.diff(f[peaks]), [np.inf]])
    power = line_powers(spectrum, floor, f[peaks], spacing=np.minimum(gaps[:-1], gaps[1:]))
    power = np.clip(power, 0.0, total)
    order = np.argsort(power)[::-1]
    frequency = parabola_tops(level, peaks)[0] * spacing
    return Lines(frequency[order], power[order], total)


def line_powers(
    spectrum: Spectrum,
    floor: NDArray[np.float64],
    frequency: NDArray[np.float64],
    *,
    spacing: NDArray[np.float64] | float,
) -> NDArray[np.float64]:
    """Return the power above the floor about frequencies.

    A line extends over the window's main lobe and its wander, but at most over half of `spacing`.

    Parameters
    ----------
    spectrum : Spectrum
    floor : ndarray, shape (n_bins,)
        `noise_floor` of the spectrum [unit^2/Hz].
    frequency : ndarray, shape (n_lines,)
        [Hz]
    spacing : float or ndarray, shape (n_lines,)
        Distance to the next line [Hz].

    Returns
    -------
    ndarray, shape (n_lines,)
        [unit^2]

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.spectra import autospectrum
    >>> tone = autospectrum(np.sin(2 * np.pi * 700 * np.arange(16000) / 16e3), 16e3)
    >>> at = np.array([700.0])
    >>> line_powers(tone, noise_floor(tone), at, spacing=700.0).round(3).tolist()
    [0.5]
    """
    reach = MAIN_LOBE * spectrum.spacing + WANDER * frequency
    reach = np.minimum(reach, 0.5 * spacing)
    excess = np.append(0.0, np.cumsum(spectrum.density - floor)) * spectrum.spacing
    edges = np.append(spectrum.frequency, spectrum.frequency[-1] + spectrum.spacing)
    edges = edges - 0.5 * spectrum.spacing
    return np.asarray(
        np.interp(frequency + reach, edges, excess) - np.interp(frequency - reach, edges, excess)
    )


def _separate(
    peaks: NDArray[np.intp], level: NDArray[np.float64], f: NDArray[np.float64], spacing: float
) -> NDArray[np.intp]:
    """Return the strongest of peaks that lie within each other's width."""
    if peaks.size < 2:
        return peaks
    at = f[peaks]
    reach = MAIN_LOBE * spacing + WANDER * at
    if bool((np.diff(at) > reach[1:]).all()):
        return peaks
    free = np.ones(peaks.size, dtype=np.bool_)
    separate = np.zeros(peaks.size, dtype=np.bool_)
    for i in np.argsort(level[peaks])[::-1].tolist():
        if free[i]:
            separate[i] = True
            free &= np.abs(at - at[i]) > reach[i]
    return np.asarray(peaks[separate])
