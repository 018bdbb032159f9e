"""What only a long sound or acceleration is asked for, summed up block by block.

Its short segments, pulses, the modulation of its envelope, and what lies above its other bands.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from features.kernels.conditioning import band_analytic, band_signal, usable_limit
from features.kernels.modulation import MODULATION_BAND, Modulation, described_modulation
from features.kernels.short_time import DescribedSegments, describe_segments, segment_lengths
from features.kernels.slip_pulses import pulse_band_from, squared
from features.long.overlapped import Overlapped, block_sizes
from features.long.pulses import LongPulses
from features.long.sums import Correlation, Moments, SegmentPowers
from features.named.prepared import TOP_BANDS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from features.kernels.conditioning import Transform
    from features.kernels.slip_pulses import Pulses

__all__ = ["Acoustic", "AcousticSums"]

_ENVELOPE_BLOCK = (32.0, 4.0)
"""Useful length and margin of a block where an envelope's modulation is told [s]: from 2 Hz on."""

_WHOLE_RATE, _HIGH_RATE, _TOP_RATES = 0.625, 0.5, (0.75, 0.875)
"""Rates of envelopes over the working rate: of the whole band, its high part, what lies above."""


class AcousticSums(NamedTuple):
    """What comes of them: short segments, pulses, modulation, power of each band above."""

    short_time: DescribedSegments
    pulses: Pulses
    modulation: Modulation
    top: tuple[Moments, ...]


class Acoustic:
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
        """Take a block.

        Parameters
        ----------
        transform : Transform
            Of all of it.
        x : ndarray, shape (n,)
            Its useful part in the working band [unit of the channel].
        """
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

    def results(self) -> AcousticSums:
        """Return what came of all blocks."""
        described = DescribedSegments(*map(np.concatenate, zip(*self._described, strict=True)))
        pulses = self._pulses.pulses(self._power, self._high_power, self._start)
        modulation = self._envelope.modulation()
        return AcousticSums(
            described, pulses, modulation, tuple(moments for *_, moments in self._top)
        )


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
