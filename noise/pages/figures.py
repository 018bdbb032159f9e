"""Figures of a page: time history and autospectrum of each channel of a recording, a panel each.

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
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator
from numpy.typing import NDArray

from features.kernels.spectra import Spectrum, autospectrum
from models.drawing import frequency_axis, levels, styled, thinned
from models.errors import ParameterError
from models.recording import Recording
from noise.pictures.figure import KINDS, Kind

if TYPE_CHECKING:
    from noise.labels.segments import Segment


COLUMNS = 500
"""Steps across a panel that the eye can tell apart."""

_SIZE = (5.2, 2.5)  # [inch]
_AXES = (0.19, 0.215, 0.785, 0.665)
_TICKS = (20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3)  # [Hz]


@dataclass(frozen=True)
class Panel:
    """One picture: an SVG file's bytes, and in words what it shows."""

    svg: bytes
    alt: str


def as_svg(figure: Figure) -> bytes:
    """Write a figure out, the same one as the same bytes.

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
    """A curve of a panel.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        In the units of the axes [-].
    colour, label : str
    width : float
        [point]
    style, marker : str
        Of matplotlib; "dashes" are long ones.
    low, high : ndarray, shape (n,), optional
        Between which it is coloured, in the unit of the vertical axis [-].
    """

    x: NDArray[np.floating[Any]]
    y: NDArray[np.floating[Any]]
    colour: str
    label: str = ""
    width: float = 1.5
    style: str = "-"
    marker: str = ""
    low: NDArray[np.floating[Any]] | None = None
    high: NDArray[np.floating[Any]] | None = None


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
    """Draw lines, to be called within `models.drawing.styled`.

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
        if one.low is not None and one.high is not None:
            axes.fill_between(one.x, one.low, one.high, color=one.colour, alpha=0.18, linewidth=0)
        axes.plot(
            one.x, one.y, color=one.colour, label=one.label or None, lw=one.width,
            ls=_STYLES.get(one.style, one.style), marker=one.marker,
            ms=2 if one.marker == "." else 4,
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


WINDOW = 0.05
"""Length of the time histories [s]: two slips of a creak at 40 Hz, and no more than some fifty
cycles of a squeal, which is as many as a panel keeps apart."""

_DYNAMIC_RANGE = 120.0  # of a spectrum's axis [dB]
_PREFIXES = ((5e-4, 1e6, "µ", "ppm "), (0.5, 1e3, "m", "‰ "))  # of values below


@dataclass(frozen=True)
class ChannelPanels:
    """The two pictures of one channel; `kind` as in `models.recording.CHANNEL_UNITS`."""

    kind: str
    time: Panel
    spectrum: Panel


@dataclass(frozen=True)
class EntryFigure:
    """Pictures of all channels of one recording that are shown, which may be none.

    Parameters
    ----------
    rows : tuple of ChannelPanels
        In the order torque, acceleration, pressure.
    caption : str
        What was computed from which part of the recording.
    """

    rows: tuple[ChannelPanels, ...]
    caption: str

    @property
    def panels(self) -> tuple[Panel, ...]:
        """All pictures, row by row."""
        return tuple(panel for row in self.rows for panel in (row.time, row.spectrum))


def entry_figures(
    entries: Sequence[tuple[Recording, Segment]], *, window: float = WINDOW
) -> tuple[EntryFigure, ...]:
    """Draw torque, acceleration and sound pressure of recordings, comparable with one another.

    Parameters
    ----------
    entries : sequence of (Recording, Segment)
        The time history is taken from the middle of the segment, the autospectrum is the
        segment's. Of several channels of a kind the segment's own is drawn, else the first.
    window : float
        Length of the time histories [s].

    Returns
    -------
    tuple of EntryFigure
        One an entry.

    Raises
    ------
    ParameterError
        A window that is not positive, or a channel that cannot be analysed.

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
    >>> (figure,) = entry_figures([(hiss, segment)])
    >>> [row.kind for row in figure.rows], figure.rows[0].time.alt[:39]
    (['pressure'], 'Sound pressure over 50 ms from 0.075 s:')
    """
    if not (math.isfinite(window) and window > 0):
        raise ParameterError(f"window is {window}; it is a positive number of seconds")
    drawn = [traces(recording, segment, window) for recording, segment in entries]
    scales = common_scales(trace for entry in drawn for trace in entry)
    figures = []
    with styled():
        for (_, segment), entry in zip(entries, drawn, strict=True):
            rows = []
            for trace in entry:
                scale = scales[trace.kind, trace.calibrated]
                spectrum = _spectrum_panel(trace, scale, segment.frequency)
                rows.append(ChannelPanels(trace.kind, _time_panel(trace, scale), spectrum))
            figures.append(EntryFigure(tuple(rows), _caption(entry)))
    return tuple(figures)


def _time_panel(trace: Trace, scale: Scale) -> Panel:
    kind = KINDS[trace.kind]
    middle, swing = trace.swing
    swing = 1.08 * max(swing, scale.least_swing, kind.least_swing)
    factor, unit = _display_unit(kind, scale.reach, calibrated=trace.calibrated)
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


def _spectrum_panel(trace: Trace, scale: Scale, frequency: float | None) -> Panel:
    kind = KINDS[trace.kind]
    density = kind.density if trace.calibrated else "FS²/Hz"
    inside, bottom = "", scale.top - _DYNAMIC_RANGE
    f, levels = trace.levels
    drawn = np.maximum(levels, bottom - 5.0)
    lines = [Line(*thinned(f, drawn, position=np.log(f), columns=COLUMNS), kind.colour, width=1.0)]
    if frequency is not None and LOWEST <= frequency <= HIGHEST:
        at, ends = np.full(2, frequency), np.array([bottom, scale.top])
        lines.insert(0, Line(at, ends, "#777777", width=1.0, style="dashes"))
    alt = f"Autospectrum of the {kind.name.lower()} from 20 Hz to 15 kHz: "
    if levels.max(initial=-math.inf) >= bottom:
        peak = int(levels.argmax())
        alt += f"highest at {f[peak]:.0f} Hz with {levels[peak]:.0f} dB re {density}."
    else:
        inside = "below this axis"
        alt += f"all below {bottom:.0f} dB re {density}."
    return lines_panel(
        f"{kind.name}, autospectrum", "Frequency [Hz]", f"dB re {density}", lines, alt,
        up_ends=(bottom, scale.top), frequencies=(LOWEST, HIGHEST), steps=6, inside=inside,
    )  # fmt: skip


def _caption(entry: Sequence[Trace]) -> str:
    if not entry:
        return "The recording has no channel of torque, acceleration or sound pressure."
    start, end = entry[0].analysed
    spectrum = entry[0].spectrum
    return (
        f"Time histories: {1e3 * entry[0].samples.size / entry[0].rate:.3g} ms from the middle of "
        f"the labelled segment. Autospectra: the segment from {start:.2f} to {end:.2f} s, "
        f"one-sided power spectral density, Hann window, bins of {spectrum.spacing:.3g} Hz, mean "
        f"of {spectrum.n_segments}; the dashed line marks the dominant frequency."
    )


def _display_unit(kind: Kind, reach: float, *, calibrated: bool) -> tuple[float, str]:
    for below, factor, prefix, share in _PREFIXES:
        if reach < below:
            return factor, f"{prefix}{kind.unit}" if calibrated else f"{share}FS"
    return 1.0, kind.unit if calibrated else "FS"
