"""``diagnosis.json``: a diagnosis as JSON data, and back, by the fields of its records."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
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

_RECORDS = {
    "location": Location, "map": Location, "stages": StageFinding, "effects": EffectFinding,
    "hypotheses": HypothesisFinding, "agreement": Agreement, "remainder": Remainder,
}  # fmt: skip
"""Of a diagnosis: what a key is, or holds as values of an object or as entries of a list."""

_NAMES: dict[type, dict[str, str]] = {
    Diagnosis: {"differences": "map", "floor": "gap_floor"},
    Location: {"band": "band_hz"},
    Remainder: {"band": "band_hz"},
    HypothesisFinding: {"gap": "gap_after"},
    Agreement: {"speed": "speed_rad_s", "interference": "interference_mm"},
}
"""Keys of fields that are called otherwise in the file."""

_LEFT_OUT = ("illustrations", "improvement")

_DIGITS = {"band_hz": 1, "seconds": 1, "speed_rad_s": 6, "interference_mm": 6}
_OF_PARAMETERS, _USUAL = 6, 4
"""Digits of the numbers of effects, and of all others."""

_MILLIMETRES = 1e3


def _keys(kind: type) -> dict[str, Any]:
    """Return the fields of a record by their keys."""
    names = _NAMES.get(kind, {})
    return {names.get(one.name, one.name): one for one in fields(kind) if one.name not in _LEFT_OUT}


def as_json(diagnosis: Diagnosis, improved: str | None = None) -> dict[str, Any]:
    """Return a diagnosis as ``diagnosis.json`` has it.

    Parameters
    ----------
    diagnosis : Diagnosis
    improved : str, optional
        Name of the file of the improved rig that lies beside it.
    """
    written: dict[str, Any] = _written(diagnosis, _USUAL)
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


def _written(value: Any, digits: int) -> Any:
    """Return a value of plain data: records as objects, numbers rounded, none as null."""
    if type(value) in {Diagnosis, *_RECORDS.values()}:
        many = _OF_PARAMETERS if isinstance(value, EffectFinding) else _USUAL
        given = {key: getattr(value, one.name) for key, one in _keys(type(value)).items()}
        if "interference_mm" in given:
            given["interference_mm"] *= _MILLIMETRES
        return {
            key: _written(one, many if key == "parameters" else _DIGITS.get(key, _USUAL))
            for key, one in given.items()
        }
    if isinstance(value, Mapping):
        return {name: _written(one, digits) for name, one in value.items()}
    if isinstance(value, tuple | list):
        return [_written(one, digits) for one in value]
    if value is None or isinstance(value, str):
        return value
    return round(float(value), digits) if math.isfinite(value) else None


def _record(kind: type, data: Mapping[str, Any]) -> Any:
    """Return a record of the data of an object; what is not there stays at its default."""
    given: dict[str, Any] = {}
    for key, one in _keys(kind).items():
        if key in data:
            holds = _RECORDS.get(key) if kind is Diagnosis else None
            missing = None if holds is not None or one.default is None else math.nan
            given[one.name] = missing if data[key] is None else _read(data[key], holds)
    if kind is Agreement:
        given["interference"] /= _MILLIMETRES
    return kind(**given)


def _read(value: Any, holds: type | None) -> Any:
    """Return a value of a file, with what it holds as records."""
    if value is None:
        return math.nan
    if isinstance(value, Mapping):
        if holds is not None and set(value) & set(_keys(holds)):
            return _record(holds, value)
        return {name: _read(one, holds) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return tuple(_read(one, holds) for one in value)
    return value if isinstance(value, str) else float(value)
