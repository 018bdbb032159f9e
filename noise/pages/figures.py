"""Figures of a page: time history and autospectrum of each channel.

Each panel is an SVG of its own, so that a page lays them out as two columns on a projector and as
one on a telephone, and print stays sharp. No pyplot: a library must not touch the caller's figures,
settings or screen. Autospectra of one kind of channel share one axis over all recordings of a page.
Time histories show shapes: each has its own scale, which spans no less than a twentieth of the
largest, so that a quiet recording looks quiet. Recordings that are not calibrated are compared
among themselves.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator
from numpy.typing import NDArray

from features.kernels.slips import torque_slips
from features.kernels.spectra import Spectrum, autospectrum
from models.drawing import frequency_axis, levels, styled, thinned
from models.recording import Recording
from noise.pages.blocks import Panels
from noise.pictures.figure import KINDS

if TYPE_CHECKING:
    from noise.labels.segments import Segment


COLUMNS = 500
"""Steps across a panel that the eye can tell apart."""

_SIZE = (5.2, 2.5)  # [inch]
_AXES = (0.19, 0.215, 0.765, 0.665)
_TICKS = (20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3)  # [Hz]


@dataclass(frozen=True)
class Panel:
    """SVG picture with alternative text."""

    svg: bytes
    alt: str


def as_svg(figure: Figure) -> bytes:
    """Return a figure as reproducible SVG bytes.

    Examples
    --------
    >>> as_svg(Figure())[:5]
    b'<?xml'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()


@dataclass(frozen=True, eq=False)
class Line:
    """Curve of a panel.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        In the units of the axes [-].
    colour, label : str
    width : float
        [point]
    style : str
        Of matplotlib; "dashes" are long ones.
    """

    x: NDArray[np.floating[Any]]
    y: NDArray[np.floating[Any]]
    colour: str
    label: str = ""
    width: float = 1.5
    style: str = "-"


Ends = tuple[float, float]

_STYLES: dict[str, Any] = {"": "none", "dashes": (0.0, (4.0, 2.0))}


def lines_panel(
    title: str,
    across: str,
    up: str,
    lines: Sequence[Line],
    alt: str,
    *,
    across_ends: Ends | None = None,
    up_ends: Ends | None = None,
    frequencies: Ends | None = None,
    steps: int = 0,
    legend: str = "",
    room: Ends = (0.0, 0.0),
    inside: str = "",
) -> Panel:
    """Draw lines within `models.drawing.styled`.

    Parameters
    ----------
    title, across, up : str
    lines : sequence of Line
    alt : str
        What the panel shows, in words.
    across_ends, up_ends : tuple of float, optional
        Ends of the axes, in their units [-]; by default what the lines need.
    frequencies : tuple of float, optional
        Ends of the horizontal axis where it is one of frequency [Hz].
    steps : int
        Into how many steps the vertical axis is divided at most; 0 leaves it to matplotlib [-].
    legend : str
        Where it stands; none by default.
    room : tuple of float
        For it below and above the lines, as a share of what they span [-].
    inside : str
        What stands at the bottom of the panel.

    Examples
    --------
    >>> line = Line(np.arange(2.0), np.ones(2), "#222222")
    >>> lines_panel("Torque", "Time [ms]", "Torque [Nm]", [line], "1 Nm throughout.").alt
    '1 Nm throughout.'
    """
    figure = Figure(figsize=_SIZE)
    axes = figure.add_axes(_AXES)
    axes.set_title(title, loc="left", fontweight="bold", color="#222222")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    # At the same place in every panel, however wide the numbers are.
    axes.yaxis.set_label_coords(-0.19, 0.5)
    for one in lines:
        axes.plot(
            one.x, one.y, color=one.colour, label=one.label or None, lw=one.width,
            ls=_STYLES.get(one.style, one.style),
        )  # fmt: skip
    low, high = up_ends or axes.get_ylim()
    axes.set_ylim(low - room[0] * (high - low), high + room[1] * (high - low))
    if steps:
        axes.yaxis.set_major_locator(MaxNLocator(steps, steps=[1, 2, 2.5, 5, 10]))
        axes.ticklabel_format(axis="y", style="plain", useOffset=False)
    if across_ends is not None:
        axes.set_xlim(*across_ends)
    if frequencies is not None:
        frequency_axis(axes, *frequencies)
        ticks = [tick for tick in _TICKS if frequencies[0] <= tick <= frequencies[1]]
        axes.xaxis.set_major_locator(FixedLocator(ticks))
    if inside:
        axes.text(0.5, 0.08, inside, transform=axes.transAxes, ha="center")
    if legend:
        axes.legend(loc=legend, fontsize=8)  # type: ignore[call-overload]
    return Panel(as_svg(figure), alt)


LEAD = 0.25
"""Of a window about a slip, before it [-]."""


def cycle_window(torque: NDArray[np.float64], rate: float, length: float) -> tuple[float, bool]:
    """Return the interval in which a torque is shown.

    Parameters
    ----------
    torque : ndarray, shape (n_samples,)
        [N m]
    rate, length : float
        [Hz], [s]

    Returns
    -------
    start : float
        Such that the slip nearest to the middle lies a quarter of `length` behind it [s].
    aligned : bool
        False where there is no slip, and the middle is taken.

    Examples
    --------
    >>> t = np.arange(30000) / 30e3
    >>> start, aligned = cycle_window(8.0 + 2.7 * ((100.0 * t) % 1.0), 30e3, 0.04)
    >>> aligned, round(1e3 * (start + 0.01) % 10.0) % 10
    (True, 0)
    """
    duration = torque.size / rate
    times = torque_slips(torque, rate).times
    inside = times[(times >= LEAD * length) & (times <= duration - (1.0 - LEAD) * length)]
    if not inside.size:
        return max(0.0, 0.5 * (duration - length)), False
    slip = inside[np.abs(inside - 0.5 * duration).argmin()]
    return float(slip) - LEAD * length, True


LOWEST, HIGHEST = 20.0, 15e3
"""Ends of the frequency axis [Hz]: of hearing, and of creak (thesis, section 5.3)."""

WINDOW = 0.05
"""Length of the time histories [s]: two slips of a creak at 40 Hz, and no more than some fifty
cycles of a squeal, which is as many as a panel keeps apart."""

_LEAST_SHARE = 1 / 20
_HEADROOM = 3.0  # above the highest level [dB]
_LEAST_SAMPLES = 16  # that have an autospectrum
_FULL_SCALE_QUIET = -60.0
_DYNAMIC_RANGE = 120.0  # of a spectrum's axis [dB]
_PREFIXES = ((5e-4, 1e6, "µ", "ppm "), (0.5, 1e3, "m", "‰ "))  # of values below


@dataclass(frozen=True, eq=False)
class _Trace:
    """Channel: samples from `start` [s], spectral levels [dB] of the segment."""

    kind: str
    calibrated: bool
    start: float
    rate: float
    samples: NDArray[np.float64]
    spectrum: Spectrum
    frequency: NDArray[np.float64]
    level: NDArray[np.float64]

    @property
    def swing(self) -> tuple[float, float]:
        """Middle and half-range; the middle is zero for all but torque."""
        low, high = float(self.samples.min()), float(self.samples.max())
        least = KINDS[self.kind].least_swing
        if self.kind == "torque":
            return (low + high) / 2.0, max((high - low) / 2.0, least)
        return 0.0, max(-low, high, least)

    @property
    def top(self) -> float:
        """Upper end of the spectrum axis [dB]."""
        quiet = KINDS[self.kind].quiet if self.calibrated else _FULL_SCALE_QUIET
        highest = float(self.level.max(initial=-math.inf)) + _HEADROOM
        return 10.0 * math.ceil(max(highest, quiet) / 10.0)


def recording_panels(entries: Sequence[tuple[Recording, Segment]]) -> list[Panels]:
    """Draw torque, acceleration and sound pressure of recordings on comparable axes.

    Parameters
    ----------
    entries : sequence of (Recording, Segment)
        The time history is taken from the middle of the segment, the autospectrum is the
        segment's. Of several channels of a kind the segment's own is drawn, else the first.

    Returns
    -------
    list of Panels
        Of each recording, two pictures a channel.

    Raises
    ------
    ParameterError
        A channel cannot be analysed.

    Notes
    -----
    The panels are those of the thesis's Figures 5.21 to 5.24.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> hiss = Recording(np.random.default_rng(1).normal(size=(1, 9600)), 48e3,
    ...                  (Channel("pressure"),))
    >>> segment = Segment(channel="all", start=0.0, end=0.2, label="unknown",
    ...     probabilities={"unknown": 1.0}, frequency=None, level=94.0, level_dbfs=None)
    >>> (found,) = recording_panels([(hiss, segment)])
    >>> found.pictures[0].alt[:39]
    'Sound pressure over 50 ms from 0.075 s:'
    """
    drawn = [_traces(*entry) for entry in entries]
    alike: dict[tuple[str, bool], list[_Trace]] = {}
    for trace in (trace for traces in drawn for trace in traces):
        alike.setdefault((trace.kind, trace.calibrated), []).append(trace)
    panels = []
    with styled():
        for (_, segment), traces in zip(entries, drawn, strict=True):
            pictures: list[Panel] = []
            for trace in traces:
                others = alike[trace.kind, trace.calibrated]
                pictures += [
                    _time_panel(trace, others),
                    _spectrum_panel(trace, max(of.top for of in others), segment.frequency),
                ]
            panels.append(Panels(pictures, _caption(traces, segment)))
    return panels


def _traces(recording: Recording, segment: Segment) -> list[_Trace]:
    rate, n_samples = recording.rate, recording.samples.shape[1]
    first = max(0, round(segment.start * rate))
    last = min(n_samples, round(segment.end * rate))
    if last - first < _LEAST_SAMPLES:
        first, last = 0, n_samples
    n_shown = min(n_samples, max(2, round(WINDOW * rate)))
    begin = min(max(0, (first + last - n_shown) // 2), n_samples - n_shown)
    own = segment.channel
    if own.isdecimal() and 1 <= int(own) <= len(recording.channels):
        own = recording.channel_names[int(own) - 1]
    traces = []
    for kind in KINDS:
        names = [channel.name for channel in recording.channels if channel.kind == kind]
        if not names:
            continue
        signal = recording[own if own in names else names[0]]
        spectrum = autospectrum(signal[first:last], rate)
        shown = (spectrum.frequency >= LOWEST) & (spectrum.frequency <= HIGHEST)
        reference = KINDS[kind].reference if recording.calibrated else 1.0
        traces.append(
            _Trace(
                kind, recording.calibrated, begin / rate, rate, signal[begin : begin + n_shown],
                spectrum, spectrum.frequency[shown], levels(spectrum.density[shown], reference),
            )
        )  # fmt: skip
    return traces


def _time_panel(trace: _Trace, alike: Sequence[_Trace]) -> Panel:
    kind, (middle, swing) = KINDS[trace.kind], trace.swing
    largest = max(of.swing[1] for of in alike)
    reach = max(abs(of.swing[0]) + of.swing[1] for of in alike)
    swing = 1.08 * max(swing, _LEAST_SHARE * largest)
    factor, unit = 1.0, kind.unit if trace.calibrated else "FS"
    for below, larger, prefix, share in reversed(_PREFIXES):
        if reach < below:
            factor, unit = larger, f"{prefix}{kind.unit}" if trace.calibrated else f"{share}FS"
    t = np.arange(trace.samples.size, dtype=np.float64) * (1e3 / trace.rate)
    length = 1e3 * trace.samples.size / trace.rate
    low, high = factor * float(trace.samples.min()), factor * float(trace.samples.max())
    return lines_panel(
        kind.name, f"Time from {trace.start:.3f} s [ms]", f"{kind.name} [{unit}]",
        [Line(*thinned(t, factor * trace.samples, columns=COLUMNS), kind.colour, width=1.2)],
        f"{kind.name} over {length:.3g} ms from {trace.start:.3f} s: between {low:.3g} and "
        f"{high:.3g} {unit}.",
        across_ends=(0.0, length),
        up_ends=(factor * (middle - swing), factor * (middle + swing)),
        steps=5,
    )  # fmt: skip


def _spectrum_panel(trace: _Trace, top: float, frequency: float | None) -> Panel:
    kind, f = KINDS[trace.kind], trace.frequency
    density = kind.density if trace.calibrated else "FS²/Hz"
    inside, bottom = "", top - _DYNAMIC_RANGE
    drawn = np.maximum(trace.level, bottom - 5.0)
    lines = [Line(*thinned(f, drawn, position=np.log(f), columns=COLUMNS), kind.colour, width=1.0)]
    if frequency is not None and LOWEST <= frequency <= HIGHEST:
        at, ends = np.full(2, frequency), np.array([bottom, top])
        lines.insert(0, Line(at, ends, "#777777", width=1.0, style="dashes"))
    alt = f"Autospectrum of the {kind.name.lower()} from 20 Hz to 15 kHz: "
    if trace.level.max(initial=-math.inf) >= bottom:
        peak = int(trace.level.argmax())
        alt += f"highest at {f[peak]:.0f} Hz with {trace.level[peak]:.0f} dB re {density}."
    else:
        inside = "below this axis"
        alt += f"all below {bottom:.0f} dB re {density}."
    return lines_panel(
        f"{kind.name}, autospectrum", "Frequency [Hz]", f"dB re {density}", lines, alt,
        up_ends=(bottom, top), frequencies=(LOWEST, HIGHEST), steps=6, inside=inside,
    )  # fmt: skip


def _caption(traces: Sequence[_Trace], segment: Segment) -> str:
    if not traces:
        return "The recording has no channel of torque, acceleration or sound pressure."
    spectrum = traces[0].spectrum
    return (
        f"Time histories: {1e3 * traces[0].samples.size / traces[0].rate:.3g} ms from the middle "
        f"of the labelled segment. Autospectra: the segment from {segment.start:.2f} to "
        f"{segment.end:.2f} s, one-sided power spectral density, Hann window, bins of "
        f"{spectrum.spacing:.3g} Hz, mean of {spectrum.n_segments}; the dashed line marks the "
        "dominant frequency."
    )
