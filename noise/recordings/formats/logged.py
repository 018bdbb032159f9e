"""From the channels of a data logger to raw samples: what TDMS, MDF4 and HDF5 have in common.

A channel is what its unit says, or, without a unit, what its name says if that is one of ours; its
samples are brought to SI. Loggers record more than noise: a temperature or a voltage is passed
over, unless a sidecar names it. What contradicts itself is refused, and so are channels with
different rates or lengths: to bring them together one would have to invent samples, and the delay
of a resampling filter would look like one of the rig.

Samples are copied block by block into the one array returned, so that reading takes the memory of
the result and no more.
"""

from __future__ import annotations

import logging
import math
import re
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import RecordingError
from models.recording import CHANNEL_UNITS, Channel
from noise.recordings.files import RawSamples
from noise.recordings.formats.sampling import SAME_RATE
from noise.recordings.formats.stated_condition import stated_condition
from noise.recordings.formats.units import kind_of_unit, known_units

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray


__all__ = ["LoggedChannel", "is_ours", "raw_samples", "refusing"]

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


def raw_samples(
    path: Path, logged: Sequence[LoggedChannel], properties: Mapping[str, object]
) -> RawSamples:
    """Choose, convert and read the channels of a logger's file.

    Parameters
    ----------
    path : Path
        For messages.
    logged : sequence of LoggedChannel
        In the order of the file.
    properties : mapping
        Of the file as a whole; those named as conditions are ours.

    Raises
    ------
    RecordingError
        There are no channels, or they contradict each other or themselves.

    Examples
    --------
    >>> from pathlib import Path
    >>> x = np.ones(400)
    >>> arm = LoggedChannel("Arm 1", "N mm", 400, 48e3, lambda a, b: x[a:b])
    >>> raw = raw_samples(Path("run.h5"), [arm], {"speed_rad_s": 5.0})
    >>> raw.channels[0].name, float(raw.samples.max()), raw.condition.speed
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
    samples = np.empty((len(rows), first.n_samples))
    for row, (channel, kind) in zip(samples, rows, strict=True):
        _fill(path, row, channel, kind[1] if kind else 1.0)
    return RawSamples(
        samples=samples,
        rate=first.rate,
        fractional=False,
        channels=_names([(channel.name, kind) for channel, kind in rows]),
        condition=stated_condition(properties, str(path)),
        unclear=doubts[0] if doubts else "",
    )


def is_ours(name: str, unit: str) -> bool:
    """Whether a channel's unit or its name is one of ours.

    Examples
    --------
    >>> is_ours("Mic 1", "Pa"), is_ours("torque", ""), is_ours("Oil", "degC")
    (True, True, False)
    """
    return kind_of_unit(unit) is not None or _OURS.fullmatch(name.strip().lower()) is not None


@contextmanager
def refusing(path: Path, what: str, library: str = "") -> Iterator[None]:
    """Turn whatever a library raises over a damaged file into one line, and keep it from talking.

    Parameters
    ----------
    path : Path
        For messages.
    what : str
        What the file should be.
    library : str
        Package whose log is silenced: what it warns of is refused here, or does not matter.

    Raises
    ------
    RecordingError
        In place of any other exception but a lack of memory.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.NamedTemporaryFile(suffix=".h5") as file:
    ...     try:
    ...         with refusing(Path(file.name), "HDF5 file"):
    ...             {}["missing"]
    ...     except RecordingError as error:
    ...         print(str(error).partition(": ")[2])
    is damaged or no HDF5 file (KeyError: 'missing')
    """
    path.open("rb").close()  # a file that may not be read is not damaged
    names = [name for name in logging.root.manager.loggerDict if name.split(".")[0] == library]
    loggers = [logging.getLogger(name) for name in names]
    for logger in loggers:
        logger.addFilter(_silent)
    try:
        yield
    except (RecordingError, MemoryError):
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise RecordingError(f"{path}: is damaged or no {what} ({reason})") from error
    finally:
        for logger in loggers:
            logger.removeFilter(_silent)


def _silent(_: logging.LogRecord) -> bool:
    return False


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


def _fill(path: Path, row: NDArray[np.float64], channel: LoggedChannel, factor: float) -> None:
    for start in range(0, row.size, _BLOCK):
        stop = min(row.size, start + _BLOCK)
        block = channel.read(start, stop)
        if len(block) != stop - start:
            raise RecordingError(
                f"{path}: channel {channel.name!r} is truncated; {row.size} samples are announced, "
                f"{start + len(block)} can be read"
            )
        row[start:stop] = block
    with np.errstate(over="ignore", invalid="ignore"):  # refused where it is not finite
        row *= factor


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
