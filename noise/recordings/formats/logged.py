"""Channels of data loggers as ours: what TDMS, MDF4 and HDF5 have in common.

A channel is what its unit says, or, without a unit, what its name says if that is one of ours; its
samples are brought to SI. Loggers record more than noise: a temperature or a voltage is passed
over, unless a sidecar names it. What contradicts itself is refused, and so are channels with
different rates or lengths: to bring them together one would have to invent samples, and the delay
of a resampling filter would look like one of the rig.

Samples are read block by block, so that reading takes the memory of the result and no more.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import RecordingError
from models.recording import Channel
from models.units import CHANNEL_UNITS, kind_of_unit, known_units
from noise.recordings.files import RawSamples
from noise.recordings.formats.sampling import SAME_RATE
from noise.recordings.formats.stated_condition import stated_condition

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray


__all__ = ["LoggedChannel", "describe_channels", "is_ours", "sample_blocks"]

_BLOCK = 1 << 16  # samples a channel
_OURS = re.compile(rf"({'|'.join(CHANNEL_UNITS)})(_([2-9]|[1-9]\d{{1,3}}))?")


@dataclass(frozen=True, eq=False)
class LoggedChannel:
    """One channel as a file describes it, not yet read.

    Parameters
    ----------
    name, unit : str
        Of the file; empty where it gives none.
    n_samples : int
    rate : float
        [Hz]
    read : callable
        From first and last sample (exclusive) to these samples, real numbers.
    """

    name: str
    unit: str
    n_samples: int
    rate: float
    read: Callable[[int, int], NDArray[np.generic]]


def describe_channels(
    path: Path, logged: Sequence[LoggedChannel], properties: Mapping[str, object]
) -> tuple[RawSamples, list[tuple[LoggedChannel, float]]]:
    """Choose the channels of a logger's file that make a recording.

    Parameters
    ----------
    path : Path
        For messages.
    logged : sequence of LoggedChannel
        In the order of the file.
    properties : mapping
        Of the file as a whole; those named as conditions are ours.

    Returns
    -------
    raw : RawSamples
        Without samples.
    rows : list of (LoggedChannel, float)
        The channel that each row is read from, and its unit [SI unit].

    Raises
    ------
    RecordingError
        There are no channels, or they contradict each other or themselves.

    Examples
    --------
    >>> from pathlib import Path
    >>> x = np.ones(400)
    >>> arm = LoggedChannel("Arm 1", "N mm", 400, 48e3, lambda a, b: x[a:b])
    >>> raw, rows = describe_channels(Path("run.h5"), [arm], {"speed_rad_s": 5.0})
    >>> raw.channels[0].name, rows[0][1], raw.condition.speed
    ('torque', 0.001, 5.0)
    """
    if not logged:
        raise RecordingError(f"{path}: holds no channel of numbers with a sampling rate")
    kinds, doubts = [], []
    for channel in logged:
        try:
            kinds.append(_kind(channel, f"{path}: channel {channel.name!r}"))
        except RecordingError as error:
            kinds.append(None)
            doubts.append(str(error))
    known = [channel for channel, kind in zip(logged, kinds, strict=True) if kind]
    first = (known or logged)[0]
    rows = [
        (channel, kind)
        for channel, kind in zip(logged, kinds, strict=True)
        if kind or _together(channel, first)
    ]
    for channel, _ in rows:
        if not _together(channel, first):
            raise RecordingError(
                f"{path}: channel {channel.name!r} has {channel.n_samples} samples at "
                f"{channel.rate:.10g} Hz, {first.name!r} has {first.n_samples} at "
                f"{first.rate:.10g} Hz; channels of a recording must be sampled together"
            )
    if not known and not doubts:
        doubts.append(
            f"{path}: channel {first.name!r} has unit {first.unit!r}, expected {known_units()} "
            "(or name the channels in a sidecar)"
        )
    raw = RawSamples(
        samples=np.empty((len(rows), 0)),
        rate=first.rate,
        fractional=False,
        channels=_names([(channel.name, kind) for channel, kind in rows]),
        condition=stated_condition(properties, str(path)),
        unclear=doubts[0] if doubts else "",
    )
    return raw, [(channel, kind[1] if kind else 1.0) for channel, kind in rows]


def sample_blocks(
    path: Path, rows: Sequence[tuple[LoggedChannel, float]], first: int = 0, last: int | None = None
) -> Iterator[NDArray[np.float64]]:
    """Read the rows of `describe_channels` one after the other, each in blocks, in SI.

    Parameters
    ----------
    path : Path
        For messages.
    rows : sequence of (LoggedChannel, float)
        Each with its factor [SI unit over the unit in the file].
    first, last : int
        Samples from which and up to which; by default all.

    Yields
    ------
    ndarray, shape (n,)
        [SI unit of the channel]

    Raises
    ------
    RecordingError
        A channel ends before its file says.
    """
    for channel, factor in rows:
        end = channel.n_samples if last is None else min(last, channel.n_samples)
        for start in range(first, end, _BLOCK):
            stop = min(end, start + _BLOCK)
            block = np.array(channel.read(start, stop), dtype=np.float64)
            if block.shape != (stop - start,):
                raise RecordingError(
                    f"{path}: channel {channel.name!r} is truncated; {channel.n_samples} samples "
                    f"are announced, {start + len(block)} can be read"
                )
            with np.errstate(over="ignore", invalid="ignore"):  # refused where it is not finite
                block *= factor
            yield block


def is_ours(name: str, unit: str) -> bool:
    """Whether a channel's unit or its name is one of ours.

    Examples
    --------
    >>> is_ours("Mic 1", "Pa"), is_ours("torque", ""), is_ours("Oil", "degC")
    (True, True, False)
    """
    return kind_of_unit(unit) is not None or _OURS.fullmatch(name.strip().lower()) is not None


def _kind(channel: LoggedChannel, where: str) -> tuple[str, float] | None:
    """Kind of a channel and its unit in SI; None for what is none of ours."""
    named = _OURS.fullmatch(channel.name.strip().lower())
    found = kind_of_unit(channel.unit)
    if named is None:
        return found
    kind = named[1]
    if not channel.unit.strip():
        return kind, 1.0
    if found is None or found[0] != kind:
        raise RecordingError(
            f"{where} has unit {channel.unit!r}, expected {CHANNEL_UNITS[kind]!r} "
            "(or name the channels in a sidecar)"
        )
    return found


def _together(one: LoggedChannel, other: LoggedChannel) -> bool:
    same_length = one.n_samples == other.n_samples
    return same_length and math.isclose(one.rate, other.rate, rel_tol=SAME_RATE)


def _names(
    rows: Sequence[tuple[str, tuple[str, float] | None]],
) -> tuple[Channel | None, ...]:
    """Keep names that are ours; number the others of a kind with what is free."""
    taken: set[str] = set()
    names: list[str | None] = []
    for name, kind in rows:
        own = name.strip().lower()
        keep = kind is not None and _OURS.fullmatch(own) is not None and own not in taken
        names.append(own if keep else None)
        taken |= {own} if keep else set()
    for i, (_, kind) in enumerate(rows):
        if kind is not None and names[i] is None:
            number = 1
            while (free := kind[0] if number == 1 else f"{kind[0]}_{number}") in taken:
                number += 1
            names[i] = free
            taken.add(free)
    return tuple(None if name is None else Channel(name) for name in names)
