"""Prepared signal: intermediate results that several features share, computed at first use.

Sound and acceleration are described from 150 Hz to 7 kHz, at a rate of 16 kHz whatever the
recording's; higher frequencies have bands of their own, which are missing where the rate does not
reach them. A torque is described from 5 Hz. Everything except levels is computed from the signal
divided by its rms value, so no constant depends on the gain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from features.kernels import conditioning, levels, spectra
from features.kernels.harmonics import HIGHEST, LOWEST, Harmonics, harmonics_of
from features.kernels.lines import Lines, find_lines, line_resolution, noise_floor
from features.kernels.modulation import Modulation, modulation, short_time
from features.kernels.slips import (
    PULSE_BAND_FROM,
    Pulses,
    TorqueSlips,
    envelope_kurtosis,
    pulses_of,
    squared,
    torque_slips,
)
from features.kernels.weighting import a_weighted_level
from models.show import short_repr

ACOUSTIC_KINDS = ("pressure", "acceleration")
"""Kinds of channel with acoustic features."""

TOP_BANDS = ((7_000.0, 13_000.0), (13_000.0, 19_000.0))
"""Bands above the common limit [Hz], which rates from 29.8 kHz and from 43.5 kHz on reach."""

_BAND_EDGES = (150, 500, 1000, 2000, 5000, 7000)
"""Edges of the bands of relative levels [Hz]."""

_LEAST_IN_BAND = 1e-5
"""Relative power of the described band below which it contains leakage only."""


@short_repr
@dataclass(frozen=True, eq=False)
class Prepared:
    """Channel with lazily computed intermediate results, from `prepare`.

    Parameters
    ----------
    samples : ndarray, shape (n_samples,)
        In the channel's [unit].
    rate : float
        Sampling rate [Hz].
    kind : str
        Kind of channel: pressure, acceleration or torque.
    calibrated : bool
        Whether the samples are in physical units.
    mean : float
        [unit]
    rms : float
        Rms value about the mean [unit]; 0 for a signal that is constant to rounding.
    """

    samples: NDArray[np.float64]
    rate: float
    kind: str
    calibrated: bool
    mean: float
    rms: float

    @property
    def low(self) -> float:
        """Lower limit of the described band [Hz]."""
        return conditioning.ACOUSTIC_FROM if self.kind in ACOUSTIC_KINDS else LOWEST

    @property
    def limit(self) -> float:
        """Upper limit of the described band [Hz]: 7 kHz, or less if the rate is low."""
        return min(conditioning.WORKING_LIMIT, conditioning.usable_limit(self.rate))

    @cached_property
    def silent(self) -> bool:
        """Whether the described band contains only leakage and rounding."""
        return self.rms == 0.0 or self.low >= self.limit or self.in_band_share < _LEAST_IN_BAND

    @cached_property
    def transform(self) -> conditioning.Transform:
        """Fourier transform of the signal about its mean, divided by its rms value."""
        return conditioning.forward((self.samples - self.mean) / self.rms, self.rate)

    @cached_property
    def below(self) -> tuple[NDArray[np.float64], float]:
        """Signal below the limit at the working rate, shape (n,), and that rate [Hz]."""
        return conditioning.band_signal(self.transform, 0.0, self.limit)

    @cached_property
    def in_band(self) -> tuple[NDArray[np.float64], float]:
        """Signal in the described band at the working rate, shape (n,), and that rate [Hz]."""
        return conditioning.band_signal(self.transform, self.low, self.limit)

    @cached_property
    def in_band_power(self) -> float:
        """Mean square in the described band over that of the signal [-]."""
        return float(np.mean(self.in_band[0] ** 2))

    @cached_property
    def kurtosis(self) -> float:
        """Kurtosis in the described band [-]."""
        x, _ = self.in_band
        return float(np.mean(np.square(np.square(x / x.std()))))

    @cached_property
    def in_band_share(self) -> float:
        """Share of the power below the limit that lies within the described band [-]."""
        whole = float(np.mean(self.below[0] ** 2))
        return self.in_band_power / whole if whole > 0.0 else 0.0

    @cached_property
    def spectrum(self) -> spectra.Spectrum:
        """Spectrum of the described band."""
        x, rate = self.in_band
        return spectra.welch(x, rate, line_resolution(x.size / rate))

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
            self.in_band[0], self.spectrum, self.floor, self.lines, highest=min(HIGHEST, self.limit)
        )

    @cached_property
    def shape(self) -> spectra.SpectralShape:
        """Shape of the spectrum."""
        return spectra.spectral_shape(self.spectrum, low=self.low, high=self.limit)

    @cached_property
    def short_time(self) -> dict[str, float]:
        """Tones and levels of short segments, and their changes."""
        x, rate = self.in_band
        return short_time(x, rate, low=self.low, high=self.limit)

    @cached_property
    def analytic(self) -> tuple[NDArray[np.complex128], float]:
        """Analytic signal of the described band, and its rate [Hz]."""
        return conditioning.band_analytic(self.transform, self.low, self.limit)

    @cached_property
    def pulses(self) -> Pulses:
        """Pulses and their rhythm."""
        low = PULSE_BAND_FROM * self.limit / conditioning.WORKING_LIMIT
        high, rate = conditioning.band_analytic(self.transform, low, self.limit)
        return pulses_of(self.analytic[0], high, rate)

    @cached_property
    def modulation(self) -> Modulation:
        """Modulation of the envelope."""
        analytic, rate = self.analytic
        return modulation(np.sqrt(squared(analytic)), rate)

    @cached_property
    def slips(self) -> TorqueSlips:
        """Slips of a torque, in its unit."""
        return torque_slips(self.samples, self.rate)

    @cached_property
    def third_octave_levels(self) -> dict[str, float]:
        """One-third octave levels [dB] by mid-band frequency; at least -80 dB re the whole."""
        if self.rms == 0.0:
            return dict.fromkeys(levels.NOMINAL_THIRD_OCTAVES, math.nan)
        spectrum = spectra.welch(self.samples, self.rate, levels.THIRD_OCTAVE_RESOLUTION)
        by_band = levels.third_octave_levels(spectrum, reference=1.0)
        least = 20.0 * math.log10(self.rms) + levels.LEAST_SHARE_DB
        unit = 20.0 * math.log10(levels.REFERENCES[self.kind])
        # A band that is not measured stays NaN.
        return {
            name: level if math.isnan(level) else max(level, least) - unit
            for name, level in by_band.items()
        }

    @cached_property
    def band_levels(self) -> dict[str, float]:
        """Levels of bands [dB re the described band], by their limits in Hz.

        The thesis's bands, which contain hum or extend beyond the described band, are taken from
        the whole spectrum. NaN if the rate does not reach a band.
        """
        by_band = {
            f"{low}_{high}": self._share_db(self.spectrum, low, high)
            if high <= 1.001 * self.limit
            else math.nan
            for low, high in pairwise(_BAND_EDGES)
        }
        whole = spectra.whole_spectrum(self.transform)
        for low, high in (levels.THESIS_BANDS[0], levels.THESIS_BANDS[2]):
            reached = high <= conditioning.usable_limit(self.rate)
            by_band[f"{low:.0f}_{high:.0f}"] = (
                self._share_db(whole, low, high) if reached else math.nan
            )
        return by_band

    def _share_db(self, spectrum: spectra.Spectrum, low: float, high: float) -> float:
        part, whole = levels.band_power(spectrum, [low, self.low], [high, self.limit])
        return levels.relative_db(float(part), float(whole))

    @property
    def level(self) -> float:
        """Level about the mean [dB]; NaN for a constant signal."""
        reference = levels.REFERENCES[self.kind]
        return 20.0 * math.log10(self.rms / reference) if self.rms > 0.0 else math.nan

    @property
    def level_a(self) -> float:
        """A-weighted level [dB]; NaN for a constant signal."""
        if self.rms == 0.0:
            return math.nan
        return a_weighted_level(self.samples, self.rate, reference=levels.REFERENCES[self.kind])

    @property
    def hum_share(self) -> float:
        """Share of the power below the limit that lies below the described band [-]."""
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
        """Rms value about the mean over the magnitude of the mean [-]."""
        return self.rms / abs(self.mean) if self.mean != 0.0 else math.nan

    @property
    def high_band(self) -> float:
        """Level above 2 kHz, where a torque has little (thesis, 5.2.3) [dB]."""
        if conditioning.usable_limit(self.rate) <= levels.THESIS_BANDS[1][0]:
            return math.nan
        return self._share_db(self.spectrum, levels.THESIS_BANDS[1][0], self.limit)

    @cached_property
    def top_bands(self) -> tuple[tuple[float, float], ...]:
        """Level re the described band [dB] and kurtosis [-] of `TOP_BANDS`, NaN beyond the rate."""
        return tuple(self._top_band(low, high) for low, high in TOP_BANDS)

    def _top_band(self, low: float, high: float) -> tuple[float, float]:
        if high > conditioning.usable_limit(self.rate):
            return math.nan, math.nan
        top, _ = conditioning.band_analytic(self.transform, low, high)
        power = squared(top)
        level = levels.relative_db(0.5 * float(power.mean()), self.in_band_power)
        return level, envelope_kurtosis(power) if level > levels.LEAST_SHARE_DB else math.nan


def prepare(
    signal: ArrayLike, rate: float, kind: str, *, calibrated: bool = True, first: int = 0
) -> Prepared:
    """Check a signal and prepare it for features.

    Parameters
    ----------
    signal : array_like, shape (n_samples,)
        One channel, in its unit or, if not calibrated, in fractions of full scale.
    rate : float
        Sampling rate [Hz].
    kind : str
        Kind of channel.
    calibrated : bool
        Whether the samples are in physical units.
    first : int
        Index of the first sample in its recording, for messages.

    Returns
    -------
    Prepared

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Examples
    --------
    >>> prepare([1.0] * 480, 48e3, "pressure").silent
    True
    """
    x = conditioning.checked_signal(signal, rate, first)
    largest = float(np.abs(x).max())
    mean = float(x.mean())
    scale = largest if largest > 0.0 else 1.0
    rms = scale * math.sqrt(float(np.mean(((x - mean) / scale) ** 2)))
    rms = rms if rms > conditioning.NOTHING * largest else 0.0
    return Prepared(x, rate, kind, calibrated, mean, rms)
