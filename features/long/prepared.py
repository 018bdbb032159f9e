"""A long signal made ready: what `features.named.prepared` computes of a whole, of its pieces.

It goes through the signal two or three times. The first time tells its mean and its rms value, the
second all bands, from transforms of overlapping blocks; a third one is needed where lines lie
closer than the spectrum's bins. What is kept is sums and, of each pulse, slip and short segment, a
few numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from features.kernels.bands import (
    LEAST_SHARE_DB,
    REFERENCES,
    THIRD_OCTAVE_RESOLUTION,
    relative_db,
    resolved_third_octaves,
)
from features.kernels.conditioning import NOTHING, WORKING_RATE, band_signal, usable_limit
from features.kernels.harmonics import HIGHEST, LOWEST, Harmonics, harmonics_of_period
from features.kernels.levels import weighted_levels
from features.kernels.lines import line_resolution
from features.kernels.short_time import short_time_of
from features.kernels.spectra import Spectrum
from features.long.acoustic import Acoustic
from features.long.overlapped import Overlapped, block_sizes
from features.long.parts import in_pieces
from features.long.pulses import envelope_kurtosis
from features.long.slips import long_torque_slips
from features.long.sums import Correlation, Moments, WelchSum
from features.named.prepared import ACOUSTIC_KINDS, TOP_BANDS, Prepared, TopBand
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from features.kernels.conditioning import Transform
    from features.kernels.modulation import Modulation
    from features.kernels.periodicity import Period
    from features.kernels.short_time import ShortTime
    from features.kernels.slip_drops import TorqueSlips
    from features.kernels.slip_pulses import Pulses
    from features.long.acoustic import AcousticSums
    from features.long.parts import Pieces, Read

__all__ = ["LongPrepared", "prepare_long"]

_BLOCK = {True: (8.0, 1.0), False: (16.0, 8.0)}
"""Useful length and margin of a block [s]: the flank of a torque's band, at 5 Hz, rings longer."""


class _Passed(NamedTuple):
    """What one pass over the bands of a signal tells."""

    below: Moments
    in_band: Moments
    spectrum: Spectrum
    period: Period
    duration: float
    acoustic: AcousticSums | None


@dataclass(frozen=True, eq=False, repr=False)
class LongPrepared(Prepared):
    """One long channel and what has been computed of it so far. Made by `prepare_long`.

    Parameters
    ----------
    samples : ndarray, shape (0,)
        None are held [unit of the channel].
    rate, kind, calibrated, mean, rms, stick_rate
        As in `features.named.prepared.Prepared`.
    read : callable
        From first and last sample to the samples between them, shape (n,).
    n_samples : int
        Of the channel.
    fine : Spectrum
        Of the samples as they are, in bins for one-third octaves.
    """

    read: Read = field(kw_only=True)
    n_samples: int = field(kw_only=True)
    fine: Spectrum = field(kw_only=True)

    @property
    def pieces(self) -> Pieces:
        """What gives the samples piece by piece, anew at each call."""
        return in_pieces(self.read, self.n_samples)

    @cached_property
    def in_band_power(self) -> float:
        """As in `Prepared`."""
        return self._passed.in_band.mean_square

    @cached_property
    def kurtosis(self) -> float:
        """As in `Prepared`."""
        return self._passed.in_band.raw_kurtosis

    @cached_property
    def in_band_share(self) -> float:
        """As in `Prepared`."""
        whole = self._passed.below.mean_square
        return self.in_band_power / whole if whole > 0.0 else 0.0

    @cached_property
    def spectrum(self) -> Spectrum:
        """As in `Prepared`."""
        return self._passed.spectrum

    @cached_property
    def harmonics(self) -> Harmonics:
        """As in `Prepared`."""
        return harmonics_of_period(
            self._passed.period,
            self.spectrum,
            self.floor,
            self.lines,
            duration=self._passed.duration,
            lowest=LOWEST,
            finer=self._finer,
        )

    @cached_property
    def short_time(self) -> ShortTime:
        """As in `Prepared`."""
        if self._passed.acoustic is None:
            raise ParameterError(f"a channel of {self.kind} is not described in short segments")
        return short_time_of(self._passed.acoustic.short_time)

    @cached_property
    def pulses(self) -> Pulses:
        """As in `Prepared`."""
        if self._passed.acoustic is None:
            raise ParameterError(f"a channel of {self.kind} is not searched for pulses")
        return self._passed.acoustic.pulses

    @cached_property
    def modulation(self) -> Modulation:
        """As in `Prepared`."""
        if self._passed.acoustic is None:
            raise ParameterError(f"of a channel of {self.kind} no modulation is told")
        return self._passed.acoustic.modulation

    @cached_property
    def slips(self) -> TorqueSlips:
        """As in `Prepared`."""
        return long_torque_slips(self.pieces, self.n_samples, self.rate)

    @cached_property
    def level_a(self) -> float:
        """As in `Prepared`."""
        reference = REFERENCES[self.kind]
        return weighted_levels(self.read, self.n_samples, self.rate, reference=reference).level_a

    @cached_property
    def fine_spectrum(self) -> Spectrum:
        """Of the signal divided by its rms value, in bins as for one-third octaves."""
        of = self.fine
        return Spectrum(of.frequency, of.density / self.rms**2, of.rate, of.n_segments)

    @cached_property
    def third_octaves(self) -> dict[str, float]:
        """As in `Prepared`."""
        return resolved_third_octaves(self.fine, reference=1.0)

    def _top_band(self, low: float, high: float) -> TopBand:
        acoustic = self._passed.acoustic
        if acoustic is None or high > usable_limit(self.rate):
            return TopBand(math.nan, math.nan)
        power = acoustic.top[TOP_BANDS.index((low, high))]
        level = relative_db(0.5 * power.mean, self.in_band_power)
        return TopBand(level, envelope_kurtosis(power) if level > LEAST_SHARE_DB else math.nan)

    def _blocks(self) -> tuple[Overlapped, Iterator[Transform]]:
        """Return blocks, and the transforms of the signal about its mean, over its rms value."""
        sizes = block_sizes(self.rate, *_BLOCK[self.kind in ACOUSTIC_KINDS])
        blocks = Overlapped(self.n_samples, self.rate, *sizes)

        def transforms() -> Iterator[Transform]:
            for piece in self.pieces():
                yield from blocks.add((piece - self.mean) / self.rms)
            yield from blocks.finish()

        return blocks, transforms()

    def _finer(self, resolution: float) -> Spectrum:
        blocks, transforms = self._blocks()
        working = min(WORKING_RATE, self.rate)
        inside = blocks.interior(working / self.rate)
        total = WelchSum(inside.n_samples, working, resolution)
        for transform in transforms:
            total.add(inside.of(band_signal(transform, self.low, self.limit)[0]))
        return total.spectrum()

    @cached_property
    def _passed(self) -> _Passed:
        blocks, transforms = self._blocks()
        rate = min(WORKING_RATE, self.rate)
        ratio = rate / self.rate
        inside, inside_too = blocks.interior(ratio), blocks.interior(ratio)
        n = inside.n_samples
        below, in_band = Moments(), Moments()
        spectrum = WelchSum(n, rate, line_resolution(n / rate))
        correlation = Correlation(n, rate, LOWEST)
        acoustic = None
        if self.kind in ACOUSTIC_KINDS:
            acoustic = Acoustic(blocks, self.rate, rate, n, (self.low, self.limit))
        for transform in transforms:
            below.add(inside_too.of(band_signal(transform, 0.0, self.limit)[0]))
            x = inside.of(band_signal(transform, self.low, self.limit)[0])
            for total in (in_band, spectrum, correlation):
                total.add(x)
            if acoustic is not None:
                acoustic.add(transform, x)
        highest = min(HIGHEST, self.limit)
        return _Passed(
            below,
            in_band,
            spectrum.spectrum(),
            correlation.period(highest=highest, whiten=True),
            n / rate,
            None if acoustic is None else acoustic.results(),
        )


def prepare_long(
    read: Read,
    n_samples: int,
    rate: float,
    kind: str,
    *,
    calibrated: bool = True,
    stick_rate: float = math.nan,
) -> LongPrepared:
    """Make a long signal ready for features.

    Parameters
    ----------
    read : callable
        From first and last sample to the samples of one channel between them, shape (n,), in its
        unit or, not calibrated, in fractions of full scale.
    n_samples : int
        Of the channel.
    rate : float
        Sampling rate [Hz].
    kind : str
        Of channel.
    calibrated : bool
        Whether the samples are in physical units.
    stick_rate : float
        Of a torque [N m/s].

    Returns
    -------
    LongPrepared

    Raises
    ------
    ParameterError
        A sample is no finite number.

    Examples
    --------
    >>> ones = np.ones(48_000)
    >>> prepare_long(lambda first, last: ones[first:last], 48_000, 48e3, "pressure").silent
    True
    """
    moments = Moments()
    fine = WelchSum(n_samples, rate, THIRD_OCTAVE_RESOLUTION)
    for piece in in_pieces(read, n_samples)():
        if not np.isfinite(piece).all():
            bad = int(np.flatnonzero(~np.isfinite(piece))[0])
            raise ParameterError(
                f"signal: sample {moments.n + bad} is {piece[bad]}; all samples must be finite"
            )
        for total in (moments, fine):
            total.add(piece)
    largest = max(abs(moments.lowest), abs(moments.highest))
    rms = math.sqrt(moments.variance)
    return LongPrepared(
        np.empty(0),
        rate,
        kind,
        calibrated,
        moments.mean,
        rms if rms > NOTHING * largest else 0.0,
        stick_rate,
        read=read,
        n_samples=n_samples,
        fine=fine.spectrum(),
    )
