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

import json
import math
import zlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from reprlib import repr as show
from typing import Annotated, Any, TypeVar

from models.calibration import READING_UNITS
from models.condition import CONDITION, FIXED, Condition
from models.errors import ParameterError, RecordingError, naming
from models.foreign_file import LARGEST_JSON, one_line, parse_json, reading
from models.recording import Channel, Recording
from models.schema import (
    Flag,
    Quantity,
    ReadBy,
    Text,
    Vector,
    as_table,
    as_text,
    declared,
    read_table,
    table_of,
)
from models.units import CHANNEL_UNITS

_Kind = TypeVar("_Kind")
_SUPPORT = CONDITION["support_stiffness"].key
_QUANTITIES = {
    **CONDITION,
    "interference": replace(CONDITION["interference"], low=0.0, closed=True),
    "support_stiffness": replace(CONDITION["support_stiffness"], infinite=""),
}
_CHECKSUM = "wav_crc32"
_OURS = ("channels", "conditions", "calibrated", "notes", _CHECKSUM)


def _name(value: Any, key: str, where: str) -> str:
    try:
        return Channel(as_text(value, key, where)).name
    except ValueError:  # of a number too long to be one as well
        known = ", ".join(CHANNEL_UNITS)
        raise ParameterError(
            f"{where}: {key} = {show(value)} must be one of {known} (or ..._2, _3)"
        ) from None


def _direction(value: Any, key: str, where: str) -> Any:
    """Read a vector of any length as one of length 1."""
    direction = Vector(key, 3).read(value, where)
    length = math.hypot(*direction)
    if not 0.0 < length < math.inf:
        raise ParameterError(f"{where}: {key} = {show(value)} must have a length above 0")
    if math.isclose(length, 1.0, rel_tol=1e-9):
        return direction
    return tuple(part / length for part in direction)


@dataclass(frozen=True)
class SidecarChannel:
    """What a sidecar says of a channel.

    Parameters
    ----------
    name : str
    unit : str, optional
        As spelled: the channel's own, or one of `models.calibration.READING_UNITS`.
    scale : float, optional
        [unit per full scale]
    position, direction : tuple of float, optional
        As of `models.recording.Channel`.
    """

    name: Annotated[str, ReadBy("name", _name)]
    unit: Annotated[str | None, Text("unit")] = None
    scale: Annotated[float | None, Quantity("scale")] = None
    position: Annotated[tuple[float, float, float] | None, Vector("position_m", 3)] = None
    direction: Annotated[
        tuple[float, float, float] | None, ReadBy("direction", _direction, list)
    ] = None

    def __post_init__(self) -> None:
        own = self.channel.unit
        if not (self.unit is None or self.reading or _spelling(self.unit) == _spelling(own)):
            raise ParameterError(f"unit = {show(self.unit)} must be {own!r}")

    @property
    def channel(self) -> Channel:
        """The channel."""
        return Channel(self.name, self.position, self.direction)

    @property
    def reading(self) -> str:
        """Unit of what the measurement chain read, empty where samples are in the channel's own."""
        return self.unit if self.unit in READING_UNITS else ""


def _channels(value: Any, key: str, where: str) -> tuple[SidecarChannel, ...]:
    if not isinstance(value, list):
        raise ParameterError(f"{where}: {key} = {show(value)} must be a list")
    found = []
    for number, entry in enumerate(value, start=1):
        table = as_table(entry, f"channel {number} = {show(entry)}", where)
        place = f"{where}: channel {show(table.get('name', number))}"
        found.append(_read(SidecarChannel, table, place))
    for name, times in Counter(one.name for one in found).items():
        if times > 1:
            raise ParameterError(f"{where}: channel {name!r} is named {times} times; name it once")
    return tuple(found)


def read_condition(value: Any, key: str, where: str) -> Condition:
    """Read an operating condition from a table of a file, by the keys of a sidecar.

    Raises
    ------
    ParameterError
        A value cannot be used, or a quantity is stated in another unit.

    Examples
    --------
    >>> read_condition({"speed_rad_s": 5.0}, "conditions", "run07.json").speed
    5.0
    """
    table = as_table(value, key, where)
    keys = {one.key for one in CONDITION.values()}
    for name, stated in table.items():
        if name not in keys and _stem(name) != name and isinstance(stated, int | float):
            ours = next(one for one in keys if _stem(one) == _stem(name))
            raise ParameterError(
                f"{where}: {key} has {show(name)}, which is not read; state {ours}"
            )
    found: dict[str, Any] = {
        name: one.read(table[one.key], where)
        for name, one in _QUANTITIES.items()
        if table.get(one.key) is not None
    }
    if _SUPPORT in table and table[_SUPPORT] is None:
        found["support_stiffness"] = FIXED
    if (material := table.get("material")) is not None:
        if not as_text(material, "material", where).strip():
            raise ParameterError(f"{where}: material = {show(material)} must be a name")
        found["material"] = material
    return Condition(**found)


@dataclass(frozen=True)
class Sidecar:
    """What a sidecar says.

    Parameters
    ----------
    channels : tuple of SidecarChannel, optional
        In the order of the file; None where the sidecar names none.
    condition : Condition
    calibrated : bool, optional
        None where the sidecar does not say.
    checksum : str
        Of the WAV file that it was written with; empty where it does not say.
    note : str
        What should be known of it.
    """

    channels: Annotated[tuple[SidecarChannel, ...] | None, ReadBy("channels", _channels)] = None
    condition: Annotated[Condition, ReadBy("conditions", read_condition)] = field(
        default_factory=Condition
    )
    calibrated: Annotated[bool | None, Flag("calibrated")] = None
    checksum: Annotated[str, Text(_CHECKSUM)] = ""
    note: str = ""


def _read(kind: type[_Kind], table: Mapping[str, Any], where: str) -> _Kind:
    """Read what is declared, and stated, of a table in which other keys may stand."""
    keys = {entry.key for entry in declared(kind).values()}  # type: ignore[arg-type]
    stated = {key: each for key, each in table.items() if key in keys and each is not None}
    return read_table(kind, stated, where)


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
    if sidecar.checksum and sidecar.checksum != _checksum(recording, recording.stat().st_mtime_ns):
        raise RecordingError(
            f"{path}: was written with other samples than those of {recording.name} (an "
            f"interrupted call, or {recording.name} was changed); write both again, or take "
            f"{_CHECKSUM} out of it if it is right"
        )
    return sidecar


@lru_cache(maxsize=64)
def _checksum(recording: Path, _changed: int) -> str:
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
    models.errors.RecordingError: run07.json: channel 'torque': unit = 'kN m' must be 'N m'
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
        return _read(Sidecar, content, where)


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
    channels = (
        SidecarChannel(one.name, one.unit, None, one.position, one.direction)
        for one in recording.channels
    )
    # A condition of which more is known declares less.
    conditions = table_of(Condition(**vars(recording.condition)))
    if _SUPPORT in conditions and recording.condition.support_stiffness == FIXED:
        conditions[_SUPPORT] = None
    content: dict[str, object] = {
        "channels": [*map(table_of, channels)],
        "conditions": conditions,
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
