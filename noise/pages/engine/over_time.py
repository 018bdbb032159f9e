"""Level over time and order map of a card, as lines and pictures whose axes the page draws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from models.drawing import thinned
from noise.pages.engine.spectrogram import picture
from noise.pages.engine.ticks import round_ticks
from noise.pictures.recorded import level_over_time

if TYPE_CHECKING:
    from collections.abc import Mapping

    from features.kernels.orders import OrderMap
    from noise.pages.engine.clips import Clip
    from noise.pages.engine.entry import FastLevels

    Ticks = tuple[tuple[float, str], ...]

__all__ = ["LevelDisplay", "OrdersDisplay", "level_displays", "orders_display"]

LEVELS = 60.0
"""From the highest level of a page's curves down [dB]."""

_STEP = 20.0
"""Between ticks [dB]."""

_MARGIN = 5.0
"""Of ticks from the ends of the axis [dB]."""

_AT_END = 0.6
"""Where the words begin, as a share of the time [-]."""

_COLUMNS, _WIDTH, _HEIGHT = 120, 600, 100


class LevelDisplay(NamedTuple):
    """Level over time: its line in a box of 600 by 100, ticks in per cent from below, and words.

    The largest level is told where the line leaves room at its end: `above` it or below.
    """

    line: str
    ticks: Ticks
    most: str
    above: bool


@dataclass(frozen=True)
class OrdersDisplay:
    """An order map.

    Parameters
    ----------
    picture : bytes
        A PNG file, the highest order at the top.
    speeds, orders : tuple of (float, str)
        Ticks in % from the left, and from below.
    words : str
        What it shows.
    """

    picture: bytes
    speeds: Ticks
    orders: Ticks
    words: str


def level_displays(
    clips: Mapping[str, Clip],
    rate: float,
    reference: float,
    unit: str,
    measured: Mapping[str, FastLevels] | None = None,
) -> dict[str, LevelDisplay]:
    """Draw the levels of sounds that share an axis.

    Parameters
    ----------
    clips : mapping of str to Clip
        By id.
    rate : float
        Sampling rate [Hz].
    reference : float
        Of the levels, in the unit of the samples, such as [Pa].
    unit : str
        Of the levels.
    measured : mapping of str to FastLevels, optional
        Of the recordings that clips were cut from; without it a clip's own are drawn.

    Returns
    -------
    dict of str to LevelDisplay
        Of those in which something is heard.

    Examples
    --------
    >>> level_displays({}, 48e3, 2e-5, "dB(A)")
    {}
    """
    curves = {}
    for key, clip in clips.items():
        if measured is not None and key in measured:
            time, level = measured[key]
            inside = (time >= clip.start) & (time <= clip.end)
            time, level = thinned(time[inside] - clip.start, level[inside], columns=_COLUMNS)
        else:
            time, level = level_over_time(clip.samples, rate, reference, columns=_COLUMNS)
        if level.size:
            curves[key] = time * rate / clip.samples.size, level
    highest = max((float(level.max()) for _, level in curves.values()), default=0.0)
    top = 5.0 * math.ceil(highest / 5.0)
    first = _STEP * math.floor((top - _MARGIN) / _STEP)
    ticks = tuple(
        (round(100.0 * (1.0 - (top - tick) / LEVELS), 1), _plain(tick))
        for tick in np.arange(first, top - LEVELS + _MARGIN, -_STEP)
    )
    return {
        key: LevelDisplay(
            _line(share, (top - level) / LEVELS),
            ticks,
            f"{_plain(level.max(), 1)} {unit}",
            bool(level[share > _AT_END].min(initial=top) < top - 0.5 * LEVELS),
        )
        for key, (share, level) in curves.items()
    }


def orders_display(orders: OrderMap, highest: float) -> OrdersDisplay:
    """Draw an order map in the colours of spectrograms whose darkest is `highest` [dB].

    Examples
    --------
    >>> from features.kernels.orders import order_map
    >>> speed = np.linspace(1.0, 11.0, 48000)
    >>> shown = orders_display(order_map(np.sin(2000 * np.cumsum(speed) / 24e3), 24e3, speed), 90.0)
    >>> [words for _, words in shown.speeds], [words for _, words in shown.orders]
    (['2', '4', '6', '8', '10'], ['100', '1k', '10k'])
    """
    low, high = float(orders.speed_edges[0]), float(orders.speed_edges[-1])
    least, most = float(orders.order_edges[0]), float(orders.order_edges[-1])
    decades = range(math.ceil(math.log10(least)), math.floor(math.log10(most)) + 1)
    level = np.where(np.isfinite(orders.level), orders.level, -np.inf)[::-1]
    return OrdersDisplay(
        picture(np.ascontiguousarray(level), highest),
        tuple(
            (round(100.0 * (tick - low) / (high - low), 2), f"{tick:.6g}")
            for tick in round_ticks(low, high, 6)
            if low <= tick <= high
        ),
        tuple(
            (
                round(100.0 * math.log(10.0**decade / least) / math.log(most / least), 2),
                f"{10**decade}" if decade < 3 else f"{10 ** (decade - 3)}k",
            )
            for decade in decades
        ),
        f"Order map, {low:.3g} to {high:.3g} rad/s, {least:.2g} to {most:.2g} cycles a revolution",
    )


def _line(across: np.ndarray, down: np.ndarray) -> str:
    x, y = _WIDTH * across, _HEIGHT * np.clip(down, 0.0, 1.0)
    return " ".join(f"{a:.0f},{b:.1f}" for a, b in zip(x, y, strict=True))


def _plain(value: float, digits: int = 0) -> str:
    return f"{value:.{digits}f}".replace("-", "\N{MINUS SIGN}")
