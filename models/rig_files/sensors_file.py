"""The ``[sensors]`` table of a rig file: noise, range, converter, anti-alias filter, calibration.

Each key is a table by kind of channel, ``range = { torque = 102.5 }``; ``bits`` and
``antialias_hz`` may be one number for all: that of the converter holds for the channels whose range
is stated, since a step is a share of the range. ``noise = "from recordings"`` leaves the noise to
be estimated where there are recordings to estimate it from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from models.checks import a_number, a_table, refuse_unknown
from models.errors import ParameterError
from models.rig_files.calibration_file import calibration_text, read_calibration
from models.sensors import Sensor, Sensors
from models.units import CHANNEL_UNITS

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["FROM_RECORDINGS", "read_sensors", "sensors_text"]

FROM_RECORDINGS = "from recordings"

_KEYS = {"noise", "range", "bits", "antialias_hz", "calibration"}


def read_sensors(table: Any, base: Sensors, folder: Path, where: str) -> Sensors:
    """Read sensors from a rig file's table, laid over those of its base.

    Parameters
    ----------
    table : mapping
        As the TOML file holds it.
    base : Sensors
        Of what the file changes.
    folder : Path
        Of the rig file; names of tables are relative to it.
    where : str
        What messages call the table.

    Raises
    ------
    ParameterError
        It holds what cannot be used; the message names the key.

    Examples
    --------
    >>> from pathlib import Path
    >>> table = {"range": {"torque": 102.5}, "bits": 12}
    >>> read_sensors(table, Sensors(), Path(), "rig").of("torque").step
    0.050048828125
    """
    table = a_table(table, "sensors", where)
    refuse_unknown(table, _KEYS, where)
    noise = table.get("noise", {})
    estimated = noise == FROM_RECORDINGS
    if not (estimated or isinstance(noise, Mapping)):
        raise ParameterError(
            f'{where}: noise = {noise!r} must be "{FROM_RECORDINGS}", or a table such as '
            "{ torque = 0.01, pressure = 2e-3 }"
        )
    said: dict[str, dict[str, Any]] = {
        "noise": {} if estimated else _by_kind(noise, "noise", where, closed=True),
        "full_scale": _by_kind(table.get("range", {}), "range", where),
    }
    known = [*said["full_scale"], *(k for k, s in base.by_kind.items() if s.full_scale is not None)]
    said["bits"] = _bits(table.get("bits", {}), known, where)
    said["antialias"] = _by_kind(
        table.get("antialias_hz", {}), "antialias_hz", where, all_of=tuple(CHANNEL_UNITS)
    )
    calibrations = a_table(table.get("calibration", {}), "calibration", where)
    refuse_unknown(calibrations, set(CHANNEL_UNITS), f"{where}, calibration")
    said["calibration"] = {
        kind: read_calibration(given, kind, folder, f"{where}, calibration of {kind}")
        for kind, given in calibrations.items()
    }
    kinds = dict.fromkeys(kind for values in said.values() for kind in values)
    own = Sensors(
        {kind: Sensor(**{n: v[kind] for n, v in said.items() if kind in v}) for kind in kinds}
    )
    # What is stated ends an estimate of the base's, and an estimate what the base states.
    below = replace(base, noise_from_recordings=base.noise_from_recordings and not said["noise"])
    if estimated:
        quiet = {kind: replace(sensor, noise=None) for kind, sensor in base.by_kind.items()}
        below = Sensors(quiet, noise_from_recordings=True)
    return own.over(below)


def _by_kind(
    given: Any, key: str, where: str, *, closed: bool = False, all_of: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Numbers of a key by kind of channel; one number stands for `all_of`."""
    if all_of and not isinstance(given, Mapping):
        number = a_number({key: given}, key, where)
        return dict.fromkeys(all_of, number)
    if not isinstance(given, Mapping):
        raise ParameterError(
            f"{where}: {key} = {given!r} must be a table by channel, such as {{ torque = 50 }}"
        )
    refuse_unknown(given, set(CHANNEL_UNITS), f"{where}, {key}")
    return {kind: a_number(given, kind, f"{where}, {key}", closed=closed) for kind in given}


def _bits(given: Any, known: list[str], where: str) -> dict[str, int]:
    """Bits by kind of channel; `known` are those whose range is."""
    found = _by_kind(given, "bits", where, all_of=tuple(known) or ("any",))
    for kind, bits in found.items():
        if kind not in known:
            named = "" if kind == "any" else f" of {kind}"
            raise ParameterError(
                f"{where}: bits{named} without a range, of which a step is a share; add range = "
                f"{{ {'torque' if kind == 'any' else kind} = ... }}"
            )
        if bits != int(bits):
            raise ParameterError(f"{where}: bits = {bits!r} must be a whole number")
    return {kind: int(bits) for kind, bits in found.items()}


def sensors_text(sensors: Sensors) -> list[str]:
    """Write sensors as the lines of a rig file's table; none where all are ideal.

    Examples
    --------
    >>> sensors_text(Sensors({"torque": Sensor(full_scale=102.5, bits=12)}))
    ['[sensors]', 'range = { torque = 102.5 }', 'bits = { torque = 12 }']
    """
    lines = []
    if sensors.noise_from_recordings:
        lines.append(f'noise = "{FROM_RECORDINGS}"')
    for key, name in (
        ("noise", "noise"),
        ("range", "full_scale"),
        ("bits", "bits"),
        ("antialias_hz", "antialias"),
    ):
        values = {kind: getattr(sensor, name) for kind, sensor in sensors.by_kind.items()}
        said = ", ".join(f"{kind} = {x:.9g}" for kind, x in values.items() if x is not None)
        lines += [f"{key} = {{ {said} }}"] if said else []
    for kind, calibration in sensors.calibrations.items():
        lines.append(f"calibration.{kind} = {calibration_text(calibration, kind)}")
    return ["[sensors]", *lines] if lines else []
