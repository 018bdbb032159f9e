"""Picture of a recording: spectrogram, level over time, shaft speed and order map.

The level is A-weighted with the time weighting F, as a meter shows it that was at rest before; the
order map is drawn where the shaft's speed was recorded and changes, though hardly in a tenth of a
second.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.level_meter import fast_level_pieces
from features.kernels.orders import OrderMap, order_map, speed_of_angle
from models.blocks import RecordingBlocks, reader_of
from models.drawing import BLUE, CHANNEL_LOOKS, padded, styled, thinned
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE, Recording
from noise.audio.spectrogram import HIGHEST, LOWEST, spectrogram
from noise.base.labels import DARK_LABELS, LABEL_COLOURS
from noise.pictures.figure import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_RANGE = 70.0
"""Of colours, from the highest down [dB]."""

_LEAST_LEVELS = 20.0
"""That a level's axis spans [dB]."""

_RUN_UP = 1.25
"""Ratio of largest and smallest speed from which on orders are told apart from frequencies [-]."""

_NAMED = 0.08
"""A segment as long as this share of the axis has room for its label [-]."""


def plot_recording(
    recording: Recording | RecordingBlocks, rows: Sequence[Mapping[str, object]] = ()
) -> Figure:
    r"""Draw a recording.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        In memory, or one of which parts can be had.
    rows : sequence of mapping
        Of the label table, whose segments are shown below the spectrogram.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        It holds nothing to be drawn.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> from sim.shaft import SpeedRamp
    >>> ramp = SpeedRamp(1.0, 9.0, 0.5)
    >>> run = simulate(load_material_rig("fluorocarbon"), ramp, seconds=0.5)
    >>> [axes.get_xlabel() for axes in plot_recording(run.recording).axes if axes.get_xlabel()]
    ['Time [s]', 'Speed of the shaft, magnitude [rad/s]']
    """
    shows_lines = 0.5 * recording.rate > LOWEST
    sound = recording.first("pressure") if shows_lines else None
    kinds = [channel.kind for channel in recording.channels]
    others = [row for row, kind in enumerate(kinds) if kind in ("torque", "acceleration", "force")]
    if sound is None and not others:
        reason = "has no sound, torque or acceleration to be drawn"
        if not shows_lines:
            reason = f"a sampling rate of {recording.rate:g} Hz shows no sound"
        raise ParameterError(f"{recording.name}: {reason}")
    speed, orders = recorded_speed(recording), recorded_orders(recording)
    duration = recording.n_samples / recording.rate
    heights = [3.0, 1.8] if sound is not None else [2.2]
    heights += [1.7] * (speed is not None)
    n_in_time = len(heights)
    heights += [3.2] * (orders is not None)
    with styled():
        words = ", ".join(recording.condition.words)
        figure = new_figure(sum(heights) + 0.8, " · ".join(filter(None, (recording.name, words))))
        grid = figure.add_gridspec(len(heights), 1, height_ratios=heights)
        axes = [figure.add_subplot(grid[0])]
        axes += [figure.add_subplot(grid[n], sharex=axes[0]) for n in range(1, n_in_time)]
        if sound is None:
            values = reader_of(recording, others[0])(0, recording.n_samples)
            _trace(axes[0], values, recording.rate, kinds[others[0]])
        else:
            _spectrogram(figure, axes[0], recording, sound)
            _level(axes[1], recording)
        if speed is not None:
            _trace(axes[n_in_time - 1], speed, recording.rate, "speed")
        for one in axes[:-1]:
            one.tick_params(labelbottom=False)
        axes[-1].set_xlabel("Time [s]")
        axes[0].set_xlim(0.0, duration)
        _segments(axes[1 if sound is not None else 0], rows, duration)
        if orders is not None:
            draw_orders(figure, figure.add_subplot(grid[n_in_time]), orders, _unit(recording))
        figure.align_ylabels()
    return figure


def recorded_levels(
    recording: Recording | RecordingBlocks, *, columns: int = 1200
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the A-weighted level, time weighting F, of the first pressure channel over time.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
    columns : int
        Columns of the drawing; each keeps its lowest and its highest level.

    Returns
    -------
    time, level : ndarray, shape (m,)
        [s] and [dB], thinned for drawing; digital silence is left out.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)
    >>> time, level = recorded_levels(Recording(tone[np.newaxis], 48e3, (Channel("pressure"),)))
    >>> round(float(level.max()), 1)
    91.0
    """
    read = reader_of(recording, recording.first("pressure") or 0)
    pieces = fast_level_pieces(
        read, recording.n_samples, recording.rate, reference=_reference(recording)
    )
    level = np.concatenate([np.empty(0), *pieces])
    there = np.isfinite(level)
    if not there.any():
        return level[:0], level[:0]
    return thinned(np.flatnonzero(there) / recording.rate, level[there], columns=columns)


def recorded_speed(recording: Recording | RecordingBlocks) -> NDArray[np.float64] | None:
    """Return the recorded speed of the shaft over time.

    Parameters
    ----------
    recording : Recording or RecordingBlocks

    Returns
    -------
    ndarray, shape (n,)
        [rad/s], from a channel of speed, else of angle; None where there is neither.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> turning = Recording(5.0 * np.arange(1000)[None] / 1e3, 1e3, (Channel("angle"),))
    >>> float(recorded_speed(turning).round(3).max())
    5.0
    """
    speed, angle = recording.first("speed"), recording.first("angle")
    if not recording.calibrated or (speed is None and angle is None):
        return None
    row = angle if speed is None else speed
    values = reader_of(recording, row or 0)(0, recording.n_samples)
    return values if speed is not None else speed_of_angle(values, recording.rate)


def recorded_orders(recording: Recording | RecordingBlocks) -> OrderMap | None:
    """Return the order map of the sound of a recording, else of torque or acceleration.

    Returns
    -------
    OrderMap or None
        None where no speed was recorded, where it does not change or changes too fast for a
        spectrum, or where nothing vibrates.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> recorded_orders(Recording(np.ones((1, 4800)), 48e3, (Channel("pressure"),))) is None
    True
    """
    speed = recorded_speed(recording)
    row = next(filter(lambda r: r is not None, map(recording.first, _WITH_ORDERS)), None)
    if speed is None or row is None:
        return None
    slowest, fastest = np.quantile(np.abs(speed), (0.05, 0.95))
    if fastest <= max(_RUN_UP * slowest, 0.05):
        return None
    try:
        orders = order_map(
            reader_of(recording, row), recording.n_samples, recording.rate, speed,
            recording.rate,
            reference=_reference(recording),
        )  # fmt: skip
    except ParameterError:  # too short, or what a sensor gives that fails
        return None
    # A fast swing is steady only where it is fastest.
    return orders if orders.speed_edges[-1] > _RUN_UP * orders.speed_edges[0] else None


_WITH_ORDERS = ("pressure", "torque", "acceleration")


def _reference(recording: Recording | RecordingBlocks) -> float:
    sound = recording.first("pressure") is not None
    return REFERENCE_PRESSURE if recording.calibrated and sound else 1.0


def _unit(recording: Recording | RecordingBlocks) -> str:
    if recording.first("pressure") is None:
        return "dB re 1 unit"
    return "dB re 20 µPa" if recording.calibrated else "dBFS"


def _spectrogram(
    figure: Figure, axes: Axes, recording: Recording | RecordingBlocks, row: int
) -> None:
    n = recording.n_samples
    duration, read = n / recording.rate, reader_of(recording, row)
    level = spectrogram(read, n, recording.rate, _reference(recording))[::-1]
    highest = 5.0 * math.ceil(float(level.max()) / 5.0)
    edges = np.geomspace(LOWEST, HIGHEST, level.shape[0] + 1)
    time = np.linspace(0.0, duration, level.shape[1] + 1)
    drawn = axes.pcolormesh(
        time,
        edges,
        _shown(level, highest),
        cmap="magma_r",
        vmin=highest - _RANGE,
        vmax=highest,
        rasterized=True,
    )
    axes.set_yscale("log")
    axes.set_yticks([100, 200, 500, 1e3, 2e3, 5e3, 10e3])
    axes.set_yticklabels(["100", "200", "500", "1k", "2k", "5k", "10k"])
    axes.minorticks_off()
    axes.set_ylim(LOWEST, min(HIGHEST, 0.5 * recording.rate))
    axes.set_ylabel("Frequency [Hz]")
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label=_unit(recording), pad=0.01, fraction=0.04)


def _shown(level: NDArray[np.float64], highest: float) -> NDArray[np.float64]:
    """Return levels with NaN below the colour range."""
    return np.where(level < highest - _RANGE, np.nan, level)


def _level(axes: Axes, recording: Recording | RecordingBlocks) -> None:
    time, level = recorded_levels(recording)
    axes.plot(time, level, color=BLUE, linewidth=1.2)
    if level.size:
        # Where a meter at rest begins is nothing that was heard.
        duration = recording.n_samples / recording.rate
        settled = level[time >= min(0.25, 0.5 * duration)]
        axes.set_ylim(*padded(float(settled.min()), float(level.max()), _LEAST_LEVELS))
        axes.set_title(f"L_AFmax {level.max():.1f} {_unit(recording)}", loc="right")
    axes.set_ylabel(f"L_AF [{_unit(recording)}]")


def _trace(axes: Axes, values: NDArray[np.float64], rate: float, kind: str) -> None:
    look = CHANNEL_LOOKS[kind]
    axes.plot(*thinned(np.arange(values.size) / rate, values), color=look.colour, linewidth=1.0)
    axes.set_ylabel(f"{look.name}\n[{look.unit}]")


def _segments(axes: Axes, rows: Sequence[Mapping[str, object]], duration: float) -> None:
    """Shade and name labelled segments."""
    for row in rows:
        start, end, label = row.get("start_s"), row.get("end_s"), row.get("label")
        if not (isinstance(start, float) and isinstance(end, float) and isinstance(label, str)):
            continue
        axes.axvspan(start, end, color=LABEL_COLOURS[label], alpha=0.25, linewidth=0.0, zorder=0)
        if end - start >= _NAMED * duration:
            axes.text(
                (start + end) / 2.0, 0.03, label, transform=axes.get_xaxis_transform(),
                ha="center", va="bottom", fontsize=9.0,
                color="white" if label in DARK_LABELS else "#222222",
                bbox={"facecolor": LABEL_COLOURS[label], "edgecolor": "#444444", "pad": 1.5},
            )  # fmt: skip


def draw_orders(figure: Figure, axes: Axes, orders: OrderMap, unit: str) -> None:
    """Draw an order map on axes, with the scale of its colours in `unit`."""
    highest = 5.0 * math.ceil(float(np.nanmax(orders.level)) / 5.0)
    drawn = axes.pcolormesh(
        orders.speed_edges, orders.order_edges, _shown(orders.level, highest),
        cmap="magma_r", vmin=highest - _RANGE, vmax=highest, rasterized=True,
    )  # fmt: skip
    axes.set_yscale("log")
    axes.set_xlabel("Speed of the shaft, magnitude [rad/s]")
    axes.set_ylabel("Order [cycles a revolution]")
    axes.grid(visible=False)
    figure.colorbar(drawn, ax=axes, label=unit, pad=0.01, fraction=0.04)
