"""Result of a diagnosis, and its form in `diagnosis.json`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import TYPE_CHECKING, Any

from models.show import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from models.recording import Recording
    from models.rig import LawSpec, Rig


LARGEST_GAP = 100.0
"""Upper limit of gaps [-]: larger ones come from numbers that hardly scatter; assumed."""

SURE = 0.05
"""Significance level of stages and places [-]; the customary one, assumed."""

_DRAWN = 10
"""Number of causes that are drawn; assumed."""

ROLES = ("measured", "before", "after")
"""Recording, nominal model and fitted model of a comparison."""


@dataclass(frozen=True)
class StageFinding:
    """Difference in a stage of the chain.

    Parameters
    ----------
    gap : float
        Relative to that of repeats, `LARGEST_GAP` at most [-].
    share : float
        Share of the whole gap [-].
    p_value : float
        p-value of the difference, corrected for the number of tests.
    """

    gap: float
    share: float
    p_value: float


@short_repr
@dataclass(frozen=True)
class Location:
    """Place of a difference.

    Parameters
    ----------
    stage : str
    channels : tuple of str
    band : (float, float)
        [Hz]
    phase : str
        Phase of the stick-slip cycle: ``stick``, ``slip``, ``cycle`` (as a whole) or ``all``.
    conditions : str
        Conditions in which it shows, such as ``speed_rad_s >= 2.5``, or ``all``.
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
    """Candidate cause.

    Parameters
    ----------
    name, stage : str
    probability : float
        Probability that it is present, alone or with others [-].
    parameters : mapping of str to float or str
        Fitted values; empty without a fit [unit of the parameter].
    strength : (float, float), optional
        90 % interval of the parameter that switches it off, given the form and the other numbers as
        fitted; another form may need another strength.
    gap_before, gap_recalibrated, gap_after, gap_floor : float, optional
        Gaps of held-out recordings, relative to that of repeats; None without a fit [-].
    closed, closed_low, closed_high, closed_by_effect : float, optional
        Shares of the closable gap, with a 90 % interval; None if there is nothing to close.
    fitted_with : tuple of str
        Effects of the same fit.
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
class Agreement:
    """Gap of a recording from the simulation of the rig file.

    Parameters
    ----------
    recording : str
    speed, interference : float
        [rad/s], [m]
    gap : float
        Gap of all channels together, relative to that of repeats [-].
    channels : mapping of str to float
        Gap of each kind of channel [-].
    """

    recording: str
    speed: float
    interference: float
    gap: float
    channels: Mapping[str, float]


@short_repr
@dataclass(frozen=True, eq=False)
class Illustration:
    """Held-out recording with its simulations, for pictures and players."""

    name: str
    measured: Recording
    before: Recording
    after: Recording | None


@short_repr
@dataclass(frozen=True, eq=False)
class Improvement:
    """Improved rig.

    Parameters
    ----------
    rig : Rig
        Improved rig.
    factors : mapping of str to float
        Factors on parameters of the diagnosed rig [-].
    effects : tuple of LawSpec
        Effects that are added.
    spread : mapping of str to float
        Relative standard deviation of each fitted number, by its name in ``[tolerances]`` [-].
    undetermined : tuple of str
        Fitted numbers that the recordings hardly determine.
    fitted_to, held_out : tuple of str
        Recordings.
    gap_before, gap_after : float
        Gaps of held-out recordings, relative to that of repeats [-].
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
    """Result of a diagnosis.

    Parameters
    ----------
    verdict : tuple of str
        Empty: no gap beyond repeatability; ``("parameters",)``; ``("unknown",)``; or one to three
        effects.
    equivalent : tuple of (str, str)
        Pairs of effects that these channels cannot distinguish.
    location : Location, optional
        None without a gap.
    stages : mapping of str to StageFinding
        By `sim.effects.effect.Stage`, in the order of the chain.
    effects : tuple of EffectFinding
        The most probable first; ``parameters`` and ``unknown`` are not among them.
    probabilities : mapping of str to float
        Probability of ``none``, ``parameters``, ``unknown`` and of the presence of each effect [-].
    parameters : mapping of str to (float, float)
        90 % interval of each rig parameter, relative to the rig file.
    next_measurement : str
    held_out : tuple of str
        Recordings that no fit used.
    gap, floor, p_value : float
        Gap of all recordings before any fit, that of repeats, and p-value [-].
    seconds : float
        Time taken [s].
    notes : tuple of str
        Notes on missing data and bad channels.
    illustrations : tuple of Illustration
    differences : tuple of Location
        Stages, channels, bands and phases that differ, with p-values corrected for the number of
        tests; the smallest first.
    improvement : Improvement, optional
        None if nothing closes the gap, and without fits.
    agreement : tuple of Agreement
        Gap of each recording before any fit.
    bench : tuple of str
        Reasons why the recordings cannot be of this rig, one line each; the verdict is then
        ``("unknown",)``.
    faults : tuple of str
        Channels that are dead (and left out) or clip, one line each.

    Examples
    --------
    >>> hum = Diagnosis(("mains_hum",), (), None, {}, (), {"mains_hum": 0.97}, {}, "", (),
    ...                 5.0, 1.0, 1e-6, 20.0)
    >>> hum.verdict, hum.probabilities["mains_hum"], hum.gap
    (('mains_hum',), 0.97, 5.0)
    """

    verdict: tuple[str, ...]
    equivalent: tuple[tuple[str, str], ...] = ()
    location: Location | None = None
    stages: Mapping[str, StageFinding] = field(default_factory=dict)
    effects: tuple[EffectFinding, ...] = ()
    probabilities: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    next_measurement: str = ""
    held_out: tuple[str, ...] = ()
    gap: float = math.nan
    floor: float = 1.0
    p_value: float = math.nan
    seconds: float = 0.0
    notes: tuple[str, ...] = ()
    illustrations: tuple[Illustration, ...] = ()
    differences: tuple[Location, ...] = ()
    improvement: Improvement | None = None
    agreement: tuple[Agreement, ...] = ()
    bench: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def improved(self) -> Rig | None:
        """Improved rig; None if nothing closes the gap."""
        return None if self.improvement is None else self.improvement.rig

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the probability of each cause, those of the verdict in blue.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from models.drawing import BLUE, GREY, axes_or_new
        from noise.diagnosis.sentences import headline
        from noise.diagnosis.words import cause_of, percent

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


_KEYS: dict[type, dict[str, str]] = {
    Diagnosis: {"differences": "map", "floor": "gap_floor"},
    Location: {"band": "band_hz"},
    Agreement: {"speed": "speed_rad_s", "interference": "interference_mm"},
}
"""Keys of fields that have another name in the file."""

_LEFT_OUT = ("illustrations", "improvement")

_DIGITS = {"band_hz": 1, "seconds": 1, "speed_rad_s": 6, "interference_mm": 6}
_OF_PARAMETERS, _USUAL = 6, 4
"""Digits of the parameters of effects, and of all other numbers."""

_MILLIMETRES = 1e3


def as_json(diagnosis: Diagnosis, improved: str | None = None) -> dict[str, Any]:
    """Return the content of ``diagnosis.json``, with headline and sentences of the answer.

    Parameters
    ----------
    diagnosis : Diagnosis
    improved : str, optional
        Name of the file of the improved rig.
    """
    from noise.diagnosis.sentences import answer, headline

    words = {"headline": headline(diagnosis), "sentences": answer(diagnosis)}
    return {**_plain(diagnosis, _USUAL), "improved": improved, **words}


def _plain(value: Any, digits: int) -> Any:
    """Return a value as plain data: records as objects, numbers rounded, NaN as null."""
    if is_dataclass(value):
        keys, many = _KEYS.get(type(value), {}), isinstance(value, EffectFinding)
        plain = {}
        for one in fields(value):
            key, of_field = keys.get(one.name, one.name), getattr(value, one.name)
            if key == "interference_mm":
                of_field *= _MILLIMETRES
            if key not in _LEFT_OUT:
                usual = _OF_PARAMETERS if many and key == "parameters" else _USUAL
                plain[key] = _plain(of_field, _DIGITS.get(key, usual))
        return plain
    if isinstance(value, Mapping):
        return {name: _plain(one, digits) for name, one in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(one, digits) for one in value]
    if value is None or isinstance(value, str):
        return value
    return round(float(value), digits) if math.isfinite(value) else None
