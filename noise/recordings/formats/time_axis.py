"""Time axis of a logger channel: start and sampling rate from steps or time stamps in any unit.

Spectra, samples over an angle and uneven time stamps are refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError
from models.units import quantity_of_unit, split_unit

SAME_RATE = 1e-6
"""Relative tolerance of equal sampling rates [-]."""

_JITTER = 0.05  # tolerance of a time stamp [steps]
_CONTRADICTION = 1e-3  # relative difference of two stated rates that contradict each other
_TIME = re.compile(r"time|zeit|temps|tiempo|tempo|timestamps?|t", re.IGNORECASE)


@dataclass(frozen=True, eq=False, kw_only=True)
class Axis:
    """Axis of a channel as stated in one place of a file.

    Parameters
    ----------
    start, step : float, optional
        Position of the first sample, and step between samples [unit].
    times : callable, optional
        Function that reads the position of each sample [unit].
    unit, quantity : str, optional
        Such as "ms" and "time".
    """

    start: float | None = None
    step: float | None = None
    times: Callable[[], NDArray[np.generic]] | None = None
    unit: str | None = None
    quantity: str | None = None

    @cached_property
    def even(self) -> tuple[float, float]:
        """First time stamp and step [unit]; cached, as many channels may share an axis."""
        assert self.times is not None
        return even_step(self.times())


def is_time(name: str, unit: str | None) -> bool:
    """Whether a channel holds time stamps, judged by name and unit.

    Examples
    --------
    >>> is_time("Time (ms)", None), is_time("t", "s"), is_time("T", "degC")
    (True, True, False)
    """
    named = _TIME.fullmatch(split_unit(name)[0].strip()) is not None
    return named and (not unit or _time_unit(unit) is not None)


def _time_unit(unit: str) -> float | None:
    """Return a unit of time in seconds, as "ms" or "hours since 2024-01-01"; None for others."""
    quantity, factor = quantity_of_unit(unit.partition(" since ")[0]) or ("", 0.0)
    return factor if quantity == "time" else None


def start_and_rate(axes: Sequence[Axis]) -> tuple[float | None, float]:
    """Return start [s] and sampling rate [Hz] of a channel from its stated axes.

    Parameters
    ----------
    axes : sequence of Axis
        The last one with a start determines the start.

    Raises
    ------
    RecordingError
        An axis is not time, or the axes state no rate or contradict each other.
    """
    start, rates = None, []
    for axis in axes:
        second = _second(axis)
        if axis.times is not None:
            first, step = axis.even
            start = second * first
            rates.append(1.0 / (second * step))
        elif axis.start is not None:
            start = second * axis.start
        if axis.step is not None:
            if not 0.0 < axis.step < math.inf:
                raise RecordingError(f"has a step in time of {axis.step:g}")
            rates.append(1.0 / (second * axis.step))
    if not rates:
        raise RecordingError("states no sampling rate")
    if max(rates) - min(rates) > _CONTRADICTION * max(rates):
        both = " and ".join(f"{rate:.6g}" for rate in rates)
        raise RecordingError(f"states two sampling rates, {both} Hz")
    return start, whole_rate(rates[0])


def _second(axis: Axis) -> float:
    """Return the unit of a time axis [s]; refuse other axes."""
    if axis.unit:
        second = _time_unit(axis.unit)
        if second is None:
            quantity = f"of {axis.quantity} " if axis.quantity else ""
            raise RecordingError(f"has an axis {quantity}in {axis.unit!r}, expected time")
        return second
    words = re.split(r"[\W_]+", axis.quantity or "time")
    if not any(_TIME.fullmatch(word) for word in words):
        raise RecordingError(f"has an axis of {axis.quantity!r}, expected time")
    return 1.0


def even_step(times: NDArray[np.generic], jitter: float = _JITTER) -> tuple[float, float]:
    """Return the first of evenly spaced time stamps and their step.

    Parameters
    ----------
    times : ndarray, shape (n,)
        [any unit]
    jitter : float
        Largest deviation of a time stamp [steps].

    Raises
    ------
    RecordingError
        A time stamp deviates by more.

    Examples
    --------
    >>> t = 0.5 + np.arange(480) / 48e3
    >>> start, step = even_step(t)
    >>> start, round(1.0 / step)
    (0.5, 48000)
    """
    n = times.size
    if n < 2:
        raise RecordingError(f"has {n} time stamps, expected at least 2")
    start, step = float(times[0]), (float(times[-1]) - float(times[0])) / (n - 1)
    if not 0.0 < step < math.inf:
        raise RecordingError("has a time that does not rise")
    off = np.abs(np.asarray(times, dtype=np.float64) - (start + step * np.arange(n)))
    if not off.max() <= jitter * step:
        at = int(np.argmax(~(off <= jitter * step)))
        raise RecordingError(f"has a time that does not rise evenly (sample {at})")
    return start, step


def whole_rate(rate: float, same: float = SAME_RATE) -> float:
    """Round a sampling rate [Hz] to a close whole number: loggers store steps with few digits."""
    whole = float(round(rate))
    return whole if abs(whole - rate) <= same * rate else rate
