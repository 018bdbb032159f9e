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
from features.kernels.conditioning import (
    NOTHING,
    WORKING_RATE,
    band_analytic,
    band_signal,
    usable_limit,
)
from features.kernels.harmonics import HIGHEST, LOWEST, Harmonics, harmonics_of_period
from features.kernels.levels import weighted_levels
from features.kernels.lines import line_resolution
from features.kernels.modulation import MODULATION_BAND, Modulation, described_modulation
from features.kernels.short_time import (
    DescribedSegments,
    describe_segments,
    segment_lengths,
    short_time_of,
)
from features.kernels.slip_pulses import pulse_band_from, squared
from features.kernels.spectra import Spectrum
from features.long.overlapped import Overlapped, block_sizes
from features.long.parts import in_pieces
from features.long.pulses import LongPulses, envelope_kurtosis
from features.long.slips import long_torque_slips
from features.long.sums import Correlation, Moments, SegmentPowers, WelchSum
from features.named.prepared import ACOUSTIC_KINDS, TOP_BANDS, Prepared, TopBand
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from features.kernels.conditioning import Transform
    from features.kernels.periodicity import Period
    from features.kernels.short_time import ShortTime
    from features.kernels.slip_drops import TorqueSlips
    from features.kernels.slip_pulses import Pulses
    from features.long.parts import Pieces, Read

__all__ = ["LongPrepared", "prepare_long"]

_BLOCK = {True: (8.0, 1.0), False: (16.0, 8.0)}
"""Useful length and margin of a block [s]: the flank of a torque's band, at 5 Hz, rings longer."""

_ENVELOPE_BLOCK = (32.0, 4.0)
"""The same, where the modulation of an envelope is told [s]: from 2 Hz on."""

_WHOLE_RATE, _HIGH_RATE, _TOP_RATES = 0.625, 0.5, (0.75, 0.875)
"""Rates of envelopes over the working rate: of the whole band, its high part, what lies above."""


class _Passed(NamedTuple):
    """What one pass over the bands of a signal tells."""

    below: Moments
    in_band: Moments
    spectrum: Spectrum
    period: Period
    duration: float
    short_time: DescribedSegments | None
    pulses: Pulses | None
    modulation: Modulation | None
    top: tuple[Moments, ...]


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
        described = self._passed.short_time
        if described is None:
            raise ParameterError(f"a channel of {self.kind} is not described in short segments")
        return short_time_of(described)

    @cached_property
    def pulses(self) -> Pulses:
        """As in `Prepared`."""
        if self._passed.pulses is None:
            raise ParameterError(f"a channel of {self.kind} is not searched for pulses")
        return self._passed.pulses

    @cached_property
    def modulation(self) -> Modulation:
        """As in `Prepared`."""
        if self._passed.modulation is None:
            raise ParameterError(f"of a channel of {self.kind} no modulation is told")
        return self._passed.modulation

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
        if high > usable_limit(self.rate):
            return TopBand(math.nan, math.nan)
        power = self._passed.top[TOP_BANDS.index((low, high))]
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
        working = _working_rate(self.rate)
        inside = blocks.interior(working / self.rate)
        total = WelchSum(inside.n_samples, working, resolution)
        for transform in transforms:
            total.add(inside.of(band_signal(transform, self.low, self.limit)[0]))
        return total.spectrum()

    @cached_property
    def _passed(self) -> _Passed:
        blocks, transforms = self._blocks()
        rate = _working_rate(self.rate)
        ratio = rate / self.rate
        inside, inside_too = blocks.interior(ratio), blocks.interior(ratio)
        n = inside.n_samples
        below, in_band = Moments(), Moments()
        spectrum = WelchSum(n, rate, line_resolution(n / rate))
        correlation = Correlation(n, rate, LOWEST)
        acoustic = None
        if self.kind in ACOUSTIC_KINDS:
            acoustic = _Acoustic(blocks, self.rate, rate, n, (self.low, self.limit))
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
            *((None, None, None, ()) if acoustic is None else acoustic.results()),
        )


class _Acoustic:
    """What only sound and acceleration are asked for, summed up block by block."""

    def __init__(
        self, blocks: Overlapped, rate: float, working: float, n: int, band: tuple[float, float]
    ) -> None:
        self._rate, self._working, self._band = rate, working, band
        segment, self._length, self._lobe = segment_lengths(n, working)
        self._segments = SegmentPowers(n, segment)
        self._described: list[DescribedSegments] = []
        self._bands: NDArray[np.float64] | None = None
        self._start = blocks.lead / rate
        self._inside = [blocks.interior(s * working / rate) for s in (_WHOLE_RATE, _HIGH_RATE)]
        self._power, self._high_power = Moments(), Moments()
        self._pulses = LongPulses(_HIGH_RATE * working)
        self._envelope = _LongModulation(self._inside[0].n_samples, _WHOLE_RATE * working)
        self._top = [
            (limits, share, blocks.interior(share * working / rate), Moments())
            for limits, share in zip(TOP_BANDS, _TOP_RATES, strict=True)
        ]

    def add(self, transform: Transform, x: NDArray[np.float64]) -> None:
        low, high = self._band
        for power in self._segments.add(x):
            described, self._bands = describe_segments(
                power, self._working / self._length, self._lobe, low=low, high=high,
                before=self._bands,
            )  # fmt: skip
            self._described.append(described)
        whole, _ = band_analytic(transform, low, high, rate=_WHOLE_RATE * self._working)
        power = squared(self._inside[0].of(whole))
        self._power.add(power)
        self._envelope.add(np.sqrt(power))
        pulsed = pulse_band_from(high)
        top, _ = band_analytic(transform, pulsed, high, rate=_HIGH_RATE * self._working)
        power = squared(self._inside[1].of(top))
        self._high_power.add(power)
        self._pulses.add(power)
        for (begin, end), share, inside, moments in self._top:
            if end <= usable_limit(self._rate):
                top, _ = band_analytic(transform, begin, end, rate=share * self._working)
                moments.add(squared(inside.of(top)))

    def results(
        self,
    ) -> tuple[DescribedSegments, Pulses, Modulation, tuple[Moments, ...]]:
        described = DescribedSegments(*map(np.concatenate, zip(*self._described, strict=True)))
        pulses = self._pulses.pulses(self._power, self._high_power, self._start)
        modulation = self._envelope.modulation()
        return described, pulses, modulation, tuple(moments for *_, moments in self._top)


class _LongModulation:
    """Modulation of an envelope that comes piece by piece."""

    def __init__(self, n_samples: int, rate: float) -> None:
        low, high = MODULATION_BAND
        self._band = (low, min(high, 0.4 * rate))
        self._blocks = Overlapped(n_samples, rate, *block_sizes(rate, *_ENVELOPE_BLOCK))
        self._envelope, self._beats = Moments(), Moments()
        self._about = math.nan
        ratio = min(1.0, self._band[1] / usable_limit(rate))
        self._inside = self._blocks.interior(ratio)
        self._correlation = Correlation(self._inside.n_samples, ratio * rate, low)

    def add(self, envelope: NDArray[np.float64]) -> None:
        if not envelope.size:
            return
        if not self._envelope.n:  # the mean is faded in and out, and should be near nothing
            self._about = float(envelope.mean())
        self._envelope.add(envelope)
        self._take(self._blocks.add(envelope - self._about))

    def modulation(self) -> Modulation:
        self._take(self._blocks.finish())
        return described_modulation(
            self._envelope.mean,
            math.sqrt(self._beats.variance),
            lambda: self._correlation.period(highest=MODULATION_BAND[1]),
        )

    def _take(self, transforms: Iterator[Transform]) -> None:
        for transform in transforms:
            beats = self._inside.of(band_signal(transform, *self._band)[0])
            self._beats.add(beats)
            self._correlation.add(beats)


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


def _working_rate(rate: float) -> float:
    return min(WORKING_RATE, rate)
