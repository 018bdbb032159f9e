"""Order analysis of a turning shaft: levels by order and speed.

A slip that the rotation triggers stays at its order while the speed changes; a resonance stays at
its frequency and crosses the orders. Frames of similar speed are averaged by power; frames in which
the speed changes much, such as at a reversal, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.blocks import Read
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE
from models.show import short_repr

_FRAME, _HOP = 0.085, 0.02
"""Length and spacing of the frames [s]."""

_LOWEST, _HIGHEST = 20.0, 10e3
"""Limits of the frequencies of orders [Hz]."""

_SLOWEST = 0.1
"""Share of the largest speed below which speeds are left out, since their orders are too low."""

_STEADY = 0.3
"""Largest change of the speed in a frame over its mean [-]."""

_GAPS = 0.05
"""Largest share of empty columns; with more, columns become wider."""

_WIDEST = 0.3
"""Share of the largest speed at which the orders reach the highest frequency."""

_ORDERS, _SPEEDS = 150, 80
"""Most cells of a map."""

_LOOKS = 16
"""Samples of the speed per frame."""

_SMOOTHED = 0.02
"""Time over which the slope of an angle is taken [s]."""


@short_repr
@dataclass(frozen=True, eq=False)
class OrderMap:
    """Levels by speed and order.

    Parameters
    ----------
    speed_edges : ndarray, shape (n_speeds + 1,)
        Magnitude of the shaft's speed [rad/s], rising.
    order_edges : ndarray, shape (n_orders + 1,)
        Cycles per revolution [-], rising.
    level : ndarray, shape (n_orders, n_speeds)
        Strongest line in each cell [dB]; NaN for an empty cell.
    """

    speed_edges: NDArray[np.float64]
    order_edges: NDArray[np.float64]
    level: NDArray[np.float64]


def order_map(
    read: Read,
    n_samples: int,
    rate: float,
    speed: NDArray[np.float64],
    speed_rate: float,
    *,
    reference: float = REFERENCE_PRESSURE,
) -> OrderMap:
    """Return the levels of a signal by the shaft's speed and by order.

    Parameters
    ----------
    read : callable
        Function of first and last sample that returns the samples, shape (n,), finite.
    n_samples : int
        Samples of the signal.
    rate : float
        Sampling rate [Hz].
    speed : ndarray, shape (n_speeds,)
        Speed of the shaft [rad/s], signed.
    speed_rate : float
        Sampling rate of the speed [Hz].
    reference : float
        Reference of the levels, in the [unit] of the signal.

    Returns
    -------
    OrderMap

    Raises
    ------
    ParameterError
        The signal is shorter than a frame, or the shaft stands still.

    Examples
    --------
    >>> speed = np.linspace(2.0, 10.0, 96000)
    >>> sound = np.sin(2000 * np.cumsum(speed) / 48e3)  # 2000 cycles per revolution
    >>> result = order_map(lambda first, last: sound[first:last], 96000, 48e3, speed, 48e3)
    >>> strongest = result.order_edges[np.nanargmax(result.level, axis=0)]
    >>> bool(np.all(np.abs(strongest / 2000 - 1) < 0.1))
    True
    """
    magnitude = np.abs(speed)
    length, hop = round(_FRAME * rate), max(1, round(_HOP * rate))
    if n_samples < length:
        raise ParameterError(f"an order map needs {_FRAME:g} s or more")
    starts = np.arange(0, n_samples - length + 1, hop)
    looks = starts[:, np.newaxis] + np.arange(0, length, max(1, length // _LOOKS))
    at = np.minimum((looks * (speed_rate / rate)).astype(np.intp), magnitude.size - 1)
    frames = magnitude[at]
    mean = frames.mean(axis=1)
    fastest = float(mean.max())
    if not fastest > 0.0:
        raise ParameterError("the shaft stands still, so there are no orders")
    moving, steady = mean >= _SLOWEST * fastest, np.ptp(frames, axis=1) <= _STEADY * mean
    used = np.flatnonzero(moving & steady if (moving & steady).any() else moving)
    speeds = _columns(mean[used])
    n_speeds = speeds.size - 1
    highest = min(_HIGHEST, 0.5 * rate)
    orders = 2.0 * np.pi * np.geomspace(_LOWEST, highest / _WIDEST, _ORDERS + 1) / fastest
    bins = np.fft.rfftfreq(length, 1.0 / rate)
    window = np.hanning(length)
    power, count = np.zeros((_ORDERS, n_speeds)), np.zeros((_ORDERS, n_speeds))
    column_of = np.clip(np.searchsorted(speeds, mean, "right") - 1, 0, n_speeds - 1)
    for number in used:
        part = read(int(starts[number]), int(starts[number]) + length)
        lines = 2.0 * np.abs(np.fft.rfft((part - part.mean()) * window) / window.sum()) ** 2
        edges = orders * mean[number] / (2.0 * np.pi)
        inside = (edges[:-1] >= _LOWEST) & (edges[1:] <= highest)
        if not inside.any():
            continue
        ends = np.searchsorted(bins, edges)
        nearest = np.rint(np.sqrt(edges[:-1] * edges[1:]) / bins[1]).astype(int)
        largest = np.maximum.reduceat(np.append(lines, 0.0), np.minimum(ends[:-1], lines.size))
        # At low frequencies some orders lie between two lines.
        between = lines[np.minimum(nearest, lines.size - 1)]
        strongest = np.where(np.diff(ends) > 0, largest, between)
        power[inside, column_of[number]] += strongest[inside]
        count[inside, column_of[number]] += 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 10.0 * np.log10(power / count / reference**2)
    return OrderMap(speeds, orders, np.where(np.isfinite(level), level, np.nan))


def _columns(speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the edges of as many columns as the speeds fill."""
    low, high = float(speeds.min()), float(speeds.max()) * (1.0 + 1e-9)
    number = int(np.clip(speeds.size // 3, 1, _SPEEDS))
    while True:
        edges = np.linspace(low, high, number + 1)
        empty = np.count_nonzero(np.histogram(speeds, edges)[0] == 0)
        if number == 1 or empty <= _GAPS * number:
            return edges
        number = max(1, number * 4 // 5)


def speed_of_angle(angle: ArrayLike, rate: float) -> NDArray[np.float64]:
    """Return the speed of a shaft from its angle.

    Parameters
    ----------
    angle : array_like, shape (n_samples,)
        [rad]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n_samples,)
        Slope of the angle over a fiftieth of a second [rad/s].

    Examples
    --------
    >>> float(speed_of_angle(5.0 * np.arange(1000) / 1e3, 1e3).round(6).max())
    5.0
    """
    turned = np.asarray(angle, dtype=np.float64)
    half = max(1, round(0.5 * _SMOOTHED * rate))
    at = np.arange(turned.size)
    before, after = np.maximum(at - half, 0), np.minimum(at + half, turned.size - 1)
    return np.asarray((turned[after] - turned[before]) * rate / np.maximum(after - before, 1))
