"""Options that several commands share, and the texts that they take.

A text that cannot be used is refused while the call is read, by a message that names the option.
An option that is not given is None: whether it was given matters where two sources of the same
value meet, such as ``--rig`` and ``--material``.
"""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from models.condition import FIXED

if TYPE_CHECKING:
    from argparse import ArgumentParser, _ArgumentGroup
    from collections.abc import Callable, Sequence

    from models.rig import LawSpec, Rig

__all__ = [
    "DEFAULT_INTERFERENCE_MM",
    "DEFAULT_MATERIAL",
    "DEFAULT_SECONDS",
    "DEFAULT_SUPPORT_STIFFNESS",
    "DEFAULT_TEMPERATURE",
    "Ramp",
    "Swing",
    "add_change",
    "add_condition",
    "add_full_scale",
    "add_seed",
    "changed",
    "number",
]

DEFAULT_INTERFERENCE_MM = 0.279
DEFAULT_SUPPORT_STIFFNESS = 2214.0  # Nm/rad
DEFAULT_MATERIAL = "fluorocarbon"
DEFAULT_TEMPERATURE = 23.0  # degree Celsius
DEFAULT_SECONDS = 1.0

_ABSOLUTE_ZERO = -273.15  # degree Celsius


@dataclass(frozen=True)
class Ramp:
    """``--speed 0..10``: from one speed to another [rad/s] over the run."""

    start: float
    end: float


@dataclass(frozen=True)
class Swing:
    """``--oscillate 15,2``: amplitude [degree] and frequency [Hz]."""

    amplitude: float
    frequency: float


def number(
    above: float = -math.inf, *, least: float = -math.inf, most: float = math.inf
) -> Callable[[str], float]:
    """Return a parser of finite numbers larger than `above`, from `least` up to `most`.

    Examples
    --------
    >>> number(above=0.0)("0.279")
    0.279
    """

    def parse(text: str) -> float:
        value = _finite(text)
        if not (value > above and least <= value <= most):
            limits = [f"above {above:g}"] * math.isfinite(above)
            limits += [f"at least {least:g}"] * math.isfinite(least)
            limits += [f"at most {most:g}"] * math.isfinite(most)
            raise ArgumentTypeError(f"is {text!r}, expected a number {' and '.join(limits)}")
        return value

    return parse


def add_seed(parser: ArgumentParser, use: str) -> None:
    """Add ``--seed``, which all commands take; `use` says what it is for."""
    parser.add_argument(
        "--seed",
        type=_whole_number,
        default=0,
        metavar="N",
        help=f"{use} (a whole number; default: 0)",
    )


def add_full_scale(parser: ArgumentParser) -> None:
    """Add the calibration of plain sound files."""
    parser.add_argument(
        "--full-scale",
        type=number(above=0.0),
        metavar="PA",
        help="sound pressure in Pa that a full-scale sample of the input stands for; wins over "
        "what sidecar and file say (default: what they say, else levels in dBFS only)",
    )


def add_condition(parser: ArgumentParser) -> None:
    """Add the options that describe an operating condition of the rig."""
    group = parser.add_argument_group(
        "operating condition", "Exactly one of --speed and --oscillate is needed."
    )
    group.add_argument(
        "--speed",
        type=_speed,
        metavar="V",
        help="speed of the shaft in rad/s, of either sign; A..B is a ramp from A to B over the "
        "run; the name of a CSV file is a log with the columns time_s, speed_rad_s",
    )
    group.add_argument(
        "--oscillate",
        type=_swing,
        metavar="DEG,HZ",
        help="the shaft swings by +-DEG degrees, HZ times a second, instead of turning",
    )
    group.add_argument(
        "--interference",
        type=number(above=0.0, most=10.0),
        metavar="MM",
        help=f"interference fit in mm (default: {DEFAULT_INTERFERENCE_MM:g})",
    )
    group.add_argument(
        "--support-stiffness",
        type=_support_stiffness,
        metavar="K",
        help="torsional stiffness of the beams in Nm/rad, or fixed for the clamp bolted to the "
        f"baseplate (default: {DEFAULT_SUPPORT_STIFFNESS:g})",
    )
    group.add_argument(
        "--material",
        metavar="NAME",
        help=f"elastomer, one of {', '.join(_materials())}; case does not matter "
        f"(default: that of --rig, else {DEFAULT_MATERIAL})",
    )
    group.add_argument(
        "--temperature",
        type=number(least=_ABSOLUTE_ZERO),
        metavar="C",
        help="ambient temperature in degree Celsius; recorded, but the shipped materials do not "
        f"depend on it (default: {DEFAULT_TEMPERATURE:g})",
    )
    group.add_argument(
        "--seconds",
        type=number(above=0.0, most=20000.0),
        metavar="S",
        help=f"length of the recording in s (default: {DEFAULT_SECONDS:g})",
    )
    group.add_argument(
        "--effect",
        type=_effect,
        action="append",
        metavar="NAME[:KEY=VALUE,...]",
        help="what the model includes beyond its friction law, such as slip_pulse:amplitude=20 "
        "(in N); replaces the rig's effect of the same name; may be given several times "
        "(default: the effects of rig and material)",
    )
    group.add_argument(
        "--effects",
        type=Path,
        metavar="FILE.py",
        help="Python file that defines effects of your own, for --effect and the rig file to "
        "name; the file is run",
    )
    group.add_argument(
        "--rig",
        type=Path,
        metavar="RIG.toml",
        help="rig file to use instead of the rig that is shipped",
    )
    add_change(group)
    group.add_argument(
        "--converter",
        action="store_true",
        default=None,
        help="pass the samples through the rig's 12-bit converter, which hides quiet sounds and "
        "clips loud ones (default: no)",
    )


def add_change(parser: ArgumentParser | _ArgumentGroup) -> None:
    """Add ``--change``, for every command that takes a rig."""
    parser.add_argument(
        "--change",
        type=_change,
        action="append",
        metavar="NAME=AMOUNT",
        help="change the rig as [change] in its file does: damping=x2, critical_torque=-20%%, "
        "damping_Nms_rad=0.09, ageing_time=x2 or slip_pulse.amplitude=x0.5; may be given several "
        "times (default: none)",
    )


def changed(rig: Rig, changes: Sequence[tuple[str, str | float]] | None) -> Rig:
    """Return the rig with what ``--change`` says.

    Raises
    ------
    ParameterError
        A change cannot be used, or is given twice.
    """
    if not changes:
        return rig
    from models.errors import ParameterError
    from models.rig_files.change import changed_rig

    table = dict(changes)
    if len(table) < len(changes):
        raise ParameterError("--change: one name is given twice; give one change")
    return changed_rig(rig, table, "--change")


def _change(text: str) -> tuple[str, str | float]:
    name, equals, amount = (part.strip() for part in text.partition("="))
    if not (name and equals and amount):
        raise ArgumentTypeError(f"is {text!r}, expected NAME=AMOUNT, such as damping=x2")
    number = _number_or_none(amount)
    return name, amount if number is None else number


def _finite(text: str) -> float:
    value = _number_or_none(text)
    if value is None or not math.isfinite(value):
        raise ArgumentTypeError(f"is {text!r}, expected a number")
    return value


def _number_or_none(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _whole_number(text: str) -> int:
    if not text.strip().isdecimal():
        raise ArgumentTypeError(f"is {text!r}, expected a whole number of 0 or more")
    return int(text)


def _speed(text: str) -> float | Ramp | Path:
    start, dots, end = text.partition("..")
    if dots and _number_or_none(start) is not None and _number_or_none(end) is not None:
        return Ramp(_finite(start), _finite(end))
    if _number_or_none(text) is not None:
        return _finite(text)
    if not Path(text).is_file():
        raise ArgumentTypeError(
            f"is {text!r}, expected a number in rad/s, a ramp such as 0..10, or a CSV file that "
            "exists"
        )
    return Path(text)


def _swing(text: str) -> Swing:
    parts = [_number_or_none(part) for part in text.split(",")]
    if len(parts) == 2:
        amplitude, frequency = parts
        if amplitude is not None and frequency is not None:
            finite = math.isfinite(amplitude) and math.isfinite(frequency)
            if finite and amplitude > 0.0 and frequency > 0.0:
                return Swing(amplitude, frequency)
    raise ArgumentTypeError(f"is {text!r}, expected degrees and Hz, both above 0, such as 15,2")


def _support_stiffness(text: str) -> float:
    if text.strip().lower() == "fixed":
        return FIXED
    try:
        return number(above=0.0)(text)
    except ArgumentTypeError:
        raise ArgumentTypeError(
            f"is {text!r}, expected a number above 0 in Nm/rad, or fixed"
        ) from None


def _effect(text: str) -> LawSpec:
    from models.errors import ParameterError
    from models.rig_files.rig_file import parse_spec

    try:
        return parse_spec(text)
    except ParameterError:
        raise ArgumentTypeError(f"is {text!r}, expected NAME or NAME:key=value,key=value") from None


def _materials() -> tuple[str, ...]:
    from models.rig_files.rig_file import material_names

    return material_names()
