"""Result of an identification, and its form in ``identification.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from models.condition import FIXED, KnownCondition
from models.show import short_repr

if TYPE_CHECKING:
    from pandas import DataFrame

    from noise.base.arrays import Array
    from noise.identification.bushing_fit import BushingFit, Levels
    from noise.identification.measured import Measured


UNITS = {
    "elastomer_stiffness": "Nm/rad",
    "critical_torque": "Nm",
    "kinetic_torque": "Nm",
    "damping": "Nm s/rad",
    "elastomer_inertia": "kg m2",
    "clamp_inertia": "kg m2",
    "elastomer_damping_share": "",
}
"""Units of the numbers of a rig."""


@dataclass(frozen=True)
class Number:
    """Number of a rig with its 90 % interval.

    Parameters
    ----------
    name, unit : str
    value, low, high : float
        [as `unit` says]
    n_recordings : int
        Number of recordings that it comes from.
    interference : float, optional
        [m]
    support_stiffness : float, optional
        [Nm/rad]; ``math.inf`` for the clamp bolted down.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    n_recordings: int
    interference: float | None = None
    support_stiffness: float | None = None


@short_repr
@dataclass(frozen=True)
class LawScore:
    """Misfit of a friction law.

    Parameters
    ----------
    law : str
        Of `noise.identification.law_model`.
    held_out : float
        Share of the oscillation over a cycle or two that it fails to predict in held-out
        recordings [-].
    trained, missed : float
        The same of recordings that it was fitted to, and of all [-].
    parameters : mapping of str to float
        [units of the law's file]
    """

    law: str
    held_out: float
    trained: float
    missed: float
    parameters: Mapping[str, float]


@short_repr
@dataclass(frozen=True, eq=False)
class Forecast:
    """Recorded and predicted torque of an excerpt.

    Parameters
    ----------
    rate : float
        [Hz]
    recorded, predicted : ndarray, shape (n,)
        Torque of the cell [Nm].
    """

    rate: float
    recorded: Array
    predicted: Array


@short_repr
@dataclass(frozen=True, eq=False)
class RecordingFit:
    """Recording with its bushing and torque levels.

    Parameters
    ----------
    measured : Measured
    fit : BushingFit
    levels : Levels
    forecast : Forecast, optional
        Present if the law was fitted to it.
    """

    measured: Measured
    fit: BushingFit
    levels: Levels
    forecast: Forecast | None = None


_NUMBER_COLUMNS = (
    "name", "unit", "interference_mm", "support_stiffness_Nm_rad",
    "value", "low", "high", "recordings",
)  # fmt: skip


@short_repr
@dataclass(frozen=True, eq=False)
class Identification:
    """Identified rig.

    Parameters
    ----------
    rig_toml : str
        The rig file.
    numbers : tuple of Number
    laws : tuple of LawScore
        Best first.
    law : str
        Name of the chosen law.
    recordings : tuple of RecordingFit
    assumed, not_found, notes : tuple of str
        Assumptions of the rig file, numbers that these recordings do not determine, and notes.
    refused : tuple of (str, str)
        Recordings that are left out, with the reason.
    held_out : tuple of str
        Recordings that the laws were compared on.
    margin : float
        Factor by which a simpler law may miss more and is still chosen.
    seconds : float
        Time taken [s].

    Examples
    --------
    >>> stiffness = Number("elastomer_stiffness", "Nm/rad", 665.0, 655.0, 675.0, 6, 0.279e-3)
    >>> Identification("", (stiffness,), (), "constant", ()).numbers[0].high
    675.0
    """

    rig_toml: str
    numbers: tuple[Number, ...]
    laws: tuple[LawScore, ...]
    law: str
    recordings: tuple[RecordingFit, ...]
    assumed: tuple[str, ...] = ()
    not_found: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    refused: tuple[tuple[str, str], ...] = ()
    held_out: tuple[str, ...] = ()
    margin: float = 0.0
    seconds: float = field(default=0.0, compare=False)

    def to_pandas(self) -> DataFrame:
        """Return one row per number as a data frame of pandas, as ``identification.json`` names it.

        Returns
        -------
        pandas.DataFrame
            Values in their own units, with their intervals of 90 %.

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame

        return data_frame(_NUMBER_COLUMNS, map(_number, self.numbers))


def as_json(result: Identification) -> dict[str, Any]:
    """Return the content of ``identification.json``."""
    return {
        "law": result.law,
        "numbers": [_number(one) for one in result.numbers],
        "laws": [_rounded(asdict(one)) for one in result.laws],
        "margin": result.margin,
        "held_out": list(result.held_out),
        "recordings": [_recording(one) for one in result.recordings],
        "assumed": list(result.assumed),
        "not_found": list(result.not_found),
        "notes": list(result.notes),
        "refused": [{"file": name, "reason": reason} for name, reason in result.refused],
        "seconds": round(result.seconds, 2),
    }


def _rounded(value: Any) -> Any:
    """Return plain data with numbers rounded to five digits."""
    if isinstance(value, Mapping):
        return {key: _rounded(one) for key, one in value.items()}
    return float(f"{value:.5g}") if isinstance(value, float) else value


def _place(one: Number | KnownCondition) -> dict[str, Any]:
    """Return interference and support, if there are any."""
    row: dict[str, Any] = {}
    if one.interference is not None:
        row["interference_mm"] = 1e3 * one.interference
    if (support := one.support_stiffness) is not None:
        row["support_stiffness_Nm_rad"] = "fixed" if support == FIXED else support
    return row


def _number(one: Number) -> dict[str, Any]:
    row = {"name": one.name, "unit": one.unit, **_place(one)}
    row |= {"value": one.value, "low": one.low, "high": one.high, "recordings": one.n_recordings}
    return dict(_rounded(row))


def _recording(one: RecordingFit) -> dict[str, Any]:
    speed = {"speed_rad_s": one.measured.written_speed}
    row = _place(one.measured.condition) | {
        "elastomer_stiffness_Nm_rad": one.fit.bushing.elastomer_stiffness,
        "damping_Nms_rad": one.fit.damping,
        "mean_torque_Nm": one.levels.mean,
        "critical_torque_Nm": one.levels.critical,
        "kinetic_torque_Nm": one.levels.kinetic,
        "slips": one.levels.slips, "stuck_share": round(float(one.fit.phases.stuck.mean()), 3),
    }  # fmt: skip
    return {"file": one.measured.name, **speed, **_rounded(row)}
