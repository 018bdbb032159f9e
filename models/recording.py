"""Recording: samples of several channels in physical units, with their operating condition.

A long recording is read in parts, as `RecordingBlocks`. A part has bit for bit the samples of the
whole, so results that are computed from parts do not depend on the length of a recording.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from models.condition import Condition
from models.errors import ParameterError
from models.show import short_repr
from models.units import CHANNEL_UNITS

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

REFERENCE_PRESSURE = 20e-6
"""Reference of sound pressure levels [Pa]."""


@dataclass(frozen=True)
class Channel:
    """Channel of a recording: its quantity, position and direction.

    Parameters
    ----------
    name : str
        A key of `CHANNEL_UNITS`; further channels of a kind are ``pressure_2``, ``pressure_3`` ...
    position : tuple of 3 floats, optional
        Position of the sensor [m].
    direction : tuple of 3 floats, optional
        Unit vector of its sensitive direction [-].
    full_scale : float
        Value at digital full scale of the file [the channel's unit]; the reference of levels in
        dBFS.

    Raises
    ------
    ParameterError
        The name is of no known kind.

    Examples
    --------
    >>> Channel("acceleration_2").kind, Channel("acceleration_2").unit
    ('acceleration', 'm/s^2')
    """

    name: str
    position: tuple[float, float, float] | None = None
    direction: tuple[float, float, float] | None = None
    full_scale: float = 1.0

    def __post_init__(self) -> None:
        stem, _, number = self.name.partition("_")
        if stem not in CHANNEL_UNITS or (number and not (number.isdecimal() and int(number) > 1)):
            kinds = ", ".join(CHANNEL_UNITS)
            raise ParameterError(
                f"channel {self.name!r} is of no known kind; use {kinds}, or one of them followed "
                f"by _2, _3 ..."
            )

    @property
    def kind(self) -> str:
        """Kind of the channel, a key of `CHANNEL_UNITS`."""
        return self.name.partition("_")[0]

    @property
    def unit(self) -> str:
        """SI unit of the samples."""
        return CHANNEL_UNITS[self.kind]


@short_repr
@dataclass(frozen=True, eq=False)
class Recording:
    """Samples of all channels of one run, with its operating condition.

    Parameters
    ----------
    samples : ndarray, shape (n_channels, n_samples)
        In the unit of each channel; in fractions of full scale if not `calibrated`.
    rate : float
        Sampling rate [Hz].
    channels : tuple of Channel
        One per row of `samples`.
    condition : Condition
        Operating condition, as far as known.
    calibrated : bool
        Whether the samples are in physical units.
    name : str
        Name in tables and messages, usually the file's.
    notes : tuple of str
        Notes for the reader, one line each.

    Raises
    ------
    ParameterError
        The samples are not one row per channel, two channels have one name, or the rate is not
        positive.

    Examples
    --------
    >>> import numpy as np
    >>> tone = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
    >>> tone.duration, "torque" in tone, tone["pressure"].shape
    (0.01, False, (480,))
    """

    samples: NDArray[np.float64]
    rate: float
    channels: tuple[Channel, ...]
    condition: Condition = field(default_factory=Condition)
    calibrated: bool = True
    name: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.samples.ndim != 2 or len(self.samples) != len(self.channels):
            raise ParameterError(
                f"recording {self.name!r}: samples of shape {self.samples.shape} do not fit "
                f"{len(self.channels)} channels; give one row per channel"
            )
        if len(set(self.channel_names)) < len(self.channels):
            raise ParameterError(f"recording {self.name!r}: two channels have the same name")
        if not 0.0 < self.rate < math.inf:
            raise ParameterError(
                f"recording {self.name!r}: rate = {self.rate!r} Hz must be a positive number"
            )

    @property
    def n_samples(self) -> int:
        """Samples of each channel."""
        return int(self.samples.shape[1])

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.samples.shape[1] / self.rate)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels in the order of the samples."""
        return tuple(channel.name for channel in self.channels)

    def first(self, kind: str) -> int | None:
        """Return the row of the first channel of a kind; ``None`` if there is none."""
        rows = (row for row, channel in enumerate(self.channels) if channel.kind == kind)
        return next(rows, None)

    def __contains__(self, name: object) -> bool:
        return name in self.channel_names

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self:
            have = ", ".join(self.channel_names)
            raise ParameterError(f"recording {self.name!r} has no channel {name!r}; it has {have}")
        row: NDArray[np.float64] = self.samples[self.channel_names.index(name)]
        return row

    def plot(self, channel: str | None = None, ax: Axes | None = None) -> Axes:
        """Plot a channel over time.

        Parameters
        ----------
        channel : str, optional
            Name of the channel; by default the first of sound pressure, else the first.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is no such channel, or nothing in it.

        Examples
        --------
        >>> import numpy as np
        >>> from matplotlib.figure import Figure
        >>> tone = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
        >>> tone.plot(ax=Figure().subplots()).get_ylabel()
        'Sound pressure [Pa]'
        """
        import numpy as np

        from models.drawing import CHANNEL_LOOKS, axes_or_new, thinned

        if not self.samples.size:
            raise ParameterError(f"recording {self.name!r} has no samples to plot")
        name = channel or self.channel_names[self.first("pressure") or 0]
        samples, kind = self[name], name.partition("_")[0]
        look, number = CHANNEL_LOOKS[kind], name.removeprefix(kind).replace("_", " ")
        unit = look.unit if self.calibrated else "full scale"
        time = np.arange(samples.size) / self.rate
        with axes_or_new(ax) as axes:
            axes.plot(*thinned(time, samples), color=look.colour, linewidth=0.9)
            axes.set_xlabel("Time [s]")
            axes.set_ylabel(f"{look.name}{number} [{unit}]")
            title = ", ".join(filter(None, [self.name, *self.condition.words]))
            axes.set_title(title, loc="left")
            axes.set_xlim(0.0, self.duration)
        return axes


Read = Callable[[int, int], "NDArray[np.float64]"]
"""Function of first and last sample that returns the samples, shape (n,) or (n_channels, n)."""

_PIECE = 1 << 17
"""Samples of a piece."""


@dataclass(frozen=True, eq=False)
class RecordingBlocks:
    """Recording that is read in parts.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    channels : tuple of Channel
    condition : Condition
    calibrated : bool
    name : str
        As in `Recording`.
    n_samples : int
        Samples of each channel.
    read : callable
        Function of first and last sample that returns the samples, shape (n_channels, n).

    Examples
    --------
    >>> import numpy as np
    >>> turning = Recording(np.array([[0.0, 1.0, 2.0, 3.0]]), 2.0, (Channel("angle"),))
    >>> RecordingBlocks.of(turning).cut(1, 3).samples
    array([[1., 2.]])
    """

    rate: float
    channels: tuple[Channel, ...]
    condition: Condition
    calibrated: bool
    name: str
    n_samples: int
    read: Read

    @classmethod
    def of(cls, recording: Recording | RecordingBlocks) -> RecordingBlocks:
        """Return a recording in memory as one that is read in parts."""
        if isinstance(recording, RecordingBlocks):
            return recording
        return cls(
            recording.rate, recording.channels, recording.condition, recording.calibrated,
            recording.name, recording.n_samples,
            lambda first, last: recording.samples[:, first:last],
        )  # fmt: skip

    def cut(self, first: int, last: int) -> Recording:
        """Return the part from sample `first` up to `last`."""
        samples = self.read(first, last)
        return Recording(
            samples, self.rate, self.channels, self.condition, self.calibrated, self.name
        )

    def part(self, first: int, last: int) -> RecordingBlocks:
        """Return the part from sample `first` up to `last` without reading it."""
        last = min(last, self.n_samples)
        return replace(
            self,
            n_samples=last - first,
            read=lambda start, end: self.read(first + start, min(first + end, last)),
        )

    def pieces(self, first: int, last: int, length: int) -> Iterator[Recording]:
        """Yield a part in pieces of `length` samples, the last of which may be shorter."""
        for start in range(first, last, length):
            yield self.cut(start, min(start + length, last))

    def first(self, kind: str) -> int | None:
        """Return the row of the first channel of a kind; ``None`` if there is none."""
        rows = (row for row, channel in enumerate(self.channels) if channel.kind == kind)
        return next(rows, None)

    def track(self, row: int) -> RecordingBlocks:
        """Return one channel as a recording of its own."""
        channel, read = self.channels[row], reader_of(self, row)
        return replace(
            self,
            channels=(replace(channel, name=channel.kind),),
            read=lambda first, last: read(first, last)[None],
        )


def reader_of(recording: Recording | RecordingBlocks, row: int) -> Read:
    """Return the function that reads a part of a channel, from first and last sample.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
    row : int
        Row of the channel.

    Returns
    -------
    callable
        Returns arrays of shape (last - first,) [unit of the channel].

    Examples
    --------
    >>> import numpy as np
    >>> run = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
    >>> reader_of(run, 0)(10, 30).size
    20
    """
    if isinstance(recording, Recording):
        return lambda first, last: recording.samples[row, first:last]

    def read(first: int, last: int) -> NDArray[np.float64]:
        import numpy as np

        last = min(last, recording.n_samples)
        # In pieces, since the other channels are read as well.
        samples = np.empty(last - first)
        for start in range(first, last, _PIECE):
            end = min(start + _PIECE, last)
            samples[start - first : end - first] = recording.read(start, end)[row]
        return samples

    return read
