"""Figures of a recording: time history and autospectrum of each channel, a panel each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from models.drawing import styled, thinned
from models.errors import ParameterError
from noise.pages.engine.panels import COLUMNS, Panel, as_svg, new_panel, panel_frequencies
from noise.pages.engine.traces import HIGHEST, LOWEST, Trace, common_scales, traces
from noise.pictures.channel_kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.recording import Recording
    from noise.labels.segments import Segment
    from noise.pages.engine.traces import Scale
    from noise.pictures.channel_kinds import Kind

__all__ = ["WINDOW", "ChannelPanels", "EntryFigure", "entry_figures"]

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
    across = f"Time from {trace.start:.3f} s [ms]"
    figure, axes = new_panel(kind.name, across, f"{kind.name} [{unit}]")
    axes.plot(
        *thinned(t, factor * trace.samples, columns=COLUMNS), color=kind.colour, linewidth=1.2
    )
    axes.set_xlim(0.0, length)
    axes.set_ylim(factor * (middle - swing), factor * (middle + swing))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    axes.ticklabel_format(axis="y", style="plain", useOffset=False)
    low, high = factor * float(trace.samples.min()), factor * float(trace.samples.max())
    alt = (
        f"{kind.name} over {length:.3g} ms from {trace.start:.3f} s: between {low:.3g} and "
        f"{high:.3g} {unit}."
    )
    return Panel(as_svg(figure), alt)


def _spectrum_panel(trace: Trace, scale: Scale, frequency: float | None) -> Panel:
    kind = KINDS[trace.kind]
    density = kind.density if trace.calibrated else "FS²/Hz"
    bottom = scale.top - _DYNAMIC_RANGE
    f, levels = trace.levels
    figure, axes = new_panel(f"{kind.name}, autospectrum", "Frequency [Hz]", f"dB re {density}")
    if frequency is not None and LOWEST <= frequency <= HIGHEST:
        axes.axvline(frequency, color="#777777", linewidth=1.0, linestyle=(0, (4, 3)))
    drawn = np.maximum(levels, bottom - 5.0)
    curve = thinned(f, drawn, position=np.log(f), columns=COLUMNS)
    axes.plot(*curve, color=kind.colour, linewidth=1.0)
    panel_frequencies(axes, LOWEST, HIGHEST)
    axes.set_ylim(bottom, scale.top)
    axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    alt = f"Autospectrum of the {kind.name.lower()} from 20 Hz to 15 kHz: "
    if levels.max(initial=-math.inf) >= bottom:
        peak = int(levels.argmax())
        alt += f"highest at {f[peak]:.0f} Hz with {levels[peak]:.0f} dB re {density}."
    else:
        axes.text(0.5, 0.08, "below this axis", transform=axes.transAxes, ha="center")
        alt += f"all below {bottom:.0f} dB re {density}."
    return Panel(as_svg(figure), alt)


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
