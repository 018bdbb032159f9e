"""The sidecar: a JSON file beside the samples that says what they are.

Everything is checked here, at the edge, and refused in one line that names file, channel and
field; behind it channels and conditions can be trusted. Keys that are not ours are passed over, so
an engineer's own notes may stand in the same file, unless they state a condition in another unit
than ours. Values are never guessed: a number in quotes or
a torque in kN m is refused, only spellings of the same unit are alike.

A channel of which the file holds what the measurement chain read has the unit ``V``, ``mV`` or
``counts``; it takes a calibration to make that a torque.

``"support_stiffness_Nm_rad": null`` is the clamp bolted to the baseplate; elsewhere null is the
same as a missing key. A direction of any length is made a unit vector.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import dataclass, field
from reprlib import repr as show
from typing import TYPE_CHECKING, NoReturn

from models.calibration import READING_UNITS
from models.condition import FIXED, Condition
from models.errors import ParameterError, RecordingError
from models.foreign_file import LARGEST_JSON, one_line, parse_json, reading
from models.recording import Channel
from models.units import CHANNEL_UNITS

if TYPE_CHECKING:
    from pathlib import Path

    from models.recording import Recording

__all__ = ["Sidecar", "find_sidecar", "parse_sidecar", "read_sidecar", "sidecar_text"]

_ABSOLUTE_ZERO = -273.15  # degree Celsius

_CONDITIONS = ("speed_rad_s", "interference_mm", "support_stiffness_Nm_rad", "temperature_C")


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
    """

    channels: tuple[Channel, ...] | None = None
    scales: tuple[float | None, ...] = ()
    condition: Condition = field(default_factory=Condition)
    calibrated: bool | None = None
    readings: tuple[str, ...] = ()
    units: tuple[str, ...] = ()


def find_sidecar(recording: Path) -> Path | None:
    """Path of the sidecar of a recording, None where it has none.

    Examples
    --------
    >>> from pathlib import Path
    >>> find_sidecar(Path("nowhere.wav")) is None
    True
    """
    candidates = (recording.with_suffix(ending) for ending in (".json", ".JSON"))
    return next((path for path in candidates if path.is_file()), None)


def read_sidecar(path: Path) -> Sidecar:
    """Read and check a sidecar.

    Parameters
    ----------
    path : Path
        The JSON file itself.

    Raises
    ------
    RecordingError
        It cannot be read, or says something that cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "run07.json"
    ...     _ = path.write_text('{"conditions": {"interference_mm": 0.25}}')
    ...     read_sidecar(path).condition.interference
    0.00025
    """
    with reading(path, "sidecar", error=RecordingError, largest=LARGEST_JSON):
        return parse_sidecar(path.read_bytes(), str(path))


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
        It is no JSON object, or one of its values cannot be used.

    Examples
    --------
    >>> parse_sidecar('{"channels": [{"name": "torque", "unit": "kN m"}]}', "run07.json")
    Traceback (most recent call last):
    models.errors.RecordingError: run07.json: channel 'torque' has unit 'kN m', expected 'N m'
    """
    try:
        content = parse_json(data)
    except ValueError as error:
        _refuse(where, f"is no JSON ({one_line(error)})")
    if not isinstance(content, dict):
        _refuse(where, f"holds {show(content)}, expected an object {{...}}")
    calibrated = content.get("calibrated")
    if calibrated is not None and not isinstance(calibrated, bool):
        _refuse(where, f"calibrated is {show(calibrated)}, expected true or false")
    condition = _condition(content.get("conditions"), where)
    if content.get("channels") is None:
        return Sidecar(condition=condition, calibrated=calibrated)
    entries = _channels(content["channels"], where)
    return Sidecar(
        channels=tuple(channel for channel, _, _, _ in entries),
        scales=tuple(scale for _, scale, _, _ in entries),
        condition=condition,
        calibrated=calibrated,
        readings=tuple(reading for _, _, reading, _ in entries),
        units=tuple(unit for _, _, _, unit in entries),
    )


def sidecar_text(recording: Recording) -> str:
    """Sidecar of a recording whose samples are written as floating-point values.

    Parameters
    ----------
    recording : Recording

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
    >>> from models.recording import Recording
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
    fit = condition.interference
    known = {
        "speed_rad_s": condition.speed,
        # Twelve digits, so that 0.279 mm is not written as 0.27899999999999997.
        "interference_mm": None if fit is None else float(f"{fit * 1e3:.12g}"),
        "material": condition.material,
        "temperature_C": condition.temperature,
    }
    entry: dict[str, float | str | None]
    entry = {key: value for key, value in known.items() if value is not None}
    if condition.support_stiffness is not None:
        fixed = condition.support_stiffness == FIXED
        entry["support_stiffness_Nm_rad"] = None if fixed else condition.support_stiffness
    return entry


def _channels(entries: object, where: str) -> list[tuple[Channel, float | None, str, str]]:
    if not isinstance(entries, list):
        _refuse(where, f"channels is {show(entries)}, expected a list")
    found = [_channel(entry, number, where) for number, entry in enumerate(entries, start=1)]
    names = [channel.name for channel, _, _, _ in found]
    if len(set(names)) < len(names):
        name, times = Counter(names).most_common(1)[0]
        _refuse(where, f"channel {name!r} is named {times} times, expected once")
    return found


def _channel(entry: object, number: int, where: str) -> tuple[Channel, float | None, str, str]:
    if not isinstance(entry, dict):
        _refuse(where, f"channel {number} is {show(entry)}, expected an object {{...}}")
    name = entry.get("name")
    try:
        plain = Channel(name if isinstance(name, str) else "")
    except ValueError:
        known = ", ".join(CHANNEL_UNITS)
        _refuse(where, f"channel {number} has name {show(name)}, expected {known} (or ..._2, _3)")
    channel = f"{where}: channel {plain.name!r}"
    unit = entry.get("unit", plain.unit)
    reading = unit if isinstance(unit, str) and unit in READING_UNITS else ""
    if not isinstance(unit, str) or not (reading or _spelling(unit) == _spelling(plain.unit)):
        raise RecordingError(f"{channel} has unit {show(unit)}, expected {plain.unit!r}")
    scale = _number(entry.get("scale"), f"{channel}: scale", positive=True)
    position = _vector(entry.get("position_m"), f"{channel}: position_m")
    direction = _vector(entry.get("direction"), f"{channel}: direction")
    if direction is not None:
        direction = _unit_vector(direction, f"{channel}: direction")
    return Channel(plain.name, position, direction), scale, reading, str(entry.get("unit", ""))


def _condition(entry: object, where: str) -> Condition:
    if entry is None:
        return Condition()
    if not isinstance(entry, dict):
        _refuse(where, f"conditions is {show(entry)}, expected an object {{...}}")
    for key in entry:
        ours = next((ours for ours in _CONDITIONS if _stem(key) == _stem(ours)), key)
        if key != ours and isinstance(entry[key], int | float):
            _refuse(where, f"conditions has {show(key)}, which is not read; state {ours}")
    material = entry.get("material")
    if material is not None and (not isinstance(material, str) or not material.strip()):
        _refuse(where, f"material is {show(material)}, expected a name in quotes")
    interference = _number(entry.get("interference_mm"), f"{where}: interference_mm", least=0.0)
    support = "support_stiffness_Nm_rad"
    stiffness = _number(entry.get(support), f"{where}: {support}", positive=True)
    return Condition(
        speed=_number(entry.get("speed_rad_s"), f"{where}: speed_rad_s"),
        interference=None if interference is None else interference / 1e3,
        support_stiffness=FIXED if stiffness is None and support in entry else stiffness,
        material=material,
        temperature=_number(
            entry.get("temperature_C"), f"{where}: temperature_C", least=_ABSOLUTE_ZERO
        ),
    )


def _stem(key: str) -> str:
    """Return the quantity that a condition's key begins with; it ends with its unit."""
    for quantity in ("interference", "support", "temperature", "speed"):
        if key.lower().startswith(quantity):
            return quantity
    return key


def _number(
    value: object, where: str, *, least: float = -math.inf, positive: bool = False
) -> float | None:
    if value is None:
        return None
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isfinite(number) and number >= least and not (positive and number <= 0):
            return number
    expected = "a finite number" if math.isinf(least) else f"a number of {least:g} or more"
    expected = "a positive number" if positive else expected
    raise RecordingError(f"{where} is {show(value)}, expected {expected}")


def _vector(value: object, where: str) -> tuple[float, float, float] | None:
    if value is None:
        return None
    if isinstance(value, list) and len(value) == 3:
        x, y, z = (_number(part, where) for part in value)
        if x is not None and y is not None and z is not None:
            return x, y, z
    raise RecordingError(f"{where} is {show(value)}, expected three numbers [x, y, z]")


def _unit_vector(vector: tuple[float, float, float], where: str) -> tuple[float, float, float]:
    length = math.hypot(*vector)
    if not 0 < length < math.inf:
        raise RecordingError(f"{where} is {show(list(vector))}, expected a vector with a length")
    if math.isclose(length, 1.0, rel_tol=1e-9):
        return vector
    x, y, z = (part / length for part in vector)
    return x, y, z


def _spelling(unit: str) -> str:
    return unit.replace("²", "2").translate({ord(sign): None for sign in " ^·*"})


def _refuse(where: str, reason: str) -> NoReturn:
    raise RecordingError(f"{where}: {reason}")
