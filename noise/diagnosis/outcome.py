"""Outcome of a diagnosis as plain data: for the report, for `diagnosis.json`, for a notebook.

It holds what is found piece by piece (stages, places, effects, what is heard and shown) and the
improved rig, with how sure its numbers are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from models.show import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from models.recording import Recording
    from models.rig import LawSpec, Rig
    from noise.diagnosis.evidence.contact_summary import FrictionCurves


LARGEST_GAP = 100.0
"""Floors that larger gaps are not told from [-]: they come from numbers that hardly scatter;
assumed."""

SURE = 0.05
"""p-value up to which a stage or a place is said to differ [-]; the customary level, assumed."""

SHOWN_IN = {
    "drive": ("drive", "friction"),
    "friction": ("friction",),
    "structure": ("structure",),
    "radiation": ("radiation",),
    "measurement": ("measurement", "friction", "structure", "radiation"),
}
"""Stages that an effect of each stage may show in: a shaft's motion hangs together with the
contact, and an error of a sensor looks like one of the way to it."""

_DRAWN = 10
"""Causes that are drawn, the most probable; assumed."""

ROLES = ("measured", "before", "after")
"""What is compared: the recording, the nominal model, and the fitted one."""


@dataclass(frozen=True)
class StageFinding:
    """How a stage of the chain differs.

    Parameters
    ----------
    gap : float
        In units of what repeats differ by; `LARGEST_GAP` stands for all that are larger [-].
    share : float
        Of the whole gap [-].
    p_value : float
        Of so large a difference between repeats, corrected for the number of looks.
    """

    gap: float
    share: float
    p_value: float


@short_repr
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


@short_repr
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
        90 % interval of the parameter that switches it off, given that the form and the other
        numbers are as fitted; another form may do the same at another strength.
    gap_before, gap_recalibrated, gap_after, gap_floor : float, optional
        On recordings that no fit has seen; None where it was not fitted, in floors [-].
    closed, closed_low, closed_high, closed_by_effect : float, optional
        Shares of the closable gap, with a 90 % interval; None where there is nothing to close.
    fitted_with : tuple of str
        Effects that share its fit and its figures.
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
    fitted_with: tuple[str, ...] = ()


@short_repr
@dataclass(frozen=True)
class HypothesisFinding:
    """Causes that may be at work together, and no others.

    Parameters
    ----------
    causes : tuple of str
        None where nothing is the matter.
    probability : float
        [-]
    gap : float, optional
        That is left with them on recordings that no fit has seen; None where it was not fitted, in
        floors [-].
    """

    causes: tuple[str, ...]
    probability: float
    gap: float | None = None


@short_repr
@dataclass(frozen=True)
class Agreement:
    """How far a recording lies from the rig as its file describes it.

    Parameters
    ----------
    recording : str
    speed, interference : float
        [rad/s], [m]
    gap : float
        In units of what repeats differ by [-].
    channels : mapping of str to float
        The same by kind of channel [-].
    """

    recording: str
    speed: float
    interference: float
    gap: float
    channels: Mapping[str, float]


@short_repr
@dataclass(frozen=True)
class Remainder:
    """What is still to be explained once the verdict's model is fitted.

    Parameters
    ----------
    gap : float
        On recordings that no fit has seen, in floors [-].
    channels : tuple of str
        In which it is largest, the first most of all.
    band : (float, float)
        [Hz]
    """

    gap: float
    channels: tuple[str, ...]
    band: tuple[float, float]


@short_repr
@dataclass(frozen=True, eq=False)
class Illustration:
    """One held-out recording beside its simulations, for pictures and players."""

    name: str
    measured: Recording
    before: Recording
    after: Recording | None
    contacts: Mapping[str, FrictionCurves] = field(default_factory=dict)
    """The friction torque of each, by ``measured``, ``before`` and ``after``."""


@short_repr
@dataclass(frozen=True, eq=False)
class Improvement:
    """What closes a gap, as a rig file can say it.

    Parameters
    ----------
    rig : Rig
        The improved one.
    factors : mapping of str to float
        On parameters of the rig that was diagnosed [-].
    effects : tuple of LawSpec
        That it gets besides those it has.
    spread : mapping of str to float
        Relative standard deviation of each fitted number, by the names that ``[tolerances]`` has
        [-].
    undetermined : tuple of str
        Fitted numbers of which the recordings say next to nothing.
    fitted_to, held_out : tuple of str
        Recordings.
    gap_before, gap_after : float
        On those held out, in floors [-].
    """

    rig: Rig
    factors: Mapping[str, float]
    effects: tuple[LawSpec, ...]
    spread: Mapping[str, float]
    undetermined: tuple[str, ...]
    fitted_to: tuple[str, ...]
    held_out: tuple[str, ...]
    gap_before: float
    gap_after: float


@short_repr
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
    illustrations : tuple of Illustration
    differences : tuple of Location
        Every stage, channel, band and phase with its p-value, corrected for the number of looks;
        the surest first.
    improvement : Improvement, optional
        What closes the gap; None where nothing does, and where it was not looked for.
    hypotheses : tuple of HypothesisFinding
        Sets of causes, the likeliest first.
    agreement : tuple of Agreement
        Of each recording with the rig file, before anything was fitted.
    remainder : Remainder, optional
        None where the fit leaves no more than repeats differ by, and where there was none.
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
    illustrations: tuple[Illustration, ...] = ()
    differences: tuple[Location, ...] = ()
    improvement: Improvement | None = None
    hypotheses: tuple[HypothesisFinding, ...] = ()
    agreement: tuple[Agreement, ...] = ()
    remainder: Remainder | None = None
    bench: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def improved(self) -> Rig | None:
        """The rig with what closes the gap; None where nothing does."""
        return None if self.improvement is None else self.improvement.rig

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how probable each cause is, those of the verdict in blue, the most probable on top.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from models.drawing import BLUE, GREY, axes_or_new
        from noise.diagnosis.text.verdict_sentences import headline
        from noise.diagnosis.text.words import cause_of, percent

        causes = sorted(self.probabilities.items(), key=lambda item: -item[1])[:_DRAWN]
        named = self.verdict or ("none",)
        with axes_or_new(ax) as axes:
            axes.barh(
                [cause_of(name).name for name, _ in causes],
                [100.0 * probability for _, probability in causes],
                color=[BLUE if name in named else GREY for name, _ in causes],
            )
            for row, (_, probability) in enumerate(causes):
                axes.text(100.0 * probability + 1.0, row, percent(probability), va="center")
            axes.set_ylim(len(causes) - 0.5, -0.5)
            axes.set_xlim(0.0, 112.0)
            axes.set_xticks(range(0, 101, 20))
            axes.set_xlabel("Probability of being at work [%]")
            axes.set_title(headline(self), loc="left")
        return axes

    def to_pandas(self) -> DataFrame:
        """Return one row an effect as a data frame of pandas, as ``diagnosis.json`` names it.

        Returns
        -------
        pandas.DataFrame
            The most probable first; its parameters are a dictionary.

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame

        effects = as_json(self)["effects"]
        return data_frame([*effects[0]] if effects else ["name"], effects)


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
