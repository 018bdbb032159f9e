"""Options of an operating condition, and the arguments of the simulation from them.

Options that are not given are None, because defaults may come from elsewhere, as for ``--material``
from ``--rig``.
"""

from __future__ import annotations

import math
from argparse import ArgumentTypeError, Namespace
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from models.condition import CONDITION as QUANTITIES, Condition, support_stiffness
from models.errors import ParameterError, naming
from models.foreign_file import LARGEST_TEXT, reading
from models.rig import LawSpec, Rig, parse_spec
from noise.base.progress import note, say
from noise.base.remarks import (
    NEVER_SLIPS,
    clipping_remarks,
    effect_remarks,
    temperature_remark,
    use_remarks,
)
from noise.base.user_effects import effect_library
from noise.commands.options import CHANGE, Group, Option, changed, number, number_or_none

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from models.foreign_file import ForeignTable
    from models.recording import Recording
    from sim.effects.effect import Effect
    from sim.run import Run
    from sim.shaft import LoggedSpeed, ShaftMotion

_T = TypeVar("_T")

DEFAULT_MATERIAL = "fluorocarbon"
DEFAULT_SECONDS = 1.0
_FIT, _SUPPORT, _TEMPERATURE = (
    QUANTITIES[name] for name in ("interference", "support_stiffness", "temperature")
)


def speed(text: str) -> float | tuple[float, float] | Path:
    """Parse a speed [rad/s], the two ends of a ramp, or the path of a log."""
    start, dots, end = text.partition("..")
    if dots and number_or_none(start) is not None and number_or_none(end) is not None:
        return number()(start), number()(end)
    if number_or_none(text) is not None:
        return number()(text)
    if not Path(text).is_file():
        raise ArgumentTypeError(
            f"is {text!r}, expected a number in rad/s, a ramp such as 0..10, or a CSV file that "
            "exists"
        )
    return Path(text)


def swing(text: str) -> tuple[float, float]:
    """Parse amplitude [degree] and frequency [Hz] of an oscillation."""
    try:
        degrees, frequency = (number(above=0.0)(part) for part in text.split(","))
    except (ArgumentTypeError, ValueError):
        raise ArgumentTypeError(
            f"is {text!r}, expected degrees and Hz, both above 0, such as 15,2"
        ) from None
    return degrees, frequency


def _support_stiffness(text: str) -> float:
    """Parse a support stiffness [Nm/rad] or ``fixed``."""
    try:
        return support_stiffness(text.strip().lower())
    except ParameterError:
        raise ArgumentTypeError(
            f"is {text!r}, expected a number above 0 in Nm/rad, or fixed"
        ) from None


def _effect(text: str) -> LawSpec:
    """Parse an effect with its parameters."""
    try:
        return parse_spec(text)
    except ParameterError:
        raise ArgumentTypeError(f"is {text!r}, expected NAME or NAME:key=value,key=value") from None


CONDITION = Group(
    "operating condition",
    "Exactly one of --speed and --oscillate is needed.",
    (
        Option("--speed V", speed),
        Option("--oscillate DEG,HZ", swing),
        Option("--interference MM", number(above=0.0, most=_FIT.high)),
        Option("--support-stiffness K", _support_stiffness),
        Option("--material NAME", str),
        Option("--temperature C", number(least=_TEMPERATURE.low)),
        Option("--seconds S", number(above=0.0, most=120.0)),
        Option("--effect NAME[:KEY=VALUE,...]", _effect, repeated=True),
        Option("--effects FILE.py", Path),
        Option("--rig RIG.toml", Path),
        CHANGE,
    ),
)


def stated_options(options: Namespace) -> dict[str, Any]:
    """Return the options of a condition that the call states, by attribute."""
    values = {row.attribute: getattr(options, row.attribute) for row in CONDITION.rows}
    return {
        name: value for name, value in values.items() if value is not None and value is not False
    }


def run_arguments(
    options: Namespace, rate: float, *, rig: Rig | None = None
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return the arguments of `sim.run.simulate` for a condition, and notes for the user.

    Parameters
    ----------
    options : argparse.Namespace
        Options of `CONDITION` and ``seed``.
    rate : float
        Sampling rate of the recording [Hz].
    rig : Rig, optional
        Rig of ``--rig`` if it has been read already.

    Returns
    -------
    arguments : dict
    notes : tuple of str

    Raises
    ------
    ParameterError
        Options are missing, exclude each other, or name something unknown.
    """
    if (options.speed is None) == (options.oscillate is None):
        problem = "is needed" if options.speed is None else "can be given, not both"
        raise ParameterError(f"exactly one of --speed and --oscillate {problem}")
    seconds = _or(options.seconds, DEFAULT_SECONDS)
    if round(seconds * rate) < _LEAST_SAMPLES:
        raise ParameterError(
            f"--seconds {seconds:g} is too short at {rate:g} Hz; a recording holds "
            f"{_LEAST_SAMPLES} samples or more"
        )
    library = effect_library(options.effects)
    rig = _rig(options, library, rig)
    low, high = (1e3 * limit for limit in rig.interference_range)
    interference_mm = _or(options.interference, min(max(_FIT.default, low), high))
    shaft, turning = shaft_motion(options, seconds)
    arguments: dict[str, Any] = {
        "rig": rig,
        "shaft": shaft,
        "interference": interference_mm / 1e3,
        "support_stiffness": _or(options.support_stiffness, _SUPPORT.default),
        "temperature": _or(options.temperature, _TEMPERATURE.default),
        "seconds": seconds,
        "library": library,
    }
    notes = _remarks(options, arguments)
    where = Condition(None, interference_mm / 1e3, arguments["support_stiffness"], rig.material)
    say(f"simulating {seconds:g} s: {', '.join([turning, *where.words])}")
    import numpy as np

    from sim.acquisition import Acquisition

    arguments["acquisition"] = Acquisition(rate=rate)
    arguments["rng"] = np.random.default_rng(options.seed)
    return arguments, notes


def with_notes(
    run: Run, notes: tuple[str, ...], arguments: Mapping[str, Any], name: str = ""
) -> Recording:
    """Return the recording of a run with all notes, including those on clipping and slip.

    Parameters
    ----------
    run : Run
    notes : tuple of str
        Notes of `run_arguments`.
    arguments : mapping
        Arguments of the simulation.
    name : str
        Name of the run, if there are several.
    """
    from sim.analysis.regime import never_slips

    rig: Rig = arguments["rig"]
    sensors = arguments["acquisition"].over(rig.sensors).sensors
    late_notes = clipping_remarks(run.recording, sensors)
    if never_slips(run.motion):
        late_notes.append(NEVER_SLIPS)
    for text in late_notes:
        note(f"{name}: {text}" if name else text)
    return replace(run.recording, notes=(*notes, *late_notes))


def _remarks(options: Namespace, arguments: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the notes on a rig and a condition."""
    rig, top = arguments["rig"], arguments["shaft"].top_speed(arguments["seconds"])
    low, high = (1e3 * limit for limit in rig.interference_range)
    interference_mm = 1e3 * arguments["interference"]
    remarks: list[str | None] = []
    if options.speed is not None and top > _FAST:
        remarks.append(
            f"--speed is in rad/s: {top:.3g} rad/s are {top * 30.0 / math.pi:.4g} rpm; if you mean "
            f"{top:.3g} rpm, give --speed {top * math.pi / 30.0:.3g}"
        )
    if not low * (1.0 - 1e-9) <= interference_mm <= high * (1.0 + 1e-9):
        nearest = low if interference_mm < low else high
        remarks.append(
            f"--interference {interference_mm:g} mm lies outside the fits given for "
            f"{rig.material} ({low:g} to {high:g} mm); those of {nearest:g} mm are used "
            f"(contact pressure by Lame, which is linear, would be "
            f"{interference_mm / nearest:.3g} times theirs)"
        )
    remarks += use_remarks(
        rig,
        speed=[top],
        **{
            name: [arguments[name]] for name in ("interference", "support_stiffness", "temperature")
        },
    )
    remarks += effect_remarks(rig, arguments["library"])
    remarks.append(temperature_remark(rig, options.temperature))
    if rig.sensors.noise_from_recordings:
        remarks.append(
            'noise = "from recordings" needs recordings to compare with; here the noise of good '
            "sensors is used"
        )
    return tuple(text for text in remarks if text)


_FAST = 30.0
"""Speed above which the user may mean rpm [rad/s]."""

_LEAST_SAMPLES = 16
"""Smallest number of samples of a recording: `noise.recordings.files.MIN_SAMPLES`."""


def _or(value: _T | None, default: _T) -> _T:
    """Return a value, or the default for None."""
    return default if value is None else value


def _rig(options: Namespace, library: Mapping[str, Effect], rig: Rig | None) -> Rig:
    """Return the rig of the options with their effects and changes."""
    from models.rig_file import load_material_rig, load_rig
    from sim.effects.effect import activated

    if options.rig is None:
        with naming("--material: "):
            rig = load_material_rig(_or(options.material, DEFAULT_MATERIAL))
    else:
        with naming("--rig: "):
            rig = rig or load_rig(options.rig)
        material = options.material
        if material is not None and material.strip().lower() != rig.material.lower():
            raise ParameterError(
                f"--material {material} contradicts --rig {options.rig}, whose material is "
                f"{rig.material}; leave --material out, or change the file"
            )
    effects = {spec.name: spec for spec in rig.effects}
    stated: dict[str, LawSpec] = {}
    for spec in options.effect or ():
        if spec.name in stated:
            raise ParameterError(f"--effect {spec.name} is given twice; give all its keys at once")
        with naming("--effect: "):
            activated((spec,), library)
        stated[spec.name] = spec
    return changed(replace(rig, effects=tuple((effects | stated).values())), options.change)


def shaft_motion(options: Namespace, seconds: float) -> tuple[ShaftMotion, str]:
    """Return the motion of the shaft and its description.

    Parameters
    ----------
    options : argparse.Namespace
        Options ``speed`` and ``oscillate``, one of which is set.
    seconds : float
        Length of the run [s].
    """
    from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

    if options.oscillate is not None:
        degrees, frequency = options.oscillate
        words = f"swinging +-{degrees:g} degrees at {frequency:g} Hz"
        return Oscillation(math.radians(degrees), frequency), words
    if isinstance(options.speed, tuple):
        start, end = options.speed
        return SpeedRamp(start, end, seconds), f"{start:g} to {end:g} rad/s"
    if isinstance(options.speed, Path):
        return _logged_speed(options.speed, seconds), f"speed as logged in {options.speed.name}"
    return ConstantSpeed(options.speed), f"{options.speed:g} rad/s"


def _logged_speed(path: Path, seconds: float) -> LoggedSpeed:
    """Read a log of the speed."""
    from models.foreign_file import read_table
    from sim.shaft import LoggedSpeed

    where = f"--speed {path}"
    with reading(path, "CSV table", where=where, largest=LARGEST_TEXT):
        table = read_table(path)
    with naming(f"{where}: "):
        time, speed = _log_columns(table)
        logged = LoggedSpeed(time, speed)
    if time[0] > 0.0 or time[-1] < seconds:
        note(
            f"--speed {path} covers {time[0]:g} to {time[-1]:g} s, the run 0 to {seconds:g} s; "
            "outside of the log its nearest speed is held"
        )
    elif time[-1] > seconds:
        note(f"--speed {path} lasts {time[-1]:g} s, the run takes its first {seconds:g} s")
    return logged


def _log_columns(table: ForeignTable) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return time [s] and speed [rad/s]: by their headings, or the first two columns."""
    from models.units import quantity_of_unit

    if not any(table.names):
        return table.values[:, 0], table.values[:, 1]
    columns: dict[str, NDArray[np.float64]] = {}
    for name, unit, column in zip(table.names, table.units, table.values.T, strict=True):
        quantity, factor = quantity_of_unit(unit) or (name.lower(), 1.0)
        columns.setdefault("speed" if quantity == "speed_rad_s" else quantity, factor * column)
    if not {"time", "speed"} <= set(columns):
        raise ParameterError(
            f"has the columns {', '.join(table.names)}, expected time_s and speed_rad_s"
        )
    return columns["time"], columns["speed"]
