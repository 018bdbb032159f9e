"""Sensors of a rig, with their amplifiers, filters and converters.

A signal passes the anti-alias filter, gets the noise of sensor and amplifier, and is rounded to the
steps of a converter that clips at its range. Properties that a file leaves out are ideal, except
for the noise, which is then that of `sim.acquisition`.

Each key of the ``[sensors]`` table of a rig file is a table by kind of channel, ``range = { torque
= 102.5 }``. ``bits`` and ``antialias_hz`` may be one number for all channels; bits then apply to
the channels with a stated range, since a step is a share of the range. With ``noise = "from
recordings"`` the noise is estimated where there are recordings.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from models.errors import ParameterError
from models.schema import Quantity, as_table, refuse_unknown
from models.units import CHANNEL_UNITS

FROM_RECORDINGS = "from recordings"

_ENTRIES = {
    "noise": Quantity("noise", high=1e9, closed=True),
    "full_scale": Quantity("range", low=1e-9, high=1e12),
    "bits": Quantity("bits", unit="bit", low=2.0, high=32.0),
    "antialias": Quantity("antialias_hz", unit="Hz", low=1.0, high=1e9),
}
"""Entries of the rig file's table, by the names of the fields."""


@dataclass(frozen=True)
class Sensor:
    """Sensor of one kind of channel, with its amplifier, filter and converter.

    Parameters
    ----------
    noise : float, optional
        Standard deviation of its white noise [unit of the channel].
    full_scale : float, optional
        Largest magnitude, beyond which the converter clips [unit of the channel].
    bits : int, optional
        Resolution of the converter: its range in both signs has ``2**bits`` steps.
    antialias : float, optional
        Corner of the anti-alias filter at -3 dB [Hz].

    Examples
    --------
    >>> Sensor(full_scale=102.5, bits=12).step
    0.050048828125
    """

    noise: float | None = None
    full_scale: float | None = None
    bits: int | None = None
    antialias: float | None = None

    @property
    def step(self) -> float:
        """Quantisation step [unit of the channel]; 0 without a converter."""
        if self.full_scale is None or self.bits is None:
            return 0.0
        return math.ldexp(self.full_scale, 1 - self.bits)

    def over(self, other: "Sensor") -> "Sensor":
        """Return this sensor, with properties that it does not state taken from another."""
        own = {each.name: getattr(self, each.name) for each in fields(self)}
        return replace(other, **{name: x for name, x in own.items() if x is not None})


@dataclass(frozen=True)
class Sensors:
    """Sensors of a rig by kind of channel.

    Parameters
    ----------
    by_kind : mapping of str to Sensor
        Sensors by kind of channel; a missing kind has an ideal one.
    noise_from_recordings : bool
        Whether the noise is estimated where there are recordings.

    Examples
    --------
    >>> fine, coarse = Sensors({"torque": Sensor(1e-3)}), Sensors({"torque": Sensor(bits=8)})
    >>> coarse.over(fine).of("torque")
    Sensor(noise=0.001, full_scale=None, bits=8, antialias=None)
    """

    by_kind: Mapping[str, Sensor] = field(default_factory=dict)
    noise_from_recordings: bool = False

    def of(self, kind: str) -> Sensor:
        """Return the sensor of a kind of channel."""
        return self.by_kind.get(kind, _IDEAL)

    def unfiltered(self) -> "Sensors":
        """Return these sensors without anti-alias filters."""
        without = {kind: replace(sensor, antialias=None) for kind, sensor in self.by_kind.items()}
        return replace(self, by_kind=without)

    def over(self, other: "Sensors") -> "Sensors":
        """Return these sensors, with properties that they do not state taken from others."""
        kinds = dict.fromkeys((*other.by_kind, *self.by_kind))
        return Sensors(
            {kind: self.of(kind).over(other.of(kind)) for kind in kinds},
            self.noise_from_recordings or other.noise_from_recordings,
        )


_IDEAL = Sensor()


def read_sensors(table: Any, base: Sensors, where: str) -> Sensors:
    """Read sensors from a rig file's table, on top of those of its base.

    Parameters
    ----------
    table : mapping
        Table of the TOML file.
    base : Sensors
        Sensors of the base.
    where : str
        Name of the table in messages.

    Raises
    ------
    ParameterError
        An entry cannot be used; the message names the key.

    Examples
    --------
    >>> table = {"range": {"torque": 102.5}, "bits": 12}
    >>> read_sensors(table, Sensors(), "rig, sensors").of("torque").step
    0.050048828125
    """
    table = as_table(table, "sensors", where)
    refuse_unknown(table, [entry.key for entry in _ENTRIES.values()], where)
    estimated = table.get("noise") == FROM_RECORDINGS
    stated: dict[str, dict[str, Any]] = {}
    for name, quantity in _ENTRIES.items():
        key = quantity.key
        entry = {} if key == "noise" and estimated else table.get(key, {})
        if not isinstance(entry, Mapping):
            ranges = {kind: s.full_scale for kind, s in base.by_kind.items()}
            ranges |= stated.get("full_scale", {})
            entry = _for_all(entry, name, [k for k, scale in ranges.items() if scale], where)
        refuse_unknown(entry, CHANNEL_UNITS, f"{where}, {key}")
        stated[name] = {
            kind: replace(quantity, key=f"{key}.{kind}").read(value, where)
            for kind, value in entry.items()
        }
    kinds = dict.fromkeys(kind for values in stated.values() for kind in values)
    own = Sensors(
        {kind: Sensor(**{n: v[kind] for n, v in stated.items() if kind in v}) for kind in kinds}
    )
    # A stated noise replaces an estimate of the base, and an estimate replaces a noise of the base.
    below = replace(base, noise_from_recordings=base.noise_from_recordings and not stated["noise"])
    if estimated:
        quiet = {kind: replace(sensor, noise=None) for kind, sensor in base.by_kind.items()}
        below = Sensors(quiet, noise_from_recordings=True)
    return _checked(own.over(below), where)


def _for_all(value: Any, name: str, ranged: list[str], where: str) -> dict[str, Any]:
    """Return one number for all kinds of channel, or for those whose range is stated."""
    if name == "antialias":
        return dict.fromkeys(CHANNEL_UNITS, value)
    if name == "bits":
        return dict.fromkeys(ranged or CHANNEL_UNITS, value)
    words = f'"{FROM_RECORDINGS}", or ' if name == "noise" else ""
    raise ParameterError(
        f"{where}: {_ENTRIES[name].key} = {value!r} must be {words}a table by channel, such as "
        "{ torque = 50 }"
    )


def _checked(sensors: Sensors, where: str) -> Sensors:
    """Return sensors with bits as integers; raise if bits are fractional or have no range."""
    checked = {}
    for kind, sensor in sensors.by_kind.items():
        bits = None if sensor.bits is None else int(sensor.bits)
        if bits is not None and sensor.full_scale is None:
            raise ParameterError(
                f"{where}: bits of {kind} without a range, of which a step is a share; add range = "
                f"{{ {kind} = ... }}"
            )
        if bits != sensor.bits:
            raise ParameterError(f"{where}: bits = {sensor.bits!r} must be a whole number")
        checked[kind] = replace(sensor, bits=bits)
    return replace(sensors, by_kind=checked)
