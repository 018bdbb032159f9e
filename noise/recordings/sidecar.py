"""Sidecar: a JSON file beside a recording with its channels, condition and calibration.

All values are validated here, with messages that name file, channel and field. Unknown keys are
ignored, so that engineers can keep notes in the same file, except for a condition in another unit.
Values are never guessed: a number in quotes or a torque in kN m is refused; only spellings of the
same unit are equivalent. A JSON file of another program, without any key of a sidecar, is ignored.

``"support_stiffness_Nm_rad": null`` is the clamp bolted to the baseplate; elsewhere null is the
same as a missing key.
"""

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from reprlib import repr as show
from typing import Annotated, Any, TypeVar

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
GENERATOR = {"generator": "bushing-noise"}
"""Entry of the sidecars that this program writes."""

_KEYS = ("channels", "conditions", "calibrated", "notes", *GENERATOR)


def _name(value: Any, key: str, where: str) -> str:
    """Read the name of a channel."""
    try:
        return Channel(as_text(value, key, where)).name
    except ValueError:  # also for a suffix with too many digits
        known = ", ".join(CHANNEL_UNITS)
        raise ParameterError(
            f"{where}: {key} = {show(value)} must be one of {known} (or ..._2, _3)"
        ) from None


@dataclass(frozen=True)
class SidecarChannel:
    """Entry of a channel in a sidecar.

    Parameters
    ----------
    name : str
    unit : str, optional
        Unit of the channel, as spelled in the file.
    scale : float, optional
        Factor on the samples: [unit per full scale], or [unit per stored number] for floating-point
        samples.
    position, direction : tuple of float, optional
        Position [m] and direction [-], as for `models.recording.Channel`.
    """

    name: Annotated[str, ReadBy("name", _name)]
    unit: Annotated[str | None, Text("unit")] = None
    scale: Annotated[float | None, Quantity("scale")] = None
    position: Annotated[tuple[float, float, float] | None, Vector("position_m", 3)] = None
    direction: Annotated[tuple[float, float, float] | None, Vector("direction", 3)] = None

    def __post_init__(self) -> None:
        own = self.channel.unit
        if not (self.unit is None or _spelling(self.unit) == _spelling(own)):
            raise ParameterError(f"unit = {show(self.unit)} must be {own!r}")

    @property
    def channel(self) -> Channel:
        """Channel with name, position and direction."""
        return Channel(self.name, self.position, self.direction)


def _channels(value: Any, key: str, where: str) -> tuple[SidecarChannel, ...]:
    """Read the list of channels."""
    if not isinstance(value, list):
        raise ParameterError(f"{where}: {key} = {show(value)} must be a list")
    channels = []
    for number, entry in enumerate(value, start=1):
        table = as_table(entry, f"channel {number} = {show(entry)}", where)
        place = f"{where}: channel {show(table.get('name', number))}"
        channels.append(_read(SidecarChannel, table, place))
    for name, count in Counter(one.name for one in channels).items():
        if count > 1:
            raise ParameterError(f"{where}: channel {name!r} is named {count} times; name it once")
    return tuple(channels)


def read_condition(value: Any, key: str, where: str) -> Condition:
    """Read an operating condition from a table with the keys of a sidecar.

    Raises
    ------
    ParameterError
        A value is invalid, or a quantity is stated in another unit.

    Examples
    --------
    >>> read_condition({"speed_rad_s": 5.0}, "conditions", "run07.json").speed
    5.0
    """
    table = as_table(value, key, where)
    keys = {one.key for one in CONDITION.values()}
    for name, stated in table.items():
        if name not in keys and _stem(name) != name and isinstance(stated, int | float):
            own_key = next(one for one in keys if _stem(one) == _stem(name))
            raise ParameterError(
                f"{where}: {key} has {show(name)}, which is not read; state {own_key}"
            )
    values: dict[str, Any] = {
        name: one.read(table[one.key], where)
        for name, one in _QUANTITIES.items()
        if table.get(one.key) is not None
    }
    if _SUPPORT in table and table[_SUPPORT] is None:
        values["support_stiffness"] = FIXED
    if (material := table.get("material")) is not None:
        if not as_text(material, "material", where).strip():
            raise ParameterError(f"{where}: material = {show(material)} must be a name")
        values["material"] = material
    return Condition(**values)


@dataclass(frozen=True)
class Sidecar:
    """Content of a sidecar.

    Parameters
    ----------
    channels : tuple of SidecarChannel, optional
        Channels in the order of the file; None if not stated.
    condition : Condition
    calibrated : bool, optional
        None if not stated.
    note : str
        Note for the user.
    """

    channels: Annotated[tuple[SidecarChannel, ...] | None, ReadBy("channels", _channels)] = None
    condition: Annotated[Condition, ReadBy("conditions", read_condition)] = field(
        default_factory=Condition
    )
    calibrated: Annotated[bool | None, Flag("calibrated")] = None
    note: str = ""


def _read(kind: type[_Kind], table: Mapping[str, Any], where: str) -> _Kind:
    """Read the declared fields of a table and ignore other keys."""
    keys = {entry.key for entry in declared(kind).values()}  # type: ignore[arg-type]
    stated = {key: each for key, each in table.items() if key in keys and each is not None}
    return read_table(kind, stated, where)


def find_sidecar(recording: Path) -> Path | None:
    """Return the path of the sidecar of a recording, or None.

    Examples
    --------
    >>> find_sidecar(Path("nowhere.wav")) is None
    True
    """
    candidates = (recording.with_suffix(ending) for ending in (".json", ".JSON"))
    return next((path for path in candidates if path.is_file()), None)


def sidecar_of(recording: Path) -> Sidecar:
    """Read the sidecar of a recording; without one, return an empty `Sidecar`.

    Raises
    ------
    RecordingError
        The sidecar cannot be read, or holds invalid values.

    Examples
    --------
    >>> sidecar_of(Path("nowhere.wav")) == Sidecar()
    True
    """
    path = find_sidecar(recording)
    if path is None:
        return Sidecar()
    with reading(path, "sidecar", error=RecordingError, largest=LARGEST_JSON):
        return parse_sidecar(path.read_bytes(), str(path))


def parse_sidecar(data: str | bytes, where: str = "sidecar") -> Sidecar:
    """Parse and validate the text of a sidecar.

    Parameters
    ----------
    data : str or bytes
        JSON; bytes in UTF-8, UTF-16 or UTF-32.
    where : str
        Name in messages.

    Returns
    -------
    Sidecar

    Raises
    ------
    RecordingError
        The text is no JSON, or a value is invalid.

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
            note="the JSON file beside it belongs to another program, as it names no channels and "
            "no conditions; it is ignored"
        )
    with naming("", RecordingError):
        return _read(Sidecar, content, where)


def _is_sidecar(content: Any) -> bool:
    """Whether a JSON file has a key or a value of a sidecar."""
    if not isinstance(content, dict):
        return False
    kinds = {"channels": list, "conditions": dict, "calibrated": bool}
    return all(key in _KEYS for key in content) or any(
        isinstance(content.get(key), kind) for key, kind in kinds.items()
    )


def _stem(key: str) -> str:
    """Return the quantity at the start of a condition's key, without the unit."""
    for quantity in ("interference", "support", "temperature", "speed"):
        if key.lower().startswith(quantity):
            return quantity
    return key


def _spelling(unit: str) -> str:
    """Return a unit in a spelling for comparison."""
    return unit.replace("²", "2").translate({ord(sign): None for sign in " ^·*"})


def sidecar_text(recording: Recording) -> str:
    """Return the text of the sidecar for a recording with floating-point samples.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    str
        JSON from which `parse_sidecar` reads the same channels and condition.

    Raises
    ------
    ParameterError
        Channels or condition hold values that a sidecar cannot store.

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
    # Subclasses of Condition do not declare the keys of the fields.
    conditions = table_of(Condition(**vars(recording.condition)))
    if _SUPPORT in conditions and recording.condition.support_stiffness == FIXED:
        conditions[_SUPPORT] = None
    content: dict[str, object] = {
        "channels": [*map(table_of, channels)],
        "conditions": conditions,
        "calibrated": recording.calibrated,
        **GENERATOR,
    }
    if recording.notes:
        content["notes"] = list(recording.notes)
    text = json.dumps(content, indent=1, default=float) + "\n"
    try:
        parse_sidecar(text, f"recording {recording.name!r}")
    except RecordingError as error:
        raise ParameterError(str(error)) from error
    return text
