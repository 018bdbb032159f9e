"""What a diagnosis finds, piece by piece: stages, places, effects, what is heard, what is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from models.show import short_repr

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.diagnosis.evidence.friction_curves import FrictionCurves


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
        90 % interval of the parameter that switches it off.
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
