"""``diagnosis.json``: a diagnosis as JSON data, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, cast

from noise.diagnosis.findings import (
    ROLES,
    Agreement,
    EffectFinding,
    HypothesisFinding,
    LabelsAndLevels,
    Location,
    Remainder,
    StageFinding,
)
from noise.diagnosis.outcome import Diagnosis

_FIGURES = (
    "gap_before", "gap_recalibrated", "gap_after", "gap_floor", "closed", "closed_low",
    "closed_high", "closed_by_effect",
)  # fmt: skip
"""Of an effect."""


def as_json(diagnosis: Diagnosis, improved: str | None = None) -> dict[str, Any]:
    """Return a diagnosis as ``diagnosis.json`` has it.

    Parameters
    ----------
    diagnosis : Diagnosis
    improved : str, optional
        Name of the file beside it that holds the improved rig.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> as_json(nothing)["verdict"], as_json(nothing)["location"]
    ([], None)
    """
    return {
        "verdict": list(diagnosis.verdict),
        "equivalent": [list(pair) for pair in diagnosis.equivalent],
        "location": None if diagnosis.location is None else _location(diagnosis.location),
        "map": [_location(place) for place in diagnosis.differences],
        "stages": {
            name: {
                "gap": _rounded(stage.gap), "share": _rounded(stage.share),
                "p_value": _rounded(stage.p_value),
            }
            for name, stage in diagnosis.stages.items()
        },
        "effects": [_effect(effect) for effect in diagnosis.effects],
        "probabilities": {n: _rounded(p) for n, p in diagnosis.probabilities.items()},
        "parameters": {
            name: [_rounded(x) for x in interval] for name, interval in diagnosis.parameters.items()
        },
        "improved": improved,
        "next_measurement": diagnosis.next_measurement,
        "held_out": list(diagnosis.held_out),
        "gap": _rounded(diagnosis.gap),
        "gap_floor": _rounded(diagnosis.floor),
        "p_value": _rounded(diagnosis.p_value),
        "heard": [
            {
                "recording": heard.recording,
                "label": {role: heard.of(role)[0] for role in ROLES},
                "level_dba": {role: _rounded(heard.of(role)[1], 1) for role in ROLES},
            }
            for heard in diagnosis.labels_and_levels
        ],
        "hypotheses": [
            {"causes": list(one.causes), "probability": _rounded(one.probability),
             "gap_after": _rounded(one.gap)}
            for one in diagnosis.hypotheses
        ],
        "agreement": [
            {"recording": one.recording, "speed_rad_s": _rounded(one.speed, 6),
             "interference_mm": _rounded(1e3 * one.interference, 6), "gap": _rounded(one.gap),
             "channels": {name: _rounded(gap) for name, gap in one.channels.items()}}
            for one in diagnosis.agreement
        ],
        "remainder": None if diagnosis.remainder is None else {
            "gap": _rounded(diagnosis.remainder.gap),
            "channels": list(diagnosis.remainder.channels),
            "band_hz": [_rounded(f, 1) for f in diagnosis.remainder.band],
        },
        "bench": list(diagnosis.bench),
        "faults": list(diagnosis.faults),
        "notes": list(diagnosis.notes),
        "seconds": _rounded(diagnosis.seconds, 1),
    }  # fmt: skip


def from_json(data: Mapping[str, Any]) -> Diagnosis:
    """Return the diagnosis that ``diagnosis.json`` holds, without its illustrations.

    Raises
    ------
    KeyError, TypeError, ValueError, AttributeError
        The data are those of no diagnosis.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> from_json(as_json(nothing)).gap
    0.9
    """
    return Diagnosis(
        verdict=tuple(data["verdict"]),
        equivalent=tuple((one, other) for one, other in data["equivalent"]),
        location=None if data["location"] is None else _location_from(data["location"]),
        stages={
            name: StageFinding(*(_number(found[key]) for key in ("gap", "share", "p_value")))
            for name, found in data.get("stages", {}).items()
        },
        effects=tuple(
            EffectFinding(
                each["name"],
                each["stage"],
                _number(each["probability"]),
                dict(each.get("parameters") or {}),
                cast("tuple[float, float] | None", tuple(each.get("strength") or ()) or None),
                **{name: each.get(name) for name in _FIGURES},
                fitted_with=tuple(each.get("fitted_with") or ()),
            )
            for each in data["effects"]
        ),
        probabilities={name: _number(p) for name, p in data["probabilities"].items()},
        parameters={
            name: (_number(low), _number(high)) for name, (low, high) in data["parameters"].items()
        },
        next_measurement=str(data.get("next_measurement") or ""),
        held_out=tuple(data.get("held_out") or ()),
        gap=_number(data.get("gap")),
        floor=_number(data.get("gap_floor")),
        p_value=_number(data.get("p_value")),
        seconds=_number(data.get("seconds")),
        notes=tuple(map(str, data.get("notes") or ())),
        labels_and_levels=tuple(
            LabelsAndLevels(
                one["recording"],
                *(one["label"].get(role) for role in ROLES),
                *(one["level_dba"].get(role) for role in ROLES),
            )
            for one in data.get("heard") or ()
        ),
        differences=tuple(map(_location_from, data.get("map") or ())),
        hypotheses=tuple(
            HypothesisFinding(
                tuple(one["causes"]), _number(one["probability"]), one.get("gap_after")
            )
            for one in data.get("hypotheses") or ()
        ),
        agreement=tuple(map(_agreement_from, data.get("agreement") or ())),
        remainder=_remainder_from(data.get("remainder")),
        bench=tuple(map(str, data.get("bench") or ())),
        faults=tuple(map(str, data.get("faults") or ())),
    )


def _location(place: Location) -> dict[str, Any]:
    return {
        "stage": place.stage,
        "channels": list(place.channels),
        "band_hz": [_rounded(f, 1) for f in place.band],
        "phase": place.phase,
        "conditions": place.conditions,
        "p_value": _rounded(place.p_value),
    }


def _location_from(place: Mapping[str, Any]) -> Location:
    low, high = map(_number, place["band_hz"])
    return Location(
        place["stage"], tuple(place["channels"]), (low, high), place["phase"],
        place["conditions"], _number(place["p_value"]),
    )  # fmt: skip


def _effect(effect: EffectFinding) -> dict[str, Any]:
    return {
        "name": effect.name,
        "stage": effect.stage,
        "probability": _rounded(effect.probability),
        "parameters": {
            name: value if isinstance(value, str) else _rounded(value, 6)
            for name, value in effect.parameters.items()
        },
        "strength": None if effect.strength is None else [_rounded(x) for x in effect.strength],
        **{name: _rounded(getattr(effect, name)) for name in _FIGURES},
        "fitted_with": list(effect.fitted_with),
    }


def _agreement_from(found: Mapping[str, Any]) -> Agreement:
    channels = {name: _number(gap) for name, gap in found["channels"].items()}
    return Agreement(
        found["recording"], _number(found["speed_rad_s"]),
        1e-3 * _number(found["interference_mm"]), _number(found["gap"]), channels,
    )  # fmt: skip


def _remainder_from(found: Mapping[str, Any] | None) -> Remainder | None:
    if found is None:
        return None
    low, high = map(_number, found["band_hz"])
    return Remainder(_number(found["gap"]), tuple(found["channels"]), (low, high))


def _rounded(value: float | None, digits: int = 4) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    return round(float(value), digits)


def _number(value: object) -> float:
    return float(cast("float", value)) if value is not None else math.nan
