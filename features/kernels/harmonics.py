"""Harmonic structure of a vibration: its fundamental, the power in its harmonics, its lines.

The period comes from the autocorrelation (`features.kernels.periodicity` says why) and is then
refined by the discrete lines that lie on its harmonics: the autocorrelation never errs by an octave
because a line is missing, the lines are exact where they are. Harmonicity counts the power above
the local noise floor, so that noise which happens to fall on a dense grid of harmonics counts for
nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

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
from features.kernels.periodicity import Period, strongest_period
from features.kernels.spectra import welch
from models.errors import ParameterError
from models.show import short_repr

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from features.kernels.spectra import Spectrum

__all__ = ["HIGHEST", "LOWEST", "Harmonics", "analyse_harmonics"]

LOWEST = 5.0
"""Lowest fundamental that is sought [Hz]."""

HIGHEST = 8_000.0
"""Highest fundamental that is sought [Hz]."""

WEAKEST_PERIOD = 0.3
"""Autocorrelation below which a signal counts as having no fundamental."""

_BINS_A_HARMONIC = 12.0
"""Bins that should lie between harmonics, five of which a line covers."""

_RATIO_RANGE_DB = 30.0
"""What leaks from lines into their surroundings lies this far below them, or further [dB]."""

_APART = 4.0
"""Bins between two lines that are told apart."""

_MOST = 0.5


@short_repr
@dataclass(frozen=True, eq=False)
class Harmonics:
    """Fundamental and harmonics of a vibration.

    Parameters
    ----------
    fundamental : float
        [Hz]; NaN where the signal has no period.
    strength : float
        Normalised autocorrelation at the period, 0 to 1 [-].
    amplitudes : ndarray, shape (n_harmonics,)
        Peak amplitude of each harmonic up to the upper limit, the fundamental first [unit]; empty
        without a fundamental.
    harmonicity : float
        Share of the power within the harmonics above the noise floor, 0 to 1.
    count : int
        Harmonics within 30 dB of the strongest one and 10 dB above the local noise floor.
    peaks : Lines
        All discrete lines, harmonic or not.
    inharmonicity : float
        Distance of a line from the nearest harmonic over half the fundamental, mean of all lines by
        power: 0 where all are harmonics, 0.5 where they lie anywhere, 1 midway between harmonics.
        NaN without a fundamental or lines, or where harmonics are too close to be told apart.
    """

    fundamental: float
    strength: float
    amplitudes: NDArray[np.float64]
    harmonicity: float
    count: int
    peaks: Lines
    inharmonicity: float

    @property
    def harmonic_to_noise(self) -> float:
        """Power in the harmonics relative to all other power [dB], held within +-30 dB.

        NaN without a fundamental, which white noise hides where a sawtooth is less than 3 dB above.
        """
        if math.isnan(self.fundamental):
            return math.nan
        least = 10.0 ** (-0.1 * _RATIO_RANGE_DB)
        inside = max(self.harmonicity, least)
        return 10.0 * math.log10(inside / max(1.0 - self.harmonicity, least * inside))


def analyse_harmonics(
    signal: ArrayLike, rate: float, *, lowest: float = LOWEST, highest: float = HIGHEST
) -> Harmonics:
    """Find the fundamental of a vibration, its harmonics and all discrete lines.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        Samples in any unit; the mean is removed.
    rate : float
        Sampling rate [Hz].
    lowest, highest : float
        Limits of the fundamental [Hz]. Two periods must fit into the signal, which may raise the
        lower one; the upper one is held below 0.4375 times the rate.

    Returns
    -------
    Harmonics

    Raises
    ------
    ParameterError
        A signal that can't be analysed, or limits that leave nothing between them.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(16000) / 16e3
    >>> sawtooth = (155.0 * t) % 1.0
    >>> found = analyse_harmonics(sawtooth, 16e3)
    >>> round(found.fundamental, 1), found.count > 20, round(found.harmonicity, 2)
    (155.0, True, 0.99)
    """
    x = checked_signal(signal, rate)
    highest = min(highest, usable_limit(rate))
    if not 0.0 < lowest < highest:
        raise ParameterError(
            f"no fundamental lies between {lowest:g} and {highest:g} Hz (0.4375 times the rate at "
            f"most); give 0 < lowest < highest"
        )
    mean = float(x.mean())
    x = x - mean
    if float(np.abs(x).max()) <= NOTHING * abs(mean):
        x = np.zeros_like(x)
    x, rate = band_signal(forward(x, rate), lowest, usable_limit(rate))
    spectrum = welch(x, rate, line_resolution(x.size / rate))
    floor = noise_floor(spectrum)
    lines = find_lines(spectrum, low=lowest, high=usable_limit(rate), floor=floor)
    return harmonics_of(x, spectrum, floor, lines, lowest=lowest, highest=highest)


def harmonics_of(
    x: NDArray[np.float64],
    spectrum: Spectrum,
    floor: NDArray[np.float64],
    lines: Lines,
    *,
    lowest: float,
    highest: float,
) -> Harmonics:
    """`analyse_harmonics` of a signal whose spectrum and lines are at hand.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Mean removed.
    spectrum : Spectrum
        Of `x`.
    floor : ndarray, shape (n_bins,)
        `noise_floor` of it.
    lines : Lines
        Of it; the band they were sought in is what shares refer to.
    lowest, highest : float
        Limits of the fundamental [Hz].

    Returns
    -------
    Harmonics

    Examples
    --------
    >>> import numpy as np
    >>> x = np.sin(2 * np.pi * 500 * np.arange(8000) / 16e3)
    >>> spectrum = welch(x, 16e3, 4.0)
    >>> lines = find_lines(spectrum, low=5.0, high=7e3)
    >>> found = harmonics_of(x, spectrum, noise_floor(spectrum), lines, lowest=5.0, highest=7e3)
    >>> round(found.fundamental, 1), found.count
    (500.0, 1)
    """
    rate = spectrum.rate
    period = strongest_period(x, rate, lowest=lowest, highest=highest)

    def finer(resolution: float) -> Spectrum:
        return welch(x, rate, resolution)

    return harmonics_of_period(
        period, spectrum, floor, lines, duration=x.size / rate, lowest=lowest, finer=finer
    )


def harmonics_of_period(
    period: Period,
    spectrum: Spectrum,
    floor: NDArray[np.float64],
    lines: Lines,
    *,
    duration: float,
    lowest: float,
    finer: Callable[[float], Spectrum],
) -> Harmonics:
    """`analyse_harmonics` of a signal whose period, spectrum and lines are at hand.

    Parameters
    ----------
    period : Period
    spectrum : Spectrum
        Of the signal.
    floor : ndarray, shape (n_bins,)
        `noise_floor` of it.
    lines : Lines
        Of it; the band they were sought in is what shares refer to.
    duration : float
        Of the signal [s].
    lowest : float
        Lower limit of the fundamental [Hz].
    finer : callable
        From a spacing of bins [Hz] to a spectrum of the signal that has it.

    Returns
    -------
    Harmonics
    """
    rate = spectrum.rate
    if lines.total <= 0.0 or period.strength < WEAKEST_PERIOD:
        return Harmonics(math.nan, period.strength, np.empty(0), 0.0, 0, lines, math.nan)
    wanted = period.frequency / _BINS_A_HARMONIC
    if spectrum.spacing > 1.01 * wanted and duration > 1.01 / spectrum.spacing:
        spectrum = finer(wanted)
        floor = noise_floor(spectrum)
        refined = find_lines(spectrum, low=lowest, high=usable_limit(rate), floor=floor)
    else:
        refined = lines
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
    amplitudes = np.sqrt(2.0 * power)
    told_apart = fundamental >= _APART * spectrum.spacing
    inharmonicity = inharmonicity_of(fundamental, refined) if told_apart else math.nan
    return Harmonics(
        fundamental, period.strength, amplitudes, harmonicity, count, lines, inharmonicity
    )


def inharmonicity_of(fundamental: float, lines: Lines) -> float:
    """Distance of lines from the harmonics of a fundamental; see `Harmonics`.

    Parameters
    ----------
    fundamental : float
        [Hz]
    lines : Lines

    Returns
    -------
    float
        0 to 1 [-]; NaN without lines.

    Notes
    -----
    G. Peeters, A large set of audio features for sound description, CUIDADO report, IRCAM (2004).
    The B of a stiff string, f_n = n f_0 sqrt(1 + B n^2), would be no number for friction: where its
    lines are no harmonics they do not stretch evenly, they stand at the structure's modes.

    Examples
    --------
    >>> at = np.array([100.0, 200.0, 310.0])
    >>> equal = np.ones(3)
    >>> round(inharmonicity_of(100.0, Lines(at, equal, equal, 3.0)), 3)
    0.067
    """
    order = lines.frequency / fundamental
    off = np.abs(order - np.maximum(np.rint(order), 1.0))
    power = float(lines.power.sum())
    return min(1.0, 2.0 * float((lines.power * off).sum()) / power) if power > 0.0 else math.nan


def _refined(period: Period, lines: Lines) -> float:
    """Least-squares fundamental of the lines that lie on harmonics, weighted by amplitude.

    Lines that all are multiples of a higher frequency have that one as their fundamental, if they
    are most of the signal: the autocorrelation is coarse where a period is few samples.
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
