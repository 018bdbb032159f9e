"""Sampling rates of loggers: from a step that was rounded, or from time stamps.

Loggers store the step in time, in single precision or six digits, so a rate that all but is a whole
number is taken to be it. Time stamps must rise evenly: what is not sampled evenly is no waveform.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["HIGHEST_RATE", "LOWEST_RATE", "SAME_RATE", "check_rate", "even_rate", "whole_rate"]

LOWEST_RATE, HIGHEST_RATE = 1.0, 10e6
"""Sampling rates that are possible [Hz]; filters and windows grow with them."""

SAME_RATE = 1e-6
"""Share by which rates may differ that are the same."""

_BLOCK = 1 << 16  # samples
_JITTER = 0.05  # of a step, by which time stamps may miss their place


def check_rate(rate: float, where: str) -> None:
    """Refuse a sampling rate [Hz] that no recording of sound or motion has.

    Raises
    ------
    RecordingError
        It lies outside of `LOWEST_RATE` to `HIGHEST_RATE`, or is no number.

    Examples
    --------
    >>> check_rate(1e8, "run.wav")
    Traceback (most recent call last):
    models.errors.RecordingError: run.wav: sampling rate is 1e+08 Hz, expected 1 Hz to 10 MHz
    """
    if not LOWEST_RATE <= rate <= HIGHEST_RATE:
        raise RecordingError(f"{where}: sampling rate is {rate:g} Hz, expected 1 Hz to 10 MHz")


def whole_rate(rate: float, where: str) -> float:
    """Bring a sampling rate [Hz] to a whole number where it misses one by rounding.

    Raises
    ------
    RecordingError
        It is not possible, see `check_rate`.

    Examples
    --------
    >>> whole_rate(1 / 1.953125e-05, "run.tdms"), whole_rate(610.35, "run.tdms")
    (51200.0, 610.35)
    """
    check_rate(rate, where)
    whole = float(round(rate))
    return whole if abs(whole - rate) < SAME_RATE * rate else rate


def even_rate(n: int, read: Callable[[int, int], NDArray[np.generic]], where: str) -> float:
    """Find the sampling rate [Hz] of time stamps [s], which must rise evenly.

    Parameters
    ----------
    n : int
        Number of time stamps.
    read : callable
        As of `LoggedChannel`.
    where : str
        What messages call them.

    Raises
    ------
    RecordingError
        A time stamp misses its place by more than a twentieth of a step.

    Examples
    --------
    >>> t = np.arange(480) / 48e3
    >>> even_rate(480, lambda a, b: t[a:b], "run.mf4")
    48000.0
    """
    if n < 2:
        raise RecordingError(f"{where}: holds {n} time stamps, expected at least 2")
    start, end = float(read(0, 1)[0]), float(read(n - 1, n)[0])
    step = (end - start) / (n - 1)
    if not 0.0 < step < math.inf:
        raise RecordingError(f"{where}: time does not rise")
    for begin in range(0, n, _BLOCK):
        stop = min(n, begin + _BLOCK)
        place = start + step * np.arange(begin, stop)
        off = np.abs(np.asarray(read(begin, stop), dtype=np.float64) - place)
        if not off.max() <= _JITTER * step:
            at = begin + int(np.argmax(~(off <= _JITTER * step)))
            raise RecordingError(f"{where}: time does not rise evenly (sample {at})")
    return whole_rate(1.0 / step, where)
