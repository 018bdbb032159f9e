"""The sidecar: a JSON file beside the samples that says what they are.

Everything is checked here, at the edge, and refused in one line that names file, channel and
field; behind it channels and conditions can be trusted. Keys that are not ours are passed over, so
an engineer's own notes may stand in the same file, unless they state a condition in another unit
than ours. Values are never guessed: a number in quotes or a torque in kN m is refused, only
spellings of the same unit are alike. A JSON file of another program, which has nothing that a
sidecar has, is passed over as a whole.

A channel of which the file holds what the measurement chain read has the unit ``V``, ``mV`` or
``counts``; it takes a calibration to make that a torque.

``"support_stiffness_Nm_rad": null`` is the clamp bolted to the baseplate; elsewhere null is the
same as a missing key. A direction of any length is made a unit vector.

``wav_crc32`` is the checksum of the WAV file that a sidecar was written with: the sidecar is moved
into place before its samples, and a program that is killed between the two must not leave a new
description beside old samples.
"""

from __future__ import annotations

import json
import math
import zlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from reprlib import repr as show
from typing import Any

from models.calibration import READING_UNITS
from models.condition import CONDITION, FIXED, Condition
from models.errors import ParameterError, RecordingError, naming
from models.foreign_file import LARGEST_JSON, one_line, parse_json, reading
from models.recording import Channel, Recording
from models.schema import Flag, Quantity, Text, Vector
from models.units import CHANNEL_UNITS

_SCALE, _CALIBRATED, _MATERIAL = Quantity("scale"), Flag("calibrated"), Text("material")
_POSITION, _DIRECTION = Vector("position_m", 3), Vector("direction", 3)
_SUPPORT = CONDITION["support_stiffness"].key
_QUANTITIES = {
    **CONDITION,
    "interference": replace(CONDITION["interference"], low=0.0, closed=True),
    "support_stiffness": replace(CONDITION["support_stiffness"], infinite=""),
}
_CHECKSUM = "wav_crc32"
_OURS = ("channels", "conditions", "calibrated", "notes", _CHECKSUM)


@dataclass(frozen=True)
class Sidecar:
    """What a sidecar says.

    Parameters
    ----------
    channels : tuple of Channel, optional
        In the order of the file; None where the sidecar names none.
    scales : tuple of float or None
        One a channel [unit of the channel, or of its readings, per full scale]; None where not
        given.
    condition : Condition
    calibrated : bool, optional
        None where the sidecar does not say.
    readings : tuple of str
        One a channel: the unit of what its chain read, one of `models.calibration.READING_UNITS`;
        empty where the samples are in the channel's own.
    units : tuple of str
        One a channel, as spelled; empty where not given.
    checksum : str
        Of the WAV file that it was written with; empty where it does not say.
    note : str
        What should be known of it.
    """

    channels: tuple[Channel, ...] | None = None
    scales: tuple[float | None, ...] = ()
    condition: Condition = field(default_factory=Condition)
    calibrated: bool | None = None
    readings: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    checksum: str = ""
    note: str = ""


def find_sidecar(recording: Path) -> Path | None:
    """Path of the sidecar of a recording, None where it has none.

    Examples
    --------
    >>> find_sidecar(Path("nowhere.wav")) is None
    True
    """
    candidates = (recording.with_suffix(ending) for ending in (".json", ".JSON"))
    return next((path for path in candidates if path.is_file()), None)


def sidecar_of(recording: Path) -> Sidecar:
    """Read the sidecar of a recording, an empty one where it has none.

    Raises
    ------
    RecordingError
        It cannot be read, says something that cannot be used, or was written with other samples.

    Examples
    --------
    >>> sidecar_of(Path("nowhere.wav")) == Sidecar()
    True
    """
    path = find_sidecar(recording)
    if path is None:
        return Sidecar()
    with reading(path, "sidecar", error=RecordingError, largest=LARGEST_JSON):
        sidecar = parse_sidecar(path.read_bytes(), str(path))
    if sidecar.checksum and sidecar.checksum != _checksum(recording):
        raise RecordingError(
            f"{path}: was written with other samples than those of {recording.name} (an "
            f"interrupted call, or {recording.name} was changed); write both again, or take "
            f"{_CHECKSUM} out of it if it is right"
        )
    return sidecar


def _checksum(recording: Path) -> str:
    try:
        status = recording.stat()
        return _checksum_of(recording, status.st_mtime_ns, status.st_size)
    except OSError as error:
        reason = error.strerror or error
        raise RecordingError(f"{recording}: cannot be read ({reason})") from error


@lru_cache(maxsize=64)
def _checksum_of(recording: Path, _changed: int, _size: int) -> str:
    found = 0
    with recording.open("rb") as file:
        while block := file.read(1 << 20):
            found = zlib.crc32(block, found)
    return f"{found:08x}"


def parse_sidecar(data: str | bytes, where: str = "sidecar") -> Sidecar:
    """Check the text of a sidecar.

    Parameters
    ----------
    data : str or bytes
        JSON; bytes in UTF-8, UTF-16 or UTF-32.
    where : str
        What messages call it.

    Raises
    ------
    RecordingError
        It is no JSON, or one of its values cannot be used.

    Examples
    --------
    >>> parse_sidecar('{"channels": [{"name": "torque", "unit": "kN m"}]}', "run07.json")
    Traceback (most recent call last):
    models.errors.RecordingError: run07.json: channel 'torque' has unit 'kN m', expected 'N m'
    """
    try:
        content = parse_json(data)
    except ValueError as error:
        raise RecordingError(f"{where}: is no JSON ({one_line(error)})") from None
    if not _is_sidecar(content):
        return Sidecar(
            note="the JSON file beside it is of another program, as it names no channels and no "
            "conditions; passed over"
        )
    with naming("", RecordingError):
        return _sidecar({key: value for key, value in content.items() if value is not None}, where)


def _is_sidecar(content: Any) -> bool:
    """Whether something of a JSON file can be meant as a sidecar's."""
    if not isinstance(content, dict):
        return False
    entries = content.get("channels")
    listed = entries if isinstance(entries, list) else []
    names = [one.get("name") if isinstance(one, dict) else one for one in listed]
    conditions = content.get("conditions")
    return (
        all(key in _OURS for key in content)
        or any(str(name).partition("_")[0] in CHANNEL_UNITS for name in names)
        or (isinstance(conditions, dict) and any(_stem(key) != key for key in conditions))
        or isinstance(content.get("calibrated"), bool)
    )


def _sidecar(content: Mapping[str, Any], where: str) -> Sidecar:
    calibrated = content.get("calibrated")
    entries = content.get("channels")
    checksum = content.get(_CHECKSUM, "")
    if not isinstance(checksum, str):
        raise ParameterError(f"{where}: {_CHECKSUM} = {show(checksum)} must be a text in quotes")
    known = Sidecar(
        condition=_condition(content.get("conditions"), where),
        calibrated=None if calibrated is None else _CALIBRATED.read(calibrated, where),
        checksum=checksum,
    )
    if entries is None:
        return known
    if not isinstance(entries, list):
        raise ParameterError(f"{where}: channels is {show(entries)}, expected a list")
    found = [_channel(entry, number, where) for number, entry in enumerate(entries, start=1)]
    channels, scales, readings, units = zip(*found, strict=True) if found else ((), (), (), ())
    name, times = (
        Counter(channel.name for channel in channels).most_common(1)[0] if found else ("", 0)
    )
    if times > 1:
        raise ParameterError(f"{where}: channel {name!r} is named {times} times, expected once")
    return replace(known, channels=channels, scales=scales, readings=readings, units=units)


def _channel(entry: object, number: int, where: str) -> tuple[Channel, float | None, str, str]:
    if not isinstance(entry, dict):
        raise ParameterError(
            f"{where}: channel {number} is {show(entry)}, expected an object {{...}}"
        )
    name = entry.get("name")
    try:
        plain = Channel(name if isinstance(name, str) else "")
    except ValueError:
        known = ", ".join(CHANNEL_UNITS)
        raise ParameterError(
            f"{where}: channel {number} has name {show(name)}, expected {known} (or ..._2, _3)"
        ) from None
    place = f"{where}: channel {plain.name!r}"
    unit = entry.get("unit", plain.unit)
    reading = unit if isinstance(unit, str) and unit in READING_UNITS else ""
    if not isinstance(unit, str) or not (reading or _spelling(unit) == _spelling(plain.unit)):
        raise ParameterError(f"{place} has unit {show(unit)}, expected {plain.unit!r}")
    scale, position, direction = (
        None if entry.get(one.key) is None else one.read(entry[one.key], place)
        for one in (_SCALE, _POSITION, _DIRECTION)
    )
    if direction is not None:
        length = math.hypot(*direction)
        if not 0 < length < math.inf:
            raise ParameterError(f"{place}: direction is {show(direction)}, expected some length")
        if not math.isclose(length, 1.0, rel_tol=1e-9):
            direction = tuple(part / length for part in direction)
    channel = Channel(plain.name, position, direction)
    return channel, scale, reading, str(entry.get("unit", ""))


def _condition(entry: object, where: str) -> Condition:
    if entry is None:
        return Condition()
    if not isinstance(entry, dict):
        raise ParameterError(f"{where}: conditions is {show(entry)}, expected an object {{...}}")
    keys = {one.key for one in CONDITION.values()}
    for key, value in entry.items():
        if key not in keys and _stem(key) != key and isinstance(value, int | float):
            ours = next(one for one in keys if _stem(one) == _stem(key))
            raise ParameterError(
                f"{where}: conditions has {show(key)}, which is not read; state {ours}"
            )
    found: dict[str, Any] = {
        name: one.read(entry[one.key], where)
        for name, one in _QUANTITIES.items()
        if entry.get(one.key) is not None
    }
    if _SUPPORT in entry and entry[_SUPPORT] is None:
        found["support_stiffness"] = FIXED
    if entry.get("material") is not None:
        found["material"] = _MATERIAL.read(entry["material"], where)
        if not found["material"].strip():
            raise ParameterError(f"{where}: material is {show(entry['material'])}, expected a name")
    return Condition(**found)


def _stem(key: str) -> str:
    """Return the quantity that a condition's key begins with; it ends with its unit."""
    for quantity in ("interference", "support", "temperature", "speed"):
        if key.lower().startswith(quantity):
            return quantity
    return key


def _spelling(unit: str) -> str:
    return unit.replace("²", "2").translate({ord(sign): None for sign in " ^·*"})


def sidecar_text(recording: Recording, checksum: str = "") -> str:
    """Sidecar of a recording whose samples are written as floating-point values.

    Parameters
    ----------
    recording : Recording
    checksum : str, optional
        Of the WAV file [CRC-32, as eight hexadecimal digits].

    Returns
    -------
    str
        JSON that `parse_sidecar` reads back as the same channels and condition.

    Raises
    ------
    ParameterError
        The channels or the condition hold values that a sidecar cannot.

    Examples
    --------
    >>> import numpy as np
    >>> tone = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),), Condition(speed=5.0))
    >>> json.loads(sidecar_text(tone))["conditions"]
    {'speed_rad_s': 5.0}
    """
    content: dict[str, object] = {
        "channels": [_channel_entry(channel) for channel in recording.channels],
        "conditions": _conditions_entry(recording.condition),
        "calibrated": recording.calibrated,
    }
    if recording.notes:
        content["notes"] = list(recording.notes)
    if checksum:
        content[_CHECKSUM] = checksum
    text = json.dumps(content, indent=1, default=float) + "\n"
    try:
        parse_sidecar(text, f"recording {recording.name!r}")
    except RecordingError as error:
        raise ParameterError(str(error)) from error
    return text


def _channel_entry(channel: Channel) -> dict[str, object]:
    entry: dict[str, object] = {"name": channel.name, "unit": channel.unit}
    if channel.position is not None:
        entry["position_m"] = list(channel.position)
    if channel.direction is not None:
        entry["direction"] = list(channel.direction)
    return entry


def _conditions_entry(condition: Condition) -> dict[str, float | str | None]:
    entry: dict[str, float | str | None] = {
        one.key: one.of(value)
        for name, one in CONDITION.items()
        if (value := getattr(condition, name)) is not None
    }
    if condition.support_stiffness == FIXED:
        entry[_SUPPORT] = None
    if condition.material is not None:
        entry["material"] = condition.material
    return entry
