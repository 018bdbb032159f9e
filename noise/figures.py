"""Figures of a recording for the review page: time history and autospectrum of each channel.

Each panel is an SVG of its own with axes in the same place, so a page lays them out as two columns
on a projector and as one on a telephone, and print stays sharp. Autospectra are for comparing
levels: those of one kind of channel share their axes over all recordings given. Time histories are
for seeing shapes: each has its own scale, but spans no less than a twentieth of the largest, so
that a quiet recording looks quiet. The colour tells the channel; blue, green and near-black are
told apart by every eye (Okabe and Ito, Color universal design, 2008). No pyplot: a library must
not touch the caller's figures or open a window.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import matplotlib.style
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

from features.spectra import DEFAULT_RESOLUTION, Spectrum, autospectrum
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from models.recording import Recording
    from noise.segments import Segment

__all__ = ["WINDOW", "ChannelPanels", "EntryFigure", "Panel", "entry_figures"]

WINDOW = 0.05
"""Length of the time histories [s]: four slips at 80 Hz, where creak is slowest, and no more than
some fifty cycles of a squeal."""

_LOWEST, _HIGHEST = 20.0, 15e3  # frequency axis [Hz], to the upper end of creak (section 5.3)
_TICKS = {20: "20", 50: "50", 100: "100", 200: "200", 500: "500"}
_TICKS |= {1000: "1k", 2000: "2k", 5000: "5k", 10000: "10k"}
_DYNAMIC_RANGE = 100.0  # of a spectrum's axis [dB]
_LEAST_SHARE = 1 / 20  # of the largest time history, that the axis of every other one spans
_COLUMNS = 500  # steps across a panel that the eye can tell apart
_LEAST_SAMPLES = 16  # that have an autospectrum
_SMALLEST = 1e-60  # stands for a density of zero
_SIZE = (5.2, 2.5)  # of a panel [inch]
_AXES = (0.15, 0.215, 0.835, 0.665)

_STYLE = {
    "svg.fonttype": "path",  # the same on every machine, whatever fonts it has
    "svg.hashsalt": "bushing-noise",
    "font.family": "DejaVu Sans",
    "font.size": 11.0,
    "axes.titlesize": 11.5,
    "xtick.labelsize": 10.5,
    "ytick.labelsize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#444444",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.7,
    "lines.solid_joinstyle": "round",
}


@dataclass(frozen=True)
class Panel:
    """One picture: an SVG file's bytes, and in words what it shows."""

    svg: bytes
    alt: str


@dataclass(frozen=True)
class ChannelPanels:
    """The two pictures of one channel; `kind` as in `models.recording.CHANNEL_UNITS`."""

    kind: str
    time: Panel
    spectrum: Panel


@dataclass(frozen=True)
class EntryFigure:
    """Pictures of all channels shown of one recording, none of which need be there.

    Parameters
    ----------
    rows : tuple of ChannelPanels
        In the order torque, acceleration, pressure.
    caption : str
        What was computed from which part of the recording.
    """

    rows: tuple[ChannelPanels, ...]
    caption: str


@dataclass(frozen=True)
class _Kind:
    name: str
    unit: str
    colour: str
    reference: float  # of levels, in the channel's unit (ISO 1683 where it has one)
    reference_text: str
    least: float  # half of what a time axis spans at least, in the channel's unit
    quiet: float  # least upper end of a spectrum's axis [dB]


_KINDS = {
    "torque": _Kind("Torque", "Nm", "#0072b2", 1.0, "(1 Nm)²/Hz", 0.1, -40.0),
    "acceleration": _Kind(
        "Beam acceleration", "m/s²", "#008060", 1e-6, "(1 µm/s²)²/Hz", 0.1, 80.0
    ),
    "pressure": _Kind("Sound pressure", "Pa", "#222222", 20e-6, "(20 µPa)²/Hz", 1e-3, 40.0),
}
_FULL_SCALE_QUIET = -60.0  # as `_Kind.quiet`, of a recording that is not calibrated

_PREFIXES = ((1e-3, "µ", 1e6, "ppm"), (1.0, "m", 1e3, "‰"))  # below, prefix, factor, share


@dataclass(frozen=True, eq=False)
class _Trace:
    kind: str
    calibrated: bool
    start: float  # of the time history [s]
    rate: float
    samples: NDArray[np.float64]
    spectrum: Spectrum
    analysed: tuple[float, float]  # part that the spectrum is of [s]

    @property
    def levels(self) -> NDArray[np.float64]:
        reference = _KINDS[self.kind].reference if self.calibrated else 1.0
        density = np.maximum(self.spectrum.density / reference**2, _SMALLEST)
        return 10.0 * np.log10(density)

    @property
    def shown(self) -> NDArray[np.bool_]:
        frequency = self.spectrum.frequency
        return (frequency >= _LOWEST) & (frequency <= _HIGHEST)

    @property
    def limits(self) -> tuple[float, float]:
        """Middle of the time history and how far it swings to either side."""
        if self.kind == "torque":
            low, high = float(self.samples.min()), float(self.samples.max())
            return (low + high) / 2.0, (high - low) / 2.0
        return 0.0, float(np.abs(self.samples).max())


@dataclass(frozen=True)
class _Scale:
    least_swing: float  # in the channel's unit
    top: float  # [dB]


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
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.segments import Segment
    >>> noise = Recording(np.random.default_rng(1).normal(size=(1, 9600)), 48e3,
    ...                   (Channel("pressure"),))
    >>> segment = Segment(channel="all", start=0.0, end=0.2, label="none",
    ...     probabilities={"none": 1.0}, frequency=None, level_db=94.0, level_dbfs=None)
    >>> (figure,) = entry_figures([(noise, segment)])
    >>> [row.kind for row in figure.rows], figure.rows[0].time.alt[:39]
    (['pressure'], 'Sound pressure over 50 ms from 0.075 s:')
    """
    if not (math.isfinite(window) and window > 0):
        raise ParameterError(f"window is {window}; it is a positive number of seconds")
    traced = [_traces(recording, segment, window) for recording, segment in entries]
    scales = _scales(trace for traces in traced for trace in traces)
    figures = []
    with matplotlib.style.context(["default", _STYLE]):
        for (_, segment), traces in zip(entries, traced, strict=True):
            rows = tuple(
                ChannelPanels(
                    trace.kind,
                    _time_panel(trace, scales[trace.kind, trace.calibrated]),
                    _spectrum_panel(
                        trace, scales[trace.kind, trace.calibrated], segment.frequency
                    ),
                )
                for trace in traces
            )
            figures.append(EntryFigure(rows, _caption(traces)))
    return tuple(figures)


def _traces(recording: Recording, segment: Segment, window: float) -> list[_Trace]:
    rate, n_samples = recording.rate, recording.samples.shape[1]
    first = max(0, round(segment.start * rate))
    last = min(n_samples, round(segment.end * rate))
    if last - first < _LEAST_SAMPLES:
        first, last = 0, n_samples
    n_shown = min(n_samples, max(2, round(window * rate)))
    begin = min(max(0, (first + last - n_shown) // 2), n_samples - n_shown)
    traces = []
    for kind in _KINDS:
        names = [channel.name for channel in recording.channels if channel.kind == kind]
        if not names:
            continue
        signal = recording[segment.channel if segment.channel in names else names[0]]
        traces.append(
            _Trace(
                kind=kind,
                calibrated=recording.calibrated,
                start=begin / rate,
                rate=rate,
                samples=signal[begin : begin + n_shown],
                spectrum=autospectrum(signal[first:last], rate, resolution=DEFAULT_RESOLUTION),
                analysed=(first / rate, last / rate),
            )
        )
    return traces


def _scales(traces: Iterable[_Trace]) -> dict[tuple[str, bool], _Scale]:
    scales: dict[tuple[str, bool], _Scale] = {}
    for trace in traces:
        kind, key = _KINDS[trace.kind], (trace.kind, trace.calibrated)
        quiet = kind.quiet if trace.calibrated else _FULL_SCALE_QUIET
        known = scales.get(key, _Scale(kind.least, quiet))
        loudest = float(trace.levels[trace.shown].max(initial=quiet - 5.0))
        scales[key] = _Scale(
            max(known.least_swing, _LEAST_SHARE * trace.limits[1]),
            max(known.top, 10.0 * math.ceil((loudest + 3.0) / 10.0)),
        )
    return scales


def _time_panel(trace: _Trace, scale: _Scale) -> Panel:
    kind = _KINDS[trace.kind]
    middle, swing = trace.limits
    swing = 1.08 * max(swing, scale.least_swing)
    factor, unit = _display_unit(kind, abs(middle) + swing, calibrated=trace.calibrated)
    t = 1e3 * np.arange(trace.samples.size) / trace.rate
    length = 1e3 * trace.samples.size / trace.rate
    figure, axes = _panel(kind.name)
    axes.plot(*_thinned(t, t, factor * trace.samples), color=kind.colour, linewidth=1.2)
    axes.set_xlim(0.0, length)
    axes.set_ylim(factor * (middle - swing), factor * (middle + swing))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    axes.ticklabel_format(axis="y", style="plain", useOffset=False)
    axes.set_xlabel(f"Time from {trace.start:.3f} s [ms]")
    axes.set_ylabel(f"{kind.name} [{unit}]")
    low, high = factor * float(trace.samples.min()), factor * float(trace.samples.max())
    alt = (
        f"{kind.name} over {length:.3g} ms from {trace.start:.3f} s: between {low:.3g} and "
        f"{high:.3g} {unit}."
    )
    return Panel(_svg(figure), alt)


def _spectrum_panel(trace: _Trace, scale: _Scale, frequency: float | None) -> Panel:
    kind = _KINDS[trace.kind]
    reference = kind.reference_text if trace.calibrated else "FS²/Hz"
    bottom = scale.top - _DYNAMIC_RANGE
    f, levels = trace.spectrum.frequency[trace.shown], trace.levels[trace.shown]
    figure, axes = _panel(f"{kind.name}, autospectrum")
    if frequency is not None and _LOWEST <= frequency <= _HIGHEST:
        axes.axvline(frequency, color="#777777", linewidth=1.0, linestyle=(0, (4, 3)))
    drawn = np.maximum(levels, bottom - 5.0)
    axes.plot(*_thinned(np.log(f), f, drawn), color=kind.colour, linewidth=1.0)
    axes.set_xscale("log")
    axes.set_xlim(_LOWEST, _HIGHEST)
    axes.set_ylim(bottom, scale.top)
    axes.xaxis.set_major_locator(FixedLocator(list(_TICKS)))
    axes.xaxis.set_minor_locator(FixedLocator([]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: _TICKS[round(x)]))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    axes.set_xlabel("Frequency [Hz]")
    axes.set_ylabel(f"dB re {reference}")
    alt = f"Autospectrum of the {kind.name.lower()} from 20 Hz to 15 kHz: "
    if levels.size and levels.max() >= bottom:
        peak = int(levels.argmax())
        alt += f"highest at {f[peak]:.0f} Hz with {levels[peak]:.0f} dB re {reference}."
    else:
        alt += f"all below {bottom:.0f} dB re {reference}."
    return Panel(_svg(figure), alt)


def _caption(traces: Sequence[_Trace]) -> str:
    if not traces:
        return "The recording has no channel of torque, acceleration or sound pressure."
    start, end = traces[0].analysed
    spectrum = traces[0].spectrum
    return (
        f"Left, time histories of {1e3 * traces[0].samples.size / traces[0].rate:.3g} ms from the "
        f"middle of the labelled segment. Right, autospectra of the segment from {start:.2f} to "
        f"{end:.2f} s: one-sided power spectral density, Hann window, bins of "
        f"{spectrum.spacing:.3g} Hz, mean of {spectrum.n_segments}. A dashed line marks the "
        f"dominant frequency."
    )


def _display_unit(kind: _Kind, largest: float, *, calibrated: bool) -> tuple[float, str]:
    for below, prefix, factor, share in _PREFIXES:
        if largest < below * 0.05:
            return factor, f"{prefix}{kind.unit}" if calibrated else f"{share} FS"
    return 1.0, kind.unit if calibrated else "FS"


def _thinned(
    position: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Keep the lowest and highest point of each column that is too narrow to show more."""
    if x.size <= 2 * _COLUMNS:
        return x, y
    edges = np.linspace(position[0], position[-1], _COLUMNS + 1)[1:-1]
    kept: set[int] = {0, x.size - 1}
    for column in np.split(np.arange(x.size), np.searchsorted(position, edges)):
        if column.size:
            kept |= {int(column[y[column].argmin()]), int(column[y[column].argmax()])}
    chosen = np.array(sorted(kept))
    return x[chosen], y[chosen]


def _panel(title: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=_SIZE)
    axes = figure.add_axes(_AXES)
    axes.set_title(title, loc="left", fontweight="bold", color="#222222")
    # At the same place in every panel, however wide the numbers are.
    axes.yaxis.set_label_coords(-0.125, 0.5)
    return figure, axes


def _svg(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()
