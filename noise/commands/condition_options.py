"""Options of an operating condition, and the texts that they take.

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
from models.errors import ParameterError
from noise.commands.options import add_change, number, number_or_none

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from models.rig import LawSpec

__all__ = [
    "CONDITION_OPTIONS", "DEFAULT_INTERFERENCE_MM", "DEFAULT_MATERIAL", "DEFAULT_SECONDS",
    "DEFAULT_SUPPORT_STIFFNESS", "DEFAULT_TEMPERATURE", "Ramp", "Swing", "add_condition",
    "given_options",
]  # fmt: skip

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


CONDITION_OPTIONS = (
    "speed",
    "oscillate",
    "interference",
    "support_stiffness",
    "material",
    "temperature",
    "seconds",
    "effect",
    "effects",
    "rig",
    "change",
    "converter",
)
"""What `add_condition` adds, as attributes of the options."""


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
        help=f"interference fit in mm (default: {DEFAULT_INTERFERENCE_MM:g}, or the nearest that "
        "--rig gives)",
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
        help="ambient temperature in degree Celsius; friction, stiffness and damping follow "
        "it where the material's file says how, under [temperature]; else it is only recorded "
        f"(default: {DEFAULT_TEMPERATURE:g})",
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
        help="pass the samples through the thesis's 12-bit converter, which hides quiet sounds and "
        "clips loud ones (default: the range and bits that [sensors] of the rig file states)",
    )


def given_options(options: Namespace) -> list[str]:
    """Return the options of a condition that were given, as they are typed."""
    return [
        "--" + name.replace("_", "-")
        for name in CONDITION_OPTIONS
        if getattr(options, name) is not None
    ]


def _speed(text: str) -> float | Ramp | Path:
    start, dots, end = text.partition("..")
    if dots and number_or_none(start) is not None and number_or_none(end) is not None:
        return Ramp(number()(start), number()(end))
    if number_or_none(text) is not None:
        return number()(text)
    if not Path(text).is_file():
        raise ArgumentTypeError(
            f"is {text!r}, expected a number in rad/s, a ramp such as 0..10, or a CSV file that "
            "exists"
        )
    return Path(text)


def _swing(text: str) -> Swing:
    parts = [number_or_none(part) for part in text.split(",")]
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
    from models.rig_files.rig_parts import parse_spec

    try:
        return parse_spec(text)
    except ParameterError:
        raise ArgumentTypeError(f"is {text!r}, expected NAME or NAME:key=value,key=value") from None


def _materials() -> tuple[str, ...]:
    from models.rig_files.shipped import material_names

    return material_names()
