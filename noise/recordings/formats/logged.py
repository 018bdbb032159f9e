"""Conversion of the channels of a logger file into a recording in SI units.

The reader of a format states the axis (start, step or time stamps, unit, quantity) and the values
(factor, offset, unit) of each channel. All of this is applied; otherwise the channel is left out
with a note, or the file is refused. Nothing is ignored.

- The axis must be time, in any unit, with even steps.
- The unit determines the kind of a channel; without a unit its name does, if it is a known one. A
  sidecar that names the channels takes precedence.
- Channels that start at different times are aligned by whole samples and cut to their common part.
  Other differences are refused, because resampling would add delays that look like those of a rig.

Only the selected channels are read, one at a time.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.condition import CONDITION, Condition
from models.errors import RecordingError, naming
from models.recording import Channel
from models.units import CHANNEL_UNITS, kind_of_unit, split_unit
from noise.recordings.formats import RawRecording, check_rate
from noise.recordings.formats.time_axis import SAME_RATE, Axis, start_and_rate
from noise.recordings.sidecar import Sidecar, read_condition, sidecar_of

CONDITIONS = (*(one.key for one in CONDITION.values()), "material")
"""Properties of a file that state its operating condition, with the keys of a sidecar."""

_SHIFT = 0.1  # tolerance of the offset between the samples of channels [steps]
_COMMON = 0.5  # smallest common part of the channels, relative to the longest
_MAX_NAMES = 3  # number of skipped channels that a note names
_UNCLEAR = {
    "gain": 1.0, "sensitivity": 1.0, "calibration": 1.0, "calibration_factor": 1.0, "factor": 1.0,
    "scale": 1.0, "offset": 0.0,
}  # fmt: skip
"""Attributes that may or may not have been applied, and their neutral values."""

PACKING = ("scale_factor", "add_offset", *_UNCLEAR)
"""Attributes of packed numbers."""

_KNOWN_NAME = re.compile(rf"({'|'.join(CHANNEL_UNITS)})(_([2-9]|[1-9]\d{{1,3}}))?")


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


@dataclass(frozen=True, eq=False)
class Row:
    """Channel of a recording with its source in the logger file.

    Parameters
    ----------
    logged : LoggedChannel
    kind : str
        Kind of channel; empty if only a sidecar can state it.
    value : float
        Unit of the file [SI unit].
    start : float or None
        Time of the first sample [s].
    rate : float
        Sampling rate [Hz].
    first : int
        Index of the first sample of the recording.
    """

    logged: LoggedChannel
    kind: str
    value: float
    start: float | None
    rate: float
    first: int = 0

    def samples(self, n: int) -> NDArray[np.float64]:
        """Read the samples, shape (n,) [SI unit of the channel]."""
        stored = self.logged.values()
        if stored.shape != (self.logged.n_samples,):
            raise RecordingError(
                f"channel {self.logged.name!r} is truncated; {self.logged.n_samples} samples are "
                f"announced, {len(stored)} can be read"
            )
        samples = np.array(stored[self.first : self.first + n], dtype=np.float64)
        factor, offset = factor_and_offset(self.logged.packing)
        with np.errstate(over="ignore", invalid="ignore"):  # infinite samples are refused later
            samples *= self.value * factor
            samples += self.value * offset
        return samples


def convert(
    path: Path, logged: Sequence[LoggedChannel], properties: Mapping[str, object], target: Path
) -> RawRecording:
    """Write the channels of a logger file in SI units as plain numbers.

    Parameters
    ----------
    path : Path
        The logger file; its sidecar lies beside it.
    logged : sequence of LoggedChannel
        Channels in the order of the file.
    properties : mapping
        Properties of the file, which may state conditions.
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
    >>> from noise.recordings.formats.time_axis import Axis
    >>> clock = Axis(start=0.0, step=0.02, unit="ms")
    >>> arm = LoggedChannel(
    ...     name="Arm 1", n_samples=400, values=lambda: np.ones(400), axes=[clock], unit="N mm"
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = Path(folder) / "samples"
    ...     raw = convert(Path("run.h5"), [arm], {"speed_rad_s": 5.0}, target)
    ...     float(np.fromfile(target).max())
    0.001
    >>> raw.channels[0].name, raw.rate, raw.condition.speed
    ('torque', 50000.0, 5.0)
    """
    if not logged:
        raise RecordingError(f"{path}: holds no channel of numbers")
    on_time: list[Row] = []
    left_out: list[tuple[bool, str]] = []
    for channel in logged:
        try:
            kind, value = _kind(channel)
            start, rate = start_and_rate(channel.axes)
        except RecordingError as error:
            # Channels with a known unit or name come first in the note.
            known = bool(kind_of_unit(_unit(channel)) or _known_name(channel.name))
            left_out.append((not known, f"{channel.name!r} {error}"))
        else:
            on_time.append(Row(channel, kind, value, start, rate))
    sidecar = sidecar_of(path)
    rows = _selected(sidecar, on_time)
    left_out += [
        (True, f"{row.logged.name!r} {_unit_problem(row.logged)}")
        for row in on_time
        if row not in rows
    ]
    reasons = [reason for _, reason in sorted(left_out, key=lambda one: one[0])]
    if not rows:
        raise RecordingError(
            f"{path}: channel {_listed(reasons)}; expected samples over time in one of "
            f"{', '.join(CHANNEL_UNITS.values())}, or a sidecar that names the channels"
        )
    notes = []
    if reasons:
        notes.append(f"left out: {_listed(reasons)}; name them in a sidecar to use them")
    if sidecar.channels is not None and len(rows) == len(sidecar.channels):
        rows = [
            _renamed(row, one.channel, one.unit or "", notes)
            for row, one in zip(rows, sidecar.channels, strict=True)
        ]
        channels = tuple(one.channel for one in sidecar.channels)
    else:
        channels = _channels(rows)
    notes += [
        f"channel {row.logged.name!r} {unclear}, which is not applied: its samples are assumed to "
        "be in its unit"
        for row in rows
        if (unclear := _unclear(row.logged))
    ]
    rows, n_samples = _aligned(path, rows, notes)

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
        condition=stated_condition(properties, str(path)),
        notes=tuple(notes),
    )


def _unreadable(first: int, last: int) -> NDArray[np.float64]:
    """Stand in for `RawRecording.read`, which the parent process replaces."""
    raise NotImplementedError


def _listed(reasons: Sequence[str]) -> str:
    """Return the first reasons as text."""
    more = len(reasons) - _MAX_NAMES
    return "; ".join(reasons[:_MAX_NAMES]) + (f"; and {more} more" if more > 0 else "")


def _aligned(path: Path, rows: list[Row], notes: list[str]) -> tuple[list[Row], int]:
    """Align channels by their start; return them with their common number of samples."""
    rate, longest = rows[0].rate, max(row.logged.n_samples for row in rows)
    check_rate(rate, str(path))
    for row in rows:
        if not math.isclose(row.rate, rate, rel_tol=SAME_RATE):
            raise RecordingError(
                f"{path}: channel {row.logged.name!r} is sampled at {row.rate:.10g} Hz, "
                f"{rows[0].logged.name!r} at {rate:.10g} Hz; channels of a recording must be "
                "sampled together"
            )
    stated = [row.start for row in rows if row.start is not None]
    if 0 < len(stated) < len(rows) and max(stated) > min(stated):
        silent = next(row.logged.name for row in rows if row.start is None)
        raise RecordingError(
            f"{path}: does not state when channel {silent!r} begins, and others begin "
            f"{max(stated) - min(stated):.6g} s apart"
        )
    begins = [max(stated, default=0.0) if row.start is None else row.start for row in rows]
    shifts = [(max(begins) - begin) * rate for begin in begins]
    fractions = [abs(shift - round(shift)) for shift in shifts]
    if max(fractions) > _SHIFT:
        one = rows[int(np.argmax(fractions))]
        raise RecordingError(
            f"{path}: channel {one.logged.name!r} is sampled {max(fractions):.2f} steps apart from "
            f"{rows[int(np.argmin(shifts))].logged.name!r}; channels of a recording must be "
            "sampled together"
        )
    aligned = [
        replace(row, rate=rate, first=round(shift)) for row, shift in zip(rows, shifts, strict=True)
    ]
    common = min(row.logged.n_samples - row.first for row in aligned)
    if common < _COMMON * longest:
        counts = ", ".join(
            f"{row.logged.name!r} {row.logged.n_samples} from {begin - min(begins):.6g} s"
            for row, begin in zip(aligned, begins, strict=True)
        )
        raise RecordingError(
            f"{path}: channels have {max(common, 0)} samples in common ({counts}); channels of a "
            "recording must be sampled together"
        )
    if common < longest:
        notes.append(
            f"channels begin up to {(max(begins) - min(begins)) * 1e3:.6g} ms apart and have "
            f"between {min(row.logged.n_samples for row in aligned)} and {longest} samples; they "
            f"are aligned by their start and cut to the {common} samples in common"
        )
    return aligned, common


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


def _selected(sidecar: Sidecar, on_time: list[Row]) -> list[Row]:
    """Return the rows that match a sidecar in number, or those of a known kind."""
    known = [row for row in on_time if row.kind]
    first = (known or on_time)[:1]
    alike = [row for row in on_time if any(_alike(row, one) for one in first)]
    count = len(known if sidecar.channels is None else sidecar.channels)
    matches = (rows for rows in (known, on_time, alike) if len(rows) == count)
    return next(matches, known)  # `noise.recordings.interpretation` refuses a wrong number


def _alike(one: Row, other: Row) -> bool:
    """Whether two rows have the same length and sampling rate."""
    same_length = one.logged.n_samples == other.logged.n_samples
    return same_length and math.isclose(one.rate, other.rate, rel_tol=SAME_RATE)


def _renamed(row: Row, channel: Channel, unit: str, notes: list[str]) -> Row:
    """Return a row with the kind of a sidecar's channel; samples are then in its unit as stored."""
    if row.kind == channel.kind and (not unit or row.value == 1.0):
        return row
    if row.kind:
        notes.append(
            f"the sidecar's {channel.name} in {unit or channel.unit} stands for "
            f"{row.logged.unit!r} of channel {row.logged.name!r}"
        )
    return replace(row, kind=channel.kind, value=1.0)


def _channels(rows: Sequence[Row]) -> tuple[Channel, ...]:
    """Return channels with known names; others get the next free number of their kind."""
    names: list[str] = []
    for row in rows:
        known = _known_name(row.logged.name)
        names.append("" if known in names else known)
    for i, row in enumerate(rows):
        numbered = (row.kind if n == 1 else f"{row.kind}_{n}" for n in range(1, len(rows) + 2))
        names[i] = names[i] or next(name for name in numbered if name not in names)
    return tuple(map(Channel, names))


# --- the condition -------------------------------------------------------------------------------


def stated_condition(properties: Mapping[str, object], where: str) -> Condition:
    """Read the operating condition from the properties of a file.

    Parameters
    ----------
    properties : mapping
        Numbers may be texts; a support stiffness may be "fixed".
    where : str
        Name of the file in messages.

    Raises
    ------
    RecordingError
        A property with the key of a condition has an invalid value.

    Examples
    --------
    >>> stated_condition({"speed_rad_s": "5.0", "operator": "JD"}, "run07.tdms").speed
    5.0
    """
    entry: dict[str, object] = {}
    for key in CONDITIONS:
        value = properties.get(key)
        if value is None:
            continue
        if isinstance(value, np.ndarray | np.generic) and value.size == 1:
            value = value.item()
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, str) and key != "material":
            fixed = value.strip().lower() in ("fixed", "null")
            value = None if fixed else _number(value)
        entry[key] = value
    with naming("", RecordingError):
        return read_condition(entry, "conditions", where)


def _number(text: str) -> float | str:
    """Return a text as a number if it is one."""
    try:
        return float(text)
    except ValueError:
        return text
