"""What a request asks of a sound: a channel, a stretch of it, numbers within bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.app.sounds.sound_cache import Track

__all__ = ["Stretch", "number", "read_stretch"]


@dataclass(frozen=True)
class Stretch:
    """Part of a recording.

    Parameters
    ----------
    first, last : int
        Samples.
    rate : float
        Sampling rate [Hz].
    """

    first: int
    last: int
    rate: float

    @property
    def n(self) -> int:
        """Samples in it."""
        return self.last - self.first

    @property
    def start(self) -> float:
        """Where it begins [s]."""
        return self.first / self.rate

    @property
    def end(self) -> float:
        """Where it ends [s]."""
        return self.last / self.rate


def number(query: Mapping[str, str], key: str, missing: float, low: float, high: float) -> float:
    """Read a number of a request.

    Parameters
    ----------
    query : mapping of str to str
    key : str
    missing : float
        Its value where it is not said [unit of the key].
    low, high : float
        Between which it has to be [unit of the key].

    Raises
    ------
    ParameterError
        It is none, or out of bounds.

    Examples
    --------
    >>> number({"low": "50"}, "low", 20.0, 1.0, 100.0), number({}, "low", 20.0, 1.0, 100.0)
    (50.0, 20.0)
    """
    said = query.get(key)
    if not said:
        return missing
    try:
        value = float(said)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise ParameterError(f"{key} {said[:40]!r}: must be a number from {low:g} to {high:g}")
    return value


def read_stretch(query: Mapping[str, str], track: Track, longest: float = math.inf) -> Stretch:
    """Read which stretch is asked for, `start` to `end`; by default the whole.

    Parameters
    ----------
    query : mapping of str to str
    track : Track
    longest : float
        What is longer is cut there [s].

    Raises
    ------
    ParameterError
        It is none.
    """
    start = number(query, "start", 0.0, 0.0, math.inf)
    end = number(query, "end", track.duration, 0.0, math.inf)
    first = round(min(start * track.rate, track.n))
    last = round(min(end * track.rate, track.n, (start + longest) * track.rate))
    if first >= last:
        raise ParameterError(
            f"{start:g} to {end:g} s: must be a stretch of the {track.duration:g} s that there are"
        )
    return Stretch(first, last, track.rate)
