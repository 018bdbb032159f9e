"""Outcome of a diagnosis as plain data: for the report, for `diagnosis.json`, for a notebook."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

    from models.recording import Recording
    from models.rig import Rig
    from noise.diagnosis.evidence.friction_curves import FrictionCurves
    from noise.diagnosis.improvement import Improvement

__all__ = [
    "ROLES",
    "Diagnosis",
    "EffectFinding",
    "Illustration",
    "LabelsAndLevels",
    "Location",
    "StageFinding",
    "as_json",
    "from_json",
]


ROLES = ("measured", "before", "after")
"""What is compared: the recording, the nominal model, and the model with what was found."""

_FIGURES = (
    "gap_before", "gap_recalibrated", "gap_after", "gap_floor", "closed", "closed_low",
    "closed_high", "closed_by_effect",
)  # fmt: skip
"""Of an effect."""


@dataclass(frozen=True)
class StageFinding:
    """How a stage of the chain differs.

    Parameters
    ----------
    gap : float
        In units of what repeats differ by [-].
    share : float
        Of the whole gap [-].
    p_value : float
        Of so large a difference between repeats, corrected for the number of looks.
    """

    gap: float
    share: float
    p_value: float


@dataclass(frozen=True)
class Location:
    """Where the simulation goes wrong first.

    Parameters
    ----------
    stage : str
    channels : tuple of str
    band : (float, float)
        [Hz]
    phase : str
        Of the cycle: ``stick``, ``slip``, ``cycle`` where it is the cycle as a whole, or ``all``.
    conditions : str
        In which it shows, such as ``speed_rad_s >= 2.5``, or ``all``.
    p_value : float
        [-]
    """

    stage: str
    channels: tuple[str, ...]
    band: tuple[float, float]
    phase: str
    conditions: str
    p_value: float


@dataclass(frozen=True)
class EffectFinding:
    """A candidate cause.

    Parameters
    ----------
    name, stage : str
    probability : float
        That it is at work, alone or with others [-].
    parameters : mapping of str to float or str
        As fitted; empty where it was not [unit of the parameter].
    strength : (float, float), optional
        90 % interval of the parameter that switches it off.
    gap_before, gap_recalibrated, gap_after, gap_floor : float, optional
        On recordings that no fit has seen; None where it was not fitted, in floors [-].
    closed, closed_low, closed_high, closed_by_effect : float, optional
        Shares of the closable gap, with a 90 % interval; None where there is nothing to close.
    """

    name: str
    stage: str
    probability: float
    parameters: Mapping[str, float | str] = field(default_factory=dict)
    strength: tuple[float, float] | None = None
    gap_before: float | None = None
    gap_recalibrated: float | None = None
    gap_after: float | None = None
    gap_floor: float | None = None
    closed: float | None = None
    closed_low: float | None = None
    closed_high: float | None = None
    closed_by_effect: float | None = None


@dataclass(frozen=True)
class LabelsAndLevels:
    """What the user hears of it, of one held-out recording: label and level [dB(A)]."""

    recording: str
    label_measured: str | None
    label_before: str | None
    label_after: str | None
    level_measured: float | None
    level_before: float | None
    level_after: float | None

    def of(self, role: str) -> tuple[str | None, float | None]:
        """Return label and level [dB(A)] of ``measured``, ``before`` or ``after``."""
        return getattr(self, f"label_{role}"), getattr(self, f"level_{role}")


@dataclass(frozen=True, eq=False)
class Illustration:
    """One held-out recording beside its simulations, for pictures and players."""

    name: str
    measured: Recording
    before: Recording
    after: Recording | None
    contacts: Mapping[str, FrictionCurves] = field(default_factory=dict)
    """The friction torque of each, by ``measured``, ``before`` and ``after``."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The whole answer.

    Parameters
    ----------
    verdict : tuple of str
        Empty: no gap beyond repeatability; ``("parameters",)``; ``("unknown",)``; or one to three
        effects.
    equivalent : tuple of (str, str)
        Pairs of effects that these channels cannot separate.
    location : Location, optional
        None where there is no gap.
    stages : mapping of str to StageFinding
        By `sim.effects.effect.Stage`, in the order of the chain.
    effects : tuple of EffectFinding
        The most probable first; ``parameters`` and ``unknown`` are not among them.
    probabilities : mapping of str to float
        Of ``none``, ``parameters``, ``unknown`` and of each effect being at work [-].
    parameters : mapping of str to (float, float)
        90 % interval of each rig parameter, relative to the rig file.
    next_measurement : str
    held_out : tuple of str
        Recordings that no fit has seen.
    gap, floor, p_value : float
        Of the case as a whole, before anything was fitted [-].
    seconds : float
        That it took [s].
    notes : tuple of str
        What is missing and what that costs; channels in bad health.
    labels_and_levels : tuple of LabelsAndLevels
    illustrations : tuple of Illustration
    differences : tuple of Location
        Every stage, channel, band and phase with its p-value, corrected for the number of looks;
        the surest first.
    improvement : Improvement, optional
        What closes the gap; None where nothing does, and where it was not looked for.
    bench : tuple of str
        Why the recordings cannot be of the rig as it is described, one line each; nothing else was
        then looked for, and the verdict is ``("unknown",)``.
    faults : tuple of str
        Channels that are dead, and were left out, or clip, one line each.

    Examples
    --------
    >>> hum = Diagnosis(("mains_hum",), (), None, {}, (), {"mains_hum": 0.97}, {}, "", (),
    ...                 5.0, 1.0, 1e-6, 20.0)
    >>> hum.verdict, hum.probabilities["mains_hum"], hum.gap
    (('mains_hum',), 0.97, 5.0)
    """

    verdict: tuple[str, ...]
    equivalent: tuple[tuple[str, str], ...]
    location: Location | None
    stages: Mapping[str, StageFinding]
    effects: tuple[EffectFinding, ...]
    probabilities: Mapping[str, float]
    parameters: Mapping[str, tuple[float, float]]
    next_measurement: str
    held_out: tuple[str, ...]
    gap: float
    floor: float
    p_value: float
    seconds: float
    notes: tuple[str, ...] = ()
    labels_and_levels: tuple[LabelsAndLevels, ...] = ()
    illustrations: tuple[Illustration, ...] = ()
    differences: tuple[Location, ...] = ()
    improvement: Improvement | None = None
    bench: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def improved(self) -> Rig | None:
        """The rig with what closes the gap; None where nothing does."""
        return None if self.improvement is None else self.improvement.rig

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how probable each cause is.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from noise.diagnosis.text.diagnosis_display import draw_causes

        return draw_causes(self, ax)

    def _repr_html_(self) -> str:
        from noise.diagnosis.text.diagnosis_display import diagnosis_html

        return diagnosis_html(self)


def as_json(diagnosis: Diagnosis, improved: str | None = None) -> dict[str, Any]:
    """Return a diagnosis as ``diagnosis.json`` has it.

    Parameters
    ----------
    diagnosis : Diagnosis
    improved : str, optional
        Name of the file beside it that holds the improved rig.

    Examples
    --------
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
                *(each.get(name) for name in _FIGURES),
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
    }


def _rounded(value: float | None, digits: int = 4) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    return round(float(value), digits)


def _number(value: object) -> float:
    return float(cast("float", value)) if value is not None else math.nan
