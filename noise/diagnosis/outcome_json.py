"""``diagnosis.json``: a diagnosis as JSON data, and back, by one table of its records."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from noise.diagnosis.outcome import (
    Agreement,
    Diagnosis,
    EffectFinding,
    HypothesisFinding,
    Location,
    Remainder,
    StageFinding,
)


@dataclass(frozen=True)
class _Key:
    """An entry of an object: its attribute, and how numbers are written."""

    attribute: str
    digits: int = 4
    scale: float = 1.0
    of: type | None = None
    """Record that it is, or that it holds as values of an object or as entries of a list."""
    optional: bool = False
    """Whether a number may be missing; otherwise what is missing is not a number."""


_FIGURES = (
    "gap_before", "gap_recalibrated", "gap_after", "gap_floor", "closed", "closed_low",
    "closed_high", "closed_by_effect",
)  # fmt: skip
"""Of an effect."""

_PLACE = {"channels": _Key("channels"), "band_hz": _Key("band", 1)}

_KEYS: dict[type, dict[str, _Key]] = {
    StageFinding: {name: _Key(name) for name in ("gap", "share", "p_value")},
    Location: {"stage": _Key("stage"), **_PLACE}
    | {name: _Key(name) for name in ("phase", "conditions", "p_value")},
    EffectFinding: {name: _Key(name) for name in ("name", "stage", "probability")}
    | {"parameters": _Key("parameters", 6), "strength": _Key("strength", optional=True)}
    | {name: _Key(name, optional=True) for name in _FIGURES}
    | {"fitted_with": _Key("fitted_with")},
    HypothesisFinding: {
        "causes": _Key("causes"),
        "probability": _Key("probability"),
        "gap_after": _Key("gap", optional=True),
    },
    Agreement: {
        "recording": _Key("recording"),
        "speed_rad_s": _Key("speed", 6),
        "interference_mm": _Key("interference", 6, 1e3),
        "gap": _Key("gap"),
        "channels": _Key("channels"),
    },
    Remainder: {"gap": _Key("gap"), **_PLACE},
    Diagnosis: {
        "verdict": _Key("verdict"),
        "equivalent": _Key("equivalent"),
        "location": _Key("location", of=Location),
        "map": _Key("differences", of=Location),
        "stages": _Key("stages", of=StageFinding),
        "effects": _Key("effects", of=EffectFinding),
        "probabilities": _Key("probabilities"),
        "parameters": _Key("parameters"),
        "next_measurement": _Key("next_measurement"),
        "held_out": _Key("held_out"),
        "gap": _Key("gap"),
        "gap_floor": _Key("floor"),
        "p_value": _Key("p_value"),
        "hypotheses": _Key("hypotheses", of=HypothesisFinding),
        "agreement": _Key("agreement", of=Agreement),
        "remainder": _Key("remainder", of=Remainder),
        "bench": _Key("bench"),
        "faults": _Key("faults"),
        "notes": _Key("notes"),
        "seconds": _Key("seconds", 1),
    },
}


def as_json(diagnosis: Diagnosis, improved: str | None = None) -> dict[str, Any]:
    """Return a diagnosis as ``diagnosis.json`` has it.

    Parameters
    ----------
    diagnosis : Diagnosis
    improved : str, optional
        Name of the file of the improved rig that lies beside it.
    """
    written: dict[str, Any] = _written(diagnosis, _Key(""))
    return written | {"improved": improved}


def from_json(data: Mapping[str, Any]) -> Diagnosis:
    """Return the diagnosis that ``diagnosis.json`` holds, without its illustrations.

    Parameters
    ----------
    data : mapping of str to anything
        As `as_json` gives it.

    Raises
    ------
    KeyError, TypeError, ValueError
        It is no diagnosis.
    """
    for key in ("verdict", "equivalent", "location", "effects", "probabilities"):
        data[key]
    diagnosis: Diagnosis = _record(Diagnosis, _UNKNOWN | dict(data))
    return diagnosis


_UNKNOWN: dict[str, Any] = {
    "stages": {}, "parameters": {}, "next_measurement": "", "held_out": [], "gap": None,
    "gap_floor": None, "p_value": None, "seconds": None,
}  # fmt: skip
"""What a file may lack."""


def _written(value: Any, key: _Key) -> Any:
    """Return a value of plain data: records as objects, numbers rounded, none as null."""
    if type(value) in _KEYS:
        keys = _KEYS[type(value)].items()
        return {name: _written(getattr(value, key.attribute), key) for name, key in keys}
    if isinstance(value, Mapping):
        return {name: _written(one, key) for name, one in value.items()}
    if isinstance(value, tuple | list):
        return [_written(one, key) for one in value]
    if value is None or isinstance(value, str):
        return value
    return round(float(value * key.scale), key.digits) if math.isfinite(value) else None


def _record(kind: type, data: Mapping[str, Any]) -> Any:
    """Return a record of the data of an object; what is not there stays at its default."""
    return kind(**{
        key.attribute: _read(data[name], key) for name, key in _KEYS[kind].items() if name in data
    })  # fmt: skip


def _read(value: Any, key: _Key) -> Any:
    if value is None:
        return None if key.optional or key.of is not None else math.nan
    if isinstance(value, Mapping):
        if key.of is not None and set(value) & set(_KEYS.get(key.of, {})):
            return _record(key.of, value)
        return {name: _read(one, key) for name, one in value.items()}
    if isinstance(value, list | tuple):
        records = key.of is not None
        return tuple(_record(key.of, one) if records else _read(one, key) for one in value)  # type: ignore[arg-type]
    return value if isinstance(value, str) else float(value) / key.scale
