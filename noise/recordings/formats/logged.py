"""The gate through which each channel of a logger's file passes.

A reader of a format states of each channel what its axis is (start, step or time stamps, unit,
quantity) and what its values are (factor, offset, unit). All that is stated is used here, or the
channel is left out with a note that says why, or the file is refused: nothing is passed over.

- The axis is time, in any unit of time. A spectrum, samples over an angle, and time stamps that do
  not rise evenly are no recordings.
- A channel is what its unit says, or, without a unit, what its name says if that is one of ours. A
  sidecar that names the channels has the last word.
- Channels that begin at different times are aligned by whole samples and cut to what they have in
  common. Other differences are refused: to bring channels together one would have to invent
  samples, and the delay of a resampling filter would look like one of the rig.

Only channels that are taken are read, one after the other.
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
from models.units import CHANNEL_UNITS, kind_of_unit, known_units, split_unit
from noise.recordings.formats import RawRecording, check_rate
from noise.recordings.formats.time_axis import SAME_RATE, Axis, start_and_rate
from noise.recordings.sidecar import Sidecar, read_condition, sidecar_of

CONDITIONS = (*(one.key for one in CONDITION.values()), "material")
"""Properties of a file that are its operating condition, named as in a sidecar."""

_OFF = 0.1  # of a step, by which a channel may miss the samples of another
_COMMON = 0.5  # share of the longest channel that all must have in common
_NAMED = 3  # of the channels that are left out, so many are named
_UNCLEAR = {
    "gain": 1.0, "sensitivity": 1.0, "calibration": 1.0, "calibration_factor": 1.0, "factor": 1.0,
    "scale": 1.0, "offset": 0.0,
}  # fmt: skip
"""Attributes that may have been applied or not, and the value at which that does not matter."""

PACKING = ("scale_factor", "add_offset", *_UNCLEAR)
"""Attributes by which numbers are packed, or may be."""

_OURS = re.compile(rf"({'|'.join(CHANNEL_UNITS)})(_([2-9]|[1-9]\d{{1,3}}))?")


@dataclass(frozen=True, eq=False, kw_only=True)
class LoggedChannel:
    """A channel as its file states it, not yet read.

    Parameters
    ----------
    name : str
    n_samples : int
    values : callable
        Reads its samples as stored, shape (n_samples,).
    axes : sequence of Axis
        The last one that states a start has the last word on it.
    packing : mapping of str to object
        Attributes among which there may be those of `PACKING`, of integers and of other numbers.
    integers : bool
        Whether it is stored in whole numbers.
    unit : str
    problem : str
        Why it cannot be read.
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
    """A row of a recording: the channel that it is read from, and how.

    Parameters
    ----------
    logged : LoggedChannel
    kind : str
        Of channel; empty where only a sidecar can say it.
    value : float
        Of the unit of the file [SI unit].
    start : float or None
        Of the first sample [s].
    rate : float
        [Hz]
    first : int
        Sample that the recording begins with.
    """

    logged: LoggedChannel
    kind: str
    value: float
    start: float | None
    rate: float
    first: int = 0

    def samples(self, n: int) -> NDArray[np.float64]:
        """Read the samples of the recording, shape (n,) [SI unit of the channel]."""
        stored = self.logged.values()
        if stored.shape != (self.logged.n_samples,):
            raise RecordingError(
                f"channel {self.logged.name!r} is truncated; {self.logged.n_samples} samples are "
                f"announced, {len(stored)} can be read"
            )
        samples = np.array(stored[self.first : self.first + n], dtype=np.float64)
        factor, offset = factor_and_offset(self.logged.packing)
        with np.errstate(over="ignore", invalid="ignore"):  # refused where it is not finite
            samples *= self.value * factor
            samples += self.value * offset
        return samples


def convert(
    path: Path, logged: Sequence[LoggedChannel], properties: Mapping[str, object], target: Path
) -> RawRecording:
    """Write the channels of a logger's file that make a recording as plain numbers.

    Parameters
    ----------
    path : Path
        Of the file, beside which the sidecar is sought.
    logged : sequence of LoggedChannel
        In the order of the file.
    properties : mapping
        Of the file as a whole; those named as conditions are ours.
    target : Path
        Gets the samples in SI as float64, channel after channel.

    Returns
    -------
    RawRecording
        Reads nothing: its samples are in `target`.

    Raises
    ------
    RecordingError
        No channel can be used, or they contradict each other or themselves.

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
            # Of many channels those that ought to be ours are named first.
            ours = bool(kind_of_unit(_unit(channel)) or _own_name(channel.name))
            left_out.append((not ours, f"{channel.name!r} {error}"))
        else:
            on_time.append(Row(channel, kind, value, start, rate))
    sidecar = sidecar_of(path)
    rows = _named_by(sidecar, on_time)
    left_out += [
        (True, f"{row.logged.name!r} {_unit_problem(row.logged)}")
        for row in on_time
        if row not in rows
    ]
    reasons = [reason for _, reason in sorted(left_out, key=lambda one: one[0])]
    if not rows:
        raise RecordingError(
            f"{path}: channel {_listed(reasons)}; expected samples over time in one of "
            f"{known_units()}, or a sidecar that names the channels"
        )
    notes = []
    if reasons:
        notes.append(f"left out: {_listed(reasons)}; a sidecar that names them makes them count")
    if sidecar.channels is not None and len(rows) == len(sidecar.channels):
        rows = [
            _as_named(row, one.channel, one.unit or "", notes)
            for row, one in zip(rows, sidecar.channels, strict=True)
        ]
        channels = tuple(one.channel for one in sidecar.channels)
    else:
        channels = _names(rows)
    notes += [
        f"channel {row.logged.name!r} {unclear}, which is not applied: its samples are taken to be "
        "in its unit already"
        for row in rows
        if (unclear := _unclear(row.logged))
    ]
    rows, n_samples = _together(path, rows, notes)

    with naming(f"{path}: "), target.open("wb") as file:
        for row in rows:
            row.samples(n_samples).tofile(file)
    return RawRecording(
        n_channels=len(rows),
        n_samples=n_samples,
        rate=rows[0].rate,
        fractional=False,
        read=_nothing,
        channels=channels,
        condition=stated_condition(properties, str(path)),
        notes=tuple(notes),
    )


def _nothing(first: int, last: int) -> NDArray[np.float64]:
    raise NotImplementedError


def _listed(reasons: Sequence[str]) -> str:
    more = len(reasons) - _NAMED
    return "; ".join(reasons[:_NAMED]) + (f"; and {more} more" if more > 0 else "")


def _together(path: Path, rows: list[Row], notes: list[str]) -> tuple[list[Row], int]:
    """Align channels by their start, and cut them to what they have in common."""
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
    late = [(max(begins) - begin) * rate for begin in begins]
    off = [abs(one - round(one)) for one in late]
    if max(off) > _OFF:
        one = rows[int(np.argmax(off))]
        raise RecordingError(
            f"{path}: channel {one.logged.name!r} is sampled {max(off):.2f} of a step beside "
            f"{rows[int(np.argmin(late))].logged.name!r}; channels of a recording must be sampled "
            "together"
        )
    aligned = [
        replace(row, rate=rate, first=round(shift)) for row, shift in zip(rows, late, strict=True)
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
    """Kind of a channel, empty for what is none of ours, and its unit in SI."""
    if channel.problem:
        raise RecordingError(channel.problem)
    factor, offset = factor_and_offset(channel.packing)
    if not (math.isfinite(factor) and math.isfinite(offset)):
        raise RecordingError(f"has factor {factor} and offset {offset}")
    if channel.integers and (unclear := _unclear(channel)):
        raise RecordingError(
            f"{unclear}, and does not state how to apply it; state scale_factor and add_offset"
        )
    unit, named = _unit(channel), _own_name(channel.name).partition("_")[0]
    found = kind_of_unit(unit)
    if not unit:
        return named, 1.0
    return ("", 1.0) if found is None or named not in ("", found[0]) else found


def _unit(channel: LoggedChannel) -> str:
    """Return the unit of a channel, which may stand behind its name."""
    behind = split_unit(channel.name)[1]
    return channel.unit.strip() or (behind if kind_of_unit(behind) else "")


def _own_name(name: str) -> str:
    """Name of a channel where it is one of ours, with or without a unit behind it."""
    texts = (text.strip().lower() for text in (name, split_unit(name)[0]))
    return next((text for text in texts if _OURS.fullmatch(text)), "")


def _unit_problem(channel: LoggedChannel) -> str:
    unit, named = _unit(channel), _own_name(channel.name).partition("_")[0]
    expected = f", expected {CHANNEL_UNITS[named]!r}" if named else ""
    return f"has unit {unit!r}{expected}" if unit else "states no unit"


def factor_and_offset(packing: Mapping[str, object]) -> tuple[float, float]:
    """Return what packed numbers are multiplied with, and what is then added [unit].

    Examples
    --------
    >>> factor_and_offset({"scale_factor": 0.5}), factor_and_offset({})
    ((0.5, 0.0), (1.0, 0.0))
    """
    stated = _numbers(packing)
    return stated.get("scale_factor", 1.0), stated.get("add_offset", 0.0)


def _unclear(channel: LoggedChannel) -> str:
    """Name what may be what was applied or what is to be applied, such as a gain.

    Whole numbers are then not known to be in their unit; other numbers are taken to be.
    """
    stated = _numbers(channel.packing)
    unclear = [f"{k} {stated[k]:g}" for k, no in _UNCLEAR.items() if stated.get(k, no) != no]
    return f"has {' and '.join(unclear)}" if unclear else ""


def _numbers(packing: Mapping[str, object]) -> dict[str, float]:
    return {
        key.lower(): float(value)
        for key, value in packing.items()
        if isinstance(value, int | float | np.number)
    }


def _named_by(sidecar: Sidecar, on_time: list[Row]) -> list[Row]:
    """Rows that a sidecar names, by their number; ours where it names none."""
    ours = [row for row in on_time if row.kind]
    first = (ours or on_time)[:1]
    beside = [row for row in on_time if any(_alike(row, one) for one in first)]
    count = len(ours if sidecar.channels is None else sidecar.channels)
    fitting = (rows for rows in (ours, on_time, beside) if len(rows) == count)
    return next(fitting, ours)  # whoever decides what samples mean says that the numbers differ


def _alike(one: Row, other: Row) -> bool:
    same_length = one.logged.n_samples == other.logged.n_samples
    return same_length and math.isclose(one.rate, other.rate, rel_tol=SAME_RATE)


def _as_named(row: Row, channel: Channel, unit: str, notes: list[str]) -> Row:
    """Return a row as a sidecar names it: by a unit of its own the samples are in it as stored."""
    if row.kind == channel.kind and (not unit or row.value == 1.0):
        return row
    if row.kind:
        notes.append(
            f"the sidecar's {channel.name} in {unit or channel.unit} stands for "
            f"{row.logged.unit!r} of channel {row.logged.name!r}"
        )
    return replace(row, kind=channel.kind, value=1.0)


def _names(rows: Sequence[Row]) -> tuple[Channel, ...]:
    """Keep names that are ours; number the others of a kind with what is free."""
    names: list[str] = []
    for row in rows:
        own = _own_name(row.logged.name)
        names.append("" if own in names else own)
    for i, row in enumerate(rows):
        numbered = (row.kind if n == 1 else f"{row.kind}_{n}" for n in range(1, len(rows) + 2))
        names[i] = names[i] or next(name for name in numbered if name not in names)
    return tuple(map(Channel, names))


# --- the condition -------------------------------------------------------------------------------


def stated_condition(properties: Mapping[str, object], where: str) -> Condition:
    """Read the operating condition among the properties of a file, checked as that of a sidecar.

    Parameters
    ----------
    properties : mapping
        Numbers may be texts; a support stiffness may be "fixed".
    where : str
        What messages call the file.

    Raises
    ------
    RecordingError
        A property that is named as a condition holds none.

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
    try:
        return float(text)
    except ValueError:
        return text
