"""Conversion of the channels of a logger file into a recording in SI units.

The reader of a format states the axis (start, step or time stamps, unit, quantity) and the values
(factor, offset, unit) of each channel. All of this is applied; otherwise the channel is left out
with a note, or the file is refused. Nothing is ignored.

- The axis must be time, in any unit, with even steps.
- The unit determines the kind of a channel; without a unit its name does, if it is a known one. A
  sidecar that names the channels takes precedence.
- Channels must begin together and have one sampling rate, because resampling or shifting would add
  delays that look like those of a rig. They are cut to the shortest.

Only the selected channels are read, one at a time.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError, naming
from models.recording import Channel
from models.units import CHANNEL_UNITS, kind_of_unit, quantity_of_unit, split_unit
from noise.recordings.formats import RawRecording
from noise.recordings.sidecar import sidecar_of

SAME_RATE = 1e-6
"""Relative tolerance of equal sampling rates [-]."""

_SHIFT = 0.1  # tolerance of the offset between the samples of channels [steps]
_COMMON = 0.5  # smallest length of a channel, relative to the longest
_JITTER = 0.05  # tolerance of a time stamp [steps]
_CONTRADICTION = 1e-3  # relative difference of two stated rates that contradict each other
_MAX_NAMES = 3  # number of skipped channels that a note names
_TIME = re.compile(r"time|zeit|temps|tiempo|tempo|timestamps?|t", re.IGNORECASE)
_KNOWN_NAME = re.compile(rf"({'|'.join(CHANNEL_UNITS)})(_([2-9]|[1-9]\d{{1,3}}))?")
_UNCLEAR = {
    "gain": 1.0, "sensitivity": 1.0, "calibration": 1.0, "calibration_factor": 1.0, "factor": 1.0,
    "scale": 1.0, "offset": 0.0,
}  # fmt: skip
"""Attributes that may or may not have been applied, and their neutral values."""

PACKING = ("scale_factor", "add_offset", *_UNCLEAR)
"""Attributes of packed numbers."""


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


@dataclass(frozen=True, eq=False, kw_only=True)
class LoggedChannel:
    """Channel of a logger file with its metadata, not yet read.

    Parameters
    ----------
    name : str
    n_samples : int
    values : callable
        Function that reads the stored samples, shape (n_samples,).
    axes : sequence of Axis
        The last one with a start determines the start.
    packing : mapping of str to object
        Attributes, which may include those of `PACKING`.
    integers : bool
        Whether the samples are stored as integers.
    unit : str
    problem : str
        Reason why the channel cannot be read; empty if it can.
    """

    name: str
    n_samples: int
    values: Callable[[], NDArray[np.generic]]
    axes: Sequence[Axis] = ()
    packing: Mapping[str, object] = field(default_factory=dict)
    integers: bool = False
    unit: str = ""
    problem: str = ""


class _Row(NamedTuple):
    """Channel on a time axis: kind (empty if unknown), unit in SI, start [s] and rate [Hz]."""

    logged: LoggedChannel
    kind: str
    value: float
    start: float | None
    rate: float

    def samples(self, n: int) -> NDArray[np.float64]:
        """Read the samples, shape (n,) [SI unit of the channel]."""
        stored = self.logged.values()
        if stored.shape != (self.logged.n_samples,):
            raise RecordingError(
                f"channel {self.logged.name!r} is truncated; {self.logged.n_samples} samples are "
                f"announced, {len(stored)} can be read"
            )
        samples = np.array(stored[:n], dtype=np.float64)
        factor, offset = factor_and_offset(self.logged.packing)
        with np.errstate(over="ignore", invalid="ignore"):  # infinite samples are refused later
            samples *= self.value * factor
            samples += self.value * offset
        return samples


def convert(path: Path, logged: Sequence[LoggedChannel], target: Path) -> RawRecording:
    """Write the channels of a logger file in SI units as plain numbers.

    Parameters
    ----------
    path : Path
        The logger file; its sidecar lies beside it.
    logged : sequence of LoggedChannel
        Channels in the order of the file.
    target : Path
        Output file: samples in SI units as float64, channel by channel.

    Returns
    -------
    RawRecording
        Metadata; the samples are in `target`.

    Raises
    ------
    RecordingError
        No channel can be used, or the channels contradict each other or themselves.

    Examples
    --------
    >>> import tempfile
    >>> clock = Axis(start=0.0, step=0.02, unit="ms")
    >>> arm = LoggedChannel(
    ...     name="Arm 1", n_samples=400, values=lambda: np.ones(400), axes=[clock], unit="N mm"
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = Path(folder) / "samples"
    ...     raw = convert(Path("run.h5"), [arm], target)
    ...     float(np.fromfile(target).max())
    0.001
    >>> raw.channels[0].name, raw.rate
    ('torque', 50000.0)
    """
    if not logged:
        raise RecordingError(f"{path}: holds no channel of numbers")
    on_time: list[_Row] = []
    left_out: list[str] = []
    for channel in logged:
        try:
            on_time.append(_Row(channel, *_kind(channel), *start_and_rate(channel.axes)))
        except RecordingError as error:
            left_out.append(f"{channel.name!r} {error}")
    stated = sidecar_of(path).channels
    known = [row for row in on_time if row.kind]
    number = len(known if stated is None else stated)
    # A sidecar that names more channels than have a known unit means those of one sampling rate.
    alike = [row for row in on_time if row.rate == (known or on_time)[0].rate]
    rows = alike if len(known) != number and len(alike) == number else known
    left_out += [
        f"{row.logged.name!r} {_unit_problem(row.logged)}" for row in on_time if row not in rows
    ]
    reasons = "; ".join(left_out[:_MAX_NAMES])
    if len(left_out) > _MAX_NAMES:
        reasons += f"; and {len(left_out) - _MAX_NAMES} more"
    if not rows:
        raise RecordingError(
            f"{path}: channel {reasons}; expected samples over time in one of "
            f"{', '.join(CHANNEL_UNITS.values())}, or a sidecar that names the channels"
        )
    notes = [f"left out: {reasons}; name them in a sidecar to use them"] if reasons else []
    if stated is None or len(rows) != len(stated):
        channels = _channels(rows)
    else:
        channels = tuple(one.channel for one in stated)
        rows = [
            _renamed(row, one.channel, one.unit or "", notes)
            for row, one in zip(rows, stated, strict=True)
        ]
    notes += [
        f"channel {row.logged.name!r} {unclear}, which is not applied: its samples are assumed to "
        "be in its unit"
        for row in rows
        if (unclear := _unclear(row.logged))
    ]
    n_samples = _common_length(path, rows, notes)
    with naming(f"{path}: "), target.open("wb") as file:
        for row in rows:
            row.samples(n_samples).tofile(file)
    return RawRecording(
        n_channels=len(rows),
        n_samples=n_samples,
        rate=rows[0].rate,
        fractional=False,
        read=_unreadable,
        channels=channels,
        notes=tuple(notes),
    )


def _unreadable(first: int, last: int) -> NDArray[np.float64]:
    """Stand in for `RawRecording.read`, which the parent process replaces."""
    raise NotImplementedError


def _common_length(path: Path, rows: Sequence[_Row], notes: list[str]) -> int:
    """Return the length of the shortest channel; refuse channels that were not sampled together."""
    first, together = rows[0], "channels of a recording must be sampled together"
    starts = [row.start for row in rows if row.start is not None]
    for row in rows:
        if not math.isclose(row.rate, first.rate, rel_tol=SAME_RATE):
            raise RecordingError(
                f"{path}: channel {row.logged.name!r} is sampled at {row.rate:.10g} Hz, "
                f"{first.logged.name!r} at {first.rate:.10g} Hz; {together}"
            )
        if row.start is not None and (row.start - min(starts)) * first.rate > _SHIFT:
            raise RecordingError(
                f"{path}: channel {row.logged.name!r} begins {row.start - min(starts):.6g} s after "
                f"another; {together}"
            )
    lengths = [row.logged.n_samples for row in rows]
    shortest, longest = min(lengths), max(lengths)
    if shortest < _COMMON * longest:
        raise RecordingError(
            f"{path}: channels have between {shortest} and {longest} samples; {together}"
        )
    if shortest < longest:
        notes.append(
            f"channels have between {shortest} and {longest} samples; they are cut to the shortest"
        )
    return shortest


# --- the value -----------------------------------------------------------------------------------


def _kind(channel: LoggedChannel) -> tuple[str, float]:
    """Return the kind of a channel (empty if unknown) and its unit in SI units."""
    if channel.problem:
        raise RecordingError(channel.problem)
    factor, offset = factor_and_offset(channel.packing)
    if not (math.isfinite(factor) and math.isfinite(offset)):
        raise RecordingError(f"has factor {factor} and offset {offset}")
    if channel.integers and (unclear := _unclear(channel)):
        raise RecordingError(
            f"{unclear}, and does not state how to apply it; state scale_factor and add_offset"
        )
    unit, named = _unit(channel), _known_name(channel.name).partition("_")[0]
    kind = kind_of_unit(unit)
    if not unit:
        return named, 1.0
    return ("", 1.0) if kind is None or named not in ("", kind[0]) else kind


def _unit(channel: LoggedChannel) -> str:
    """Return the unit of a channel, which may follow its name."""
    suffix = split_unit(channel.name)[1]
    return channel.unit.strip() or (suffix if kind_of_unit(suffix) else "")


def _known_name(name: str) -> str:
    """Return the name of a channel without a unit if it is a known one, else an empty text."""
    texts = (text.strip().lower() for text in (name, split_unit(name)[0]))
    return next((text for text in texts if _KNOWN_NAME.fullmatch(text)), "")


def _unit_problem(channel: LoggedChannel) -> str:
    """Return why the unit of a channel cannot be used."""
    unit, named = _unit(channel), _known_name(channel.name).partition("_")[0]
    expected = f", expected {CHANNEL_UNITS[named]!r}" if named else ""
    return f"has unit {unit!r}{expected}" if unit else "states no unit"


def factor_and_offset(packing: Mapping[str, object]) -> tuple[float, float]:
    """Return factor and offset of packed numbers [unit].

    Examples
    --------
    >>> factor_and_offset({"scale_factor": 0.5}), factor_and_offset({})
    ((0.5, 0.0), (1.0, 0.0))
    """
    stated = _numbers(packing)
    return stated.get("scale_factor", 1.0), stated.get("add_offset", 0.0)


def _unclear(channel: LoggedChannel) -> str:
    """Return attributes such as a gain that may or may not have been applied; empty if none.

    Integers with such an attribute are refused; other numbers are assumed to be in their unit.
    """
    stated = _numbers(channel.packing)
    unclear = [
        f"{key} {stated[key]:g}"
        for key, neutral in _UNCLEAR.items()
        if stated.get(key, neutral) != neutral
    ]
    return f"has {' and '.join(unclear)}" if unclear else ""


def _numbers(packing: Mapping[str, object]) -> dict[str, float]:
    """Return the numeric attributes with keys in lower case."""
    return {
        key.lower(): float(value)
        for key, value in packing.items()
        if isinstance(value, int | float | np.number)
    }


def _renamed(row: _Row, channel: Channel, unit: str, notes: list[str]) -> _Row:
    """Return a row with the kind of a sidecar's channel; samples are then in its unit as stored."""
    if row.kind == channel.kind and (not unit or row.value == 1.0):
        return row
    if row.kind:
        notes.append(
            f"the sidecar's {channel.name} in {unit or channel.unit} stands for "
            f"{row.logged.unit!r} of channel {row.logged.name!r}"
        )
    return row._replace(kind=channel.kind, value=1.0)


def _channels(rows: Sequence[_Row]) -> tuple[Channel, ...]:
    """Return channels with known names; others get the next free number of their kind."""
    names: list[str] = []
    for row in rows:
        known = _known_name(row.logged.name)
        names.append("" if known in names else known)
    for i, row in enumerate(rows):
        numbered = (row.kind if n == 1 else f"{row.kind}_{n}" for n in range(1, len(rows) + 2))
        names[i] = names[i] or next(name for name in numbered if name not in names)
    return tuple(map(Channel, names))


# --- the axis ------------------------------------------------------------------------------------


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
