"""Traces of a recording that a page draws, and the scales that make recordings comparable.

Autospectra are for comparing levels: those of one kind of channel share one axis over all
recordings of a page. Time histories are for seeing shapes: each has its own scale, which spans no
less than a twentieth of the largest, so that a quiet recording looks quiet. Recordings that are not
calibrated are compared among themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from features.kernels.spectra import Spectrum, autospectrum
from models.drawing import levels
from noise.pictures.channel_kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import NDArray

    from models.recording import Recording
    from noise.labels.segments import Segment

__all__ = ["HIGHEST", "LOWEST", "Scale", "Trace", "common_scales", "traces"]

LOWEST, HIGHEST = 20.0, 15e3
"""Ends of the frequency axis [Hz]: of hearing, and of creak (thesis, section 5.3)."""

_LEAST_SHARE = 1 / 20
_HEADROOM = 3.0  # above the highest level [dB]
_LEAST_SAMPLES = 16  # that have an autospectrum
_FULL_SCALE_QUIET = -60.0


@dataclass(frozen=True, eq=False)
class Trace:
    """One channel of a recording, as it is shown.

    Parameters
    ----------
    kind : str
        A key of `KINDS`.
    calibrated : bool
        Whether `samples` are in the channel's unit rather than in fractions of full scale.
    start : float
        When `samples` begin [s].
    rate : float
        Sampling rate [Hz].
    samples : ndarray, shape (n_shown,)
        The time history, in the unit of the channel or in fractions of full scale [-].
    spectrum : Spectrum
        Of the labelled segment, in the square of the samples' unit by Hz.
    analysed : tuple of 2 floats
        Start and end of that segment [s].
    """

    kind: str
    calibrated: bool
    start: float
    rate: float
    samples: NDArray[np.float64]
    spectrum: Spectrum
    analysed: tuple[float, float]

    @property
    def levels(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Frequencies [Hz] and density levels [dB] between `LOWEST` and `HIGHEST`.

        Returns
        -------
        frequency, level : ndarray, shape (n_lines,)
            [Hz] and [dB]
        """
        frequency = self.spectrum.frequency
        shown = (frequency >= LOWEST) & (frequency <= HIGHEST)
        reference = KINDS[self.kind].reference if self.calibrated else 1.0
        return frequency[shown], levels(self.spectrum.density[shown], reference)

    @property
    def swing(self) -> tuple[float, float]:
        """Middle of the time history and how far it swings to either side of it.

        A torque swings about where it is, everything else about zero.
        """
        low, high = float(self.samples.min()), float(self.samples.max())
        if self.kind == "torque":
            return (low + high) / 2.0, (high - low) / 2.0
        return 0.0, max(-low, high, 0.0)


@dataclass(frozen=True)
class Scale:
    """What the axes of one kind of channel have in common.

    Parameters
    ----------
    swing : float
        How far the largest time history swings to either side of its middle, in the samples' unit.
    reach : float
        The largest value of all, in the samples' unit.
    top : float
        Upper end of the spectra's axis [dB].
    """

    swing: float
    reach: float
    top: float

    @property
    def least_swing(self) -> float:
        """Half of what a time axis spans at least, in the samples' unit."""
        return _LEAST_SHARE * self.swing


def traces(recording: Recording, segment: Segment, window: float) -> tuple[Trace, ...]:
    """Take from a recording what is shown of it.

    Parameters
    ----------
    recording : Recording
    segment : Segment
        The time history is taken from its middle. Of several channels of a kind the segment's own
        is shown, else the first.
    window : float
        Length of the time history [s].

    Returns
    -------
    tuple of Trace
        One for each of `KINDS` that the recording has, in their order.

    Raises
    ------
    ParameterError
        A channel that cannot be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> silence = Recording(np.zeros((1, 9600)), 48e3, (Channel("pressure"),))
    >>> segment = Segment(channel="all", start=0.0, end=0.1, label="none",
    ...     probabilities={"none": 1.0}, frequency=None, level=None, level_dbfs=None)
    >>> [(trace.kind, trace.start, trace.samples.size) for trace in traces(silence, segment, 0.05)]
    [('pressure', 0.025, 2400)]
    """
    rate, n_samples = recording.rate, recording.samples.shape[1]
    first = max(0, round(segment.start * rate))
    last = min(n_samples, round(segment.end * rate))
    if last - first < _LEAST_SAMPLES:
        first, last = 0, n_samples
    n_shown = min(n_samples, max(2, round(window * rate)))
    begin = min(max(0, (first + last - n_shown) // 2), n_samples - n_shown)
    own = _own_channel(recording, segment.channel)
    found = []
    for kind in KINDS:
        names = [channel.name for channel in recording.channels if channel.kind == kind]
        if not names:
            continue
        signal = recording[own if own in names else names[0]]
        found.append(
            Trace(
                kind=kind,
                calibrated=recording.calibrated,
                start=begin / rate,
                rate=rate,
                samples=signal[begin : begin + n_shown],
                spectrum=autospectrum(signal[first:last], rate),
                analysed=(first / rate, last / rate),
            )
        )
    return tuple(found)


def _own_channel(recording: Recording, channel: str) -> str:
    if channel.isdecimal() and 1 <= int(channel) <= len(recording.channels):
        return recording.channel_names[int(channel) - 1]
    return channel


def common_scales(drawn: Iterable[Trace]) -> dict[tuple[str, bool], Scale]:
    """Find the scales that traces of one kind share.

    Parameters
    ----------
    drawn : iterable of Trace
        All traces of a page.

    Returns
    -------
    dict
        Keys are (kind, calibrated).

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> t = np.arange(9600) / 48e3
    >>> tone = Recording(np.sin(2e3 * np.pi * t)[None], 48e3, (Channel("pressure"),))
    >>> segment = Segment(channel="all", start=0.0, end=0.2, label="squeal",
    ...     probabilities={"squeal": 1.0}, frequency=1e3, level=91.0, level_dbfs=None)
    >>> common_scales(traces(tone, segment, 0.05))
    {('pressure', True): Scale(swing=1.0, reach=1.0, top=90.0)}
    """
    scales: dict[tuple[str, bool], Scale] = {}
    for trace in drawn:
        kind, key = KINDS[trace.kind], (trace.kind, trace.calibrated)
        middle, swing = trace.swing
        swing = max(swing, kind.least_swing)
        quiet = kind.quiet if trace.calibrated else _FULL_SCALE_QUIET
        _, levels = trace.levels
        highest = float(levels.max(initial=-math.inf)) + _HEADROOM
        top = 10.0 * math.ceil(max(highest, quiet) / 10.0)
        known = scales.get(key, Scale(swing, abs(middle) + swing, top))
        scales[key] = Scale(
            swing=max(known.swing, swing),
            reach=max(known.reach, abs(middle) + swing),
            top=max(known.top, top),
        )
    return scales
