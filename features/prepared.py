"""A signal made ready: what several features need is computed once, when first asked for.

Sound and acceleration are described from 150 Hz up to 7 kHz, at a rate of 16 kHz whatever they were
recorded at; what lies above has bands of its own, which are empty where the recording does not
reach them. A torque is described from 5 Hz. Everything but levels is computed of the signal divided
by its rms value, so that no constant in here can depend on the gain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels.conditioning import (
    ACOUSTIC_FROM,
    NOTHING,
    WORKING_LIMIT,
    Transform,
    band_analytic,
    band_signal,
    checked_signal,
    forward,
    usable_limit,
)
from features.kernels.harmonics import HIGHEST, LOWEST, Harmonics, harmonics_of
from features.kernels.levels import (
    LEAST_SHARE_DB,
    NOMINAL_THIRD_OCTAVES,
    REFERENCES,
    THESIS_BANDS,
    THIRD_OCTAVE_RESOLUTION,
    a_weighted_level,
    band_power,
    relative_db,
    third_octave_levels,
)
from features.kernels.lines import Lines, find_lines, line_resolution, noise_floor
from features.kernels.modulation import Modulation, modulation, short_time
from features.kernels.slips import (
    Pulses,
    TorqueSlips,
    envelope_kurtosis,
    pulse_band_from,
    pulses_of,
    squared,
    torque_slips,
)
from features.kernels.spectra import SpectralShape, Spectrum, spectral_shape, welch, whole_spectrum
from models.show import short_repr

ACOUSTIC_KINDS = ("pressure", "acceleration")
"""Kinds of channel that are described as noise."""

TOP_BANDS = ((7_000.0, 13_000.0), (13_000.0, 19_000.0))
"""Bands above the common limit [Hz]: reached by rates from 29.8 kHz and from 43.5 kHz on."""

_BAND_EDGES = (150, 500, 1000, 2000, 5000, 7000)
"""Edges of the bands in which shares are told [Hz]."""

_LEAST_IN_BAND = 1e-5
"""Power of the band described, relative to the whole, below which it holds leakage only."""


class TopBand(NamedTuple):
    """A band above the common limit; NaN where the rate does not reach it.

    Parameters
    ----------
    level : float
        Re the band that is described [dB].
    kurtosis : float
        [-]; NaN also where the band holds nothing.
    """

    level: float
    kurtosis: float


@short_repr
@dataclass(frozen=True, eq=False)
class Prepared:
    """One channel and what has been computed of it so far. Made by `prepare`.

    Parameters
    ----------
    samples : ndarray, shape (n_samples,)
        In the channel's own [unit].
    rate : float
        Sampling rate [Hz].
    kind : str
        Of channel: pressure, acceleration or torque.
    calibrated : bool
        Whether the samples are in physical units.
    mean : float
        [unit]
    rms : float
        About the mean [unit]; 0 for a signal that is constant but for rounding.
    stick_rate : float
        How fast the torque rises in true stick [N m/s]: k_EFF times the shaft's speed (thesis,
        (5.1)); NaN where that is not known.
    """

    samples: NDArray[np.float64]
    rate: float
    kind: str
    calibrated: bool
    mean: float
    rms: float
    stick_rate: float = math.nan

    @property
    def low(self) -> float:
        """Lower limit of the band that is described [Hz]."""
        return ACOUSTIC_FROM if self.kind in ACOUSTIC_KINDS else LOWEST

    @property
    def limit(self) -> float:
        """Upper limit of the band that is described [Hz]: 7 kHz, or what the rate allows."""
        return min(WORKING_LIMIT, usable_limit(self.rate))

    @cached_property
    def silent(self) -> bool:
        """Whether the band that is described holds nothing but leakage and rounding."""
        return self.rms == 0.0 or self.low >= self.limit or self.in_band_share < _LEAST_IN_BAND

    @cached_property
    def transform(self) -> Transform:
        """Of the signal about its mean, divided by its rms value."""
        return forward((self.samples - self.mean) / self.rms, self.rate)

    @cached_property
    def below(self) -> tuple[NDArray[np.float64], float]:
        """All below the limit, at the working rate, and that rate [Hz]; shape (n,)."""
        return band_signal(self.transform, 0.0, self.limit)

    @cached_property
    def in_band(self) -> tuple[NDArray[np.float64], float]:
        """Part within the band described, at the working rate, and that rate [Hz]; shape (n,)."""
        return band_signal(self.transform, self.low, self.limit)

    @cached_property
    def in_band_power(self) -> float:
        """Mean square of that part, over that of the signal [-]."""
        return float(np.mean(self.in_band[0] ** 2))

    @cached_property
    def kurtosis(self) -> float:
        """Kurtosis of that part [-]."""
        x, _ = self.in_band
        return float(np.mean(np.square(np.square(x / x.std()))))

    @cached_property
    def in_band_share(self) -> float:
        """Share of the power below the limit that lies within the band that is described."""
        whole = float(np.mean(self.below[0] ** 2))
        return self.in_band_power / whole if whole > 0.0 else 0.0

    @cached_property
    def spectrum(self) -> Spectrum:
        """Of the part within the band that is described."""
        x, rate = self.in_band
        return welch(x, rate, line_resolution(x.size / rate))

    @cached_property
    def floor(self) -> NDArray[np.float64]:
        """Noise floor of the spectrum [1/Hz], shape (n_bins,)."""
        return noise_floor(self.spectrum)

    @cached_property
    def lines(self) -> Lines:
        """Discrete lines of the spectrum."""
        return find_lines(self.spectrum, low=self.low, high=self.limit, floor=self.floor)

    @cached_property
    def harmonics(self) -> Harmonics:
        """Fundamental and harmonics."""
        return harmonics_of(
            self.in_band[0],
            self.spectrum,
            self.floor,
            self.lines,
            lowest=LOWEST,
            highest=min(HIGHEST, self.limit),
        )

    @cached_property
    def shape(self) -> SpectralShape:
        """Shape of the spectrum."""
        return spectral_shape(self.spectrum, low=self.low, high=self.limit)

    @cached_property
    def short_time(self) -> dict[str, float]:
        """Tones and levels of its short segments, and how they change from one to the next."""
        x, rate = self.in_band
        return short_time(x, rate, low=self.low, high=self.limit)

    @cached_property
    def analytic(self) -> tuple[NDArray[np.complex128], float]:
        """Analytic signal of the band that is described, and its rate [Hz]."""
        return band_analytic(self.transform, self.low, self.limit)

    @cached_property
    def pulses(self) -> Pulses:
        """Pulses and their rhythm."""
        high, rate = band_analytic(self.transform, pulse_band_from(self.limit), self.limit)
        start = self.transform.lead / self.rate
        return pulses_of(self.analytic[0], high, rate, start=start)

    @cached_property
    def modulation(self) -> Modulation:
        """Modulation of the envelope."""
        analytic, rate = self.analytic
        return modulation(np.sqrt(squared(analytic)), rate)

    @cached_property
    def slips(self) -> TorqueSlips:
        """Slips of a torque, in its own unit."""
        return torque_slips(self.samples, self.rate)

    @cached_property
    def third_octave_levels(self) -> dict[str, float]:
        """Levels in one-third octaves [dB], by nominal mid-band frequency; at least -80 re all."""
        if self.rms == 0.0:
            return dict.fromkeys(NOMINAL_THIRD_OCTAVES, math.nan)
        spectrum = welch(self.samples, self.rate, THIRD_OCTAVE_RESOLUTION)
        levels = third_octave_levels(spectrum, reference=1.0)
        least = 20.0 * math.log10(self.rms) + LEAST_SHARE_DB
        unit = 20.0 * math.log10(REFERENCES[self.kind])
        # A band that is not measured stays so.
        return {
            name: level if math.isnan(level) else max(level, least) - unit
            for name, level in levels.items()
        }

    @cached_property
    def band_levels(self) -> dict[str, float]:
        """Levels of bands [dB re the band described], by their limits in Hz.

        The thesis's own bands, which hold hum or reach beyond that band, are of the spectrum of all
        that the rate holds. NaN where the rate does not reach one.
        """
        levels = {
            f"{low}_{high}": self._share_db(self.spectrum, low, high)
            if high <= 1.001 * self.limit
            else math.nan
            for low, high in pairwise(_BAND_EDGES)
        }
        whole = whole_spectrum(self.transform)
        for low, high in (THESIS_BANDS[0], THESIS_BANDS[2]):
            reached = high <= usable_limit(self.rate)
            levels[f"{low:.0f}_{high:.0f}"] = (
                self._share_db(whole, low, high) if reached else math.nan
            )
        return levels

    def _share_db(self, spectrum: Spectrum, low: float, high: float) -> float:
        part, whole = band_power(spectrum, [low, self.low], [high, self.limit])
        return relative_db(float(part), float(whole))

    @property
    def level(self) -> float:
        """Level about the mean [dB]; NaN where nothing varies."""
        reference = REFERENCES[self.kind]
        return 20.0 * math.log10(self.rms / reference) if self.rms > 0.0 else math.nan

    @property
    def level_a(self) -> float:
        """A-weighted level [dB]; NaN likewise."""
        if self.rms == 0.0:
            return math.nan
        return a_weighted_level(self.samples, self.rate, reference=REFERENCES[self.kind])

    @property
    def hum_share(self) -> float:
        """Share of the power below the limit that lies below the band described [-]."""
        described = self.rms > 0.0 and self.low < self.limit
        return 1.0 - min(1.0, self.in_band_share) if described else math.nan

    @property
    def line_order(self) -> float:
        """Frequency of the strongest line over the fundamental [-]."""
        return self.lines.strongest / self.harmonics.fundamental

    @property
    def crest(self) -> float:
        """Peak of the envelope over the rms value [dB]."""
        return 20.0 * math.log10(self.pulses.crest_factor)

    @property
    def relative_oscillation(self) -> float:
        """Rms value about the mean over the mean's magnitude [-]."""
        return self.rms / abs(self.mean) if self.mean != 0.0 else math.nan

    @property
    def high_band(self) -> float:
        """Level of what a torque has little of, above 2 kHz (thesis, 5.2.3) [dB]."""
        if usable_limit(self.rate) <= THESIS_BANDS[1][0]:
            return math.nan
        return self._share_db(self.spectrum, THESIS_BANDS[1][0], self.limit)

    @property
    def slope_ratio(self) -> float:
        """Slope of the rising torque over that in true stick [-]."""
        return self.slips.stick_slope / self.stick_rate

    @cached_property
    def top_bands(self) -> tuple[TopBand, ...]:
        """Of `TOP_BANDS`."""
        return tuple(self._top_band(low, high) for low, high in TOP_BANDS)

    def _top_band(self, low: float, high: float) -> TopBand:
        if high > usable_limit(self.rate):
            return TopBand(math.nan, math.nan)
        top, _ = band_analytic(self.transform, low, high)
        power = squared(top)
        level = relative_db(0.5 * float(power.mean()), self.in_band_power)
        return TopBand(level, envelope_kurtosis(power) if level > LEAST_SHARE_DB else math.nan)


def prepare(
    signal: ArrayLike,
    rate: float,
    kind: str,
    *,
    calibrated: bool = True,
    stick_rate: float = math.nan,
    first: int = 0,
) -> Prepared:
    """Check a signal and make it ready for features.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        One channel, in its unit or, not calibrated, in fractions of full scale.
    rate : float
        Sampling rate [Hz].
    kind : str
        Of channel.
    calibrated : bool
        Whether the samples are in physical units.
    stick_rate : float
        Of a torque [N m/s].
    first : int
        Number of the first sample in its recording, for messages [-].

    Returns
    -------
    Prepared

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

    Examples
    --------
    >>> prepare([1.0] * 480, 48e3, "pressure").silent
    True
    """
    x = checked_signal(signal, rate, first)
    largest = float(np.abs(x).max())
    mean = float(x.mean())
    scale = largest if largest > 0.0 else 1.0
    rms = scale * math.sqrt(float(np.mean(((x - mean) / scale) ** 2)))
    rms = rms if rms > NOTHING * largest else 0.0
    return Prepared(x, rate, kind, calibrated, mean, rms, stick_rate)
