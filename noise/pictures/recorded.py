"""Picture of a recording: spectrogram, level over time, what the shaft did, and its orders.

The level is A-weighted with the time weighting F, as a meter shows it that was at rest before; the
order map is drawn where the shaft's speed was recorded and changes, though hardly in a tenth of a
second.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.levels import a_weighted, fast_levels
from features.kernels.orders import order_map, speed_of_angle
from models.drawing import BLUE, CHANNEL_LOOKS, padded, styled, thinned
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.audio.sound import pressure_channel, resampled
from noise.base.label_looks import DARK_LABELS, LABEL_COLOURS
from noise.pictures.axes import new_figure
from noise.pictures.clip_levels import HIGHEST, LOWEST, RATE, clip_levels

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from features.kernels.orders import OrderMap
    from models.recording import Recording

__all__ = [
    "level_over_time", "plot_recording", "recorded_levels", "recorded_orders", "recorded_speed",
]  # fmt: skip

_RANGE = 70.0
"""Of colours, from the highest down [dB]."""

_LEAST_LEVELS = 20.0
"""That a level's axis spans [dB]."""

_RUN_UP = 1.25
"""Ratio of largest and smallest speed from which on orders are told apart from frequencies [-]."""

_NAMED = 0.06
"""A segment as long as this share of the axis has room for its label [-]."""


def plot_recording(recording: Recording, rows: Sequence[Mapping[str, object]] = ()) -> Figure:
    r"""Draw a recording.

    Parameters
    ----------
    recording : Recording
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
    >>> from models.rig_files.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> from sim.shaft import SpeedRamp
    >>> ramp = SpeedRamp(1.0, 9.0, 0.5)
    >>> run = simulate(load_material_rig("fluorocarbon"), ramp, seconds=0.5)
    >>> [axes.get_xlabel() for axes in plot_recording(run.recording).axes if axes.get_xlabel()]
    ['Time [s]', 'Speed of the shaft, magnitude [rad/s]']
    """
    sound = recording.first("pressure")
    others = [c.name for c in recording.channels if c.kind in ("torque", "acceleration", "force")]
    if sound is None and not others:
        raise ParameterError(f"{recording.name}: has no sound, torque or acceleration to be drawn")
    speed, orders = recorded_speed(recording), recorded_orders(recording)
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
        time = np.arange(recording.samples.shape[1]) / recording.rate
        if sound is None:
            _trace(axes[0], time, recording[others[0]], others[0].partition("_")[0])
        else:
            _spectrogram(figure, axes[0], recording, sound)
            _level(axes[1], recording)
        if speed is not None:
            _trace(axes[n_in_time - 1], time, speed, "speed")
        for one in axes[:-1]:
            one.tick_params(labelbottom=False)
        axes[-1].set_xlabel("Time [s]")
        axes[0].set_xlim(0.0, recording.duration)
        _segments(axes[1 if sound is not None else 0], rows, recording.duration)
        if orders is not None:
            _orders(figure, figure.add_subplot(grid[n_in_time]), orders, _unit(recording))
        figure.align_ylabels()
    return figure


def level_over_time(
    sound: NDArray[np.floating], rate: float, reference: float, *, columns: int = 1200
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Level of a sound over time, A-weighted, with the time weighting F.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Sound pressure [Pa], or in fractions of full scale.
    rate : float
        Sampling rate [Hz].
    reference : float
        In the [unit] of the sound.
    columns : int
        How many the axis has; each keeps its lowest and its highest level.

    Returns
    -------
    time, level : ndarray, shape (m,)
        [s] and [dB], thinned for drawing; digital silence is left out.

    Examples
    --------
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(96000) / 48e3)
    >>> round(float(level_over_time(tone, 48e3, 1.0)[1].max()), 1)
    0.0
    """
    level = fast_levels(a_weighted(sound, rate), rate, reference=reference)
    heard = np.isfinite(level)
    time = np.arange(level.size) / rate
    if not heard.any():
        return time[:0], level[:0]
    return thinned(time[heard], level[heard], columns=columns)


def recorded_levels(recording: Recording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Level over time of a recording's first pressure channel, as `level_over_time` returns it.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)
    >>> time, level = recorded_levels(Recording(tone[np.newaxis], 48e3, (Channel("pressure"),)))
    >>> round(float(level.max()), 1)
    91.0
    """
    samples = recording[pressure_channel(recording).name]
    return level_over_time(samples, recording.rate, _reference(recording))


def recorded_speed(recording: Recording) -> NDArray[np.float64] | None:
    """Speed of the shaft over time, as it was recorded.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_samples,), or None
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
    if speed is not None:
        return np.asarray(recording.samples[speed], dtype=np.float64)
    return speed_of_angle(recording.samples[angle], recording.rate)


def recorded_orders(recording: Recording) -> OrderMap | None:
    """Order map of a recording's sound, else of its torque or acceleration.

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
        found = order_map(
            recording.samples[row], recording.rate, speed, reference=_reference(recording)
        )
    except ParameterError:  # too short, or what a sensor gives that fails
        return None
    # A fast swing is steady only where it is fastest.
    return found if found.speed_edges[-1] > _RUN_UP * found.speed_edges[0] else None


_WITH_ORDERS = ("pressure", "torque", "acceleration")


def _reference(recording: Recording) -> float:
    sound = recording.first("pressure") is not None
    return REFERENCE_PRESSURE if recording.calibrated and sound else 1.0


def _unit(recording: Recording) -> str:
    if recording.first("pressure") is None:
        return "dB re 1 unit"
    return "dB re 20 µPa" if recording.calibrated else "dBFS"


def _spectrogram(figure: Figure, axes: Axes, recording: Recording, row: int) -> None:
    sound = recording.samples[row]
    at_rate = resampled(sound - sound.mean(), recording.rate, RATE).astype(np.float32)
    level = clip_levels(at_rate, _reference(recording))[::-1]
    highest = 5.0 * math.ceil(float(level.max()) / 5.0)
    edges = np.geomspace(LOWEST, HIGHEST, level.shape[0] + 1)
    time = np.linspace(0.0, recording.duration, level.shape[1] + 1)
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
    """Leave the paper white where a level is below the colours."""
    return np.where(level < highest - _RANGE, np.nan, level)


def _level(axes: Axes, recording: Recording) -> None:
    time, level = recorded_levels(recording)
    axes.plot(time, level, color=BLUE, linewidth=1.2)
    if level.size:
        # Where a meter at rest begins is nothing that was heard.
        settled = level[time >= min(0.25, 0.5 * recording.duration)]
        axes.set_ylim(*padded(float(settled.min()), float(level.max()), _LEAST_LEVELS))
        axes.set_title(f"L_AFmax {level.max():.1f} {_unit(recording)}", loc="right")
    axes.set_ylabel(f"L_AF [{_unit(recording)}]")


def _trace(axes: Axes, time: NDArray[np.float64], values: NDArray[np.float64], kind: str) -> None:
    look = CHANNEL_LOOKS[kind]
    axes.plot(*thinned(time, values), color=look.colour, linewidth=1.0)
    axes.set_ylabel(f"{look.name}\n[{look.unit}]")


def _segments(axes: Axes, rows: Sequence[Mapping[str, object]], duration: float) -> None:
    """Shade what is labelled, and name it."""
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


def _orders(figure: Figure, axes: Axes, orders: OrderMap, unit: str) -> None:
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
