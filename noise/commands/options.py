"""Declarations of command-line options, parsers of their values, and shared options.

A command declares its options as rows, from which `add_options` makes a parser; their help texts
are in ``help.toml``. Invalid values are refused with a message that names the option.
"""

from __future__ import annotations

import argparse
import math
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError, naming
from models.schema import Quantity
from noise.base import packaged_toml
from noise.base.files import check_target
from noise.base.progress import note, say

if TYPE_CHECKING:
    from models.rig import Rig


def number_or_none(text: str) -> float | None:
    """Parse a number [any unit], which may be infinite; return None for other text.

    Examples
    --------
    >>> number_or_none("0.279"), number_or_none("fast")
    (0.279, None)
    """
    try:
        return float(text)
    except ValueError:
        return None


def number(
    above: float = -math.inf, *, least: float = -math.inf, most: float = math.inf
) -> Callable[[str], float]:
    """Return a parser of finite numbers in a range.

    Parameters
    ----------
    above, least, most : float
        Exclusive lower, inclusive lower and inclusive upper bound [unit of the option].

    Returns
    -------
    callable
        Function of the text of an option; it raises ArgumentTypeError for other text.

    Examples
    --------
    >>> number(above=0.0)("0.279")
    0.279
    """
    bounds = Quantity("", low=max(above, least), high=most, closed=math.isinf(above))

    def parse(text: str) -> float:
        value = number_or_none(text)
        if value is None or not bounds.possible(value):
            raise ArgumentTypeError(f"is {text!r}, expected {bounds.wanted}")
        return value

    return parse


MOST_WORKERS = 1024
"""Largest number of processes or threads of a command; systems refuse to start many more."""


def whole_number(least: int, *, most: int = 10**18) -> Callable[[str], int]:
    """Return a parser of whole numbers in a range.

    Examples
    --------
    >>> whole_number(1)("2")
    2
    """
    span = f"from {least} to {most}" if most < 10**18 else f"of {least} or more"

    def parse(text: str) -> int:
        value = number_or_none(text)
        if value is None or not least <= value <= most or not text.strip().isdecimal():
            raise ArgumentTypeError(f"is {text!r}, expected a whole number {span}")
        return int(text)

    return parse


def one_of(*values: str | int) -> Callable[[str], str | int]:
    """Return a parser of one of several values, regardless of case.

    Examples
    --------
    >>> one_of("H1", "H2", "Hv")("hv")
    'Hv'
    """
    known = {str(value).lower(): value for value in values}

    def parse(text: str) -> str | int:
        value = known.get(text.strip().lower())
        if value is None:
            *others, last = map(str, values)
            raise ArgumentTypeError(f"is {text!r}, expected {', '.join(others)} or {last}")
        return value

    return parse


def band(text: str) -> tuple[float, float]:
    """Parse a frequency band [Hz].

    Examples
    --------
    >>> band("200..2000")
    (200.0, 2000.0)
    """
    low, dots, high = text.partition("..")
    first, last = number_or_none(low), number_or_none(high)
    if not dots or first is None or last is None or not 0.0 <= first < last < math.inf:
        raise ArgumentTypeError(f"is {text!r}, expected LOW..HIGH in Hz, such as 100..5000")
    return first, last


def path(text: str) -> Path:
    """Parse a path that is not empty."""
    if not text:
        raise ArgumentTypeError("is '', expected a path ('.' is the current folder)")
    return Path(text)


def change(text: str) -> tuple[str, str | float]:
    """Parse a change of the rig: a name, and a number in the unit of its key or a text."""
    name, equals, amount = (part.strip() for part in text.partition("="))
    if not (name and equals and amount):
        raise ArgumentTypeError(f"is {text!r}, expected NAME=AMOUNT, such as damping=x2")
    number = number_or_none(amount)
    return name, amount if number is None else number


@dataclass(frozen=True)
class Option:
    """Declaration of an option.

    Parameters
    ----------
    name : str
        Name and metavariable: ``--gap S`` takes a value, ``--ab`` is a switch, ``paths PATH`` is
        positional.
    kind : callable
        Parser of the value; it raises ArgumentTypeError for invalid text.
    default : object
    count : str, optional
        Number of values: ``*``, ``+`` or ``?``.
    repeated : bool
        Whether the option may be repeated, which gives a list.
    required : bool

    Examples
    --------
    >>> Option("--support-stiffness K", number(above=0.0)).attribute
    'support_stiffness'
    """

    name: str
    kind: Callable[[str], Any] = str
    default: object = None
    count: str | None = None
    repeated: bool = False
    required: bool = False

    @property
    def attribute(self) -> str:
        """Name of the attribute in the parsed options."""
        return self.name.partition(" ")[0].removeprefix("--").replace("-", "_")


@dataclass(frozen=True)
class Group:
    """Options under their own title."""

    title: str
    text: str
    rows: Sequence[Option]


Row = Option | Group | tuple[Option, ...]
"""Option, options under a title, or options that exclude each other."""


def help_of(command: str) -> tuple[str, str, Mapping[str, str]]:
    """Read the help texts of a command: description, examples, and options by name.

    Examples
    --------
    >>> help_of("render")[2]["--gap"]
    'silence between two inputs in s'
    """
    texts = packaged_toml("noise.commands", "help.toml")
    own = texts[command]
    options = texts["shared"]["options"] | own.get("options", {})
    return own["description"], own.get("epilog", ""), options


def add_options(
    parser: argparse._ActionsContainer, rows: Iterable[Row], texts: Mapping[str, str] | None = None
) -> None:
    """Add options to a parser.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser, or a group of one.
    rows : iterable of `Row`
    texts : mapping of str to str, optional
        Help texts by the name of the option.

    Examples
    --------
    >>> parser = argparse.ArgumentParser()
    >>> add_options(parser, [Option("--gap S", number(least=0.0), 0.5)])
    >>> parser.parse_args(["--gap", "2"]).gap
    2.0
    """
    for row in rows:
        if isinstance(row, Group):
            add_options(parser.add_argument_group(row.title, row.text), row.rows, texts)
        elif isinstance(row, tuple):
            add_options(parser.add_mutually_exclusive_group(), row, texts)
        else:
            _add(parser, row, texts or {})


def option_names(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the names of options.

    Examples
    --------
    >>> list(option_names([Option("--gap S"), (Option("--ab"), Option("--set"))]))
    ['--gap', '--ab', '--set']
    """
    for row in rows:
        if isinstance(row, Option):
            yield row.name.partition(" ")[0]
        else:
            yield from option_names(row.rows if isinstance(row, Group) else row)


def _add(parser: argparse._ActionsContainer, row: Option, texts: Mapping[str, str]) -> None:
    """Add one option to a parser."""
    name, _, metavar = row.name.partition(" ")
    text = texts.get(name, "").replace("%", "%%") + " (required)" * row.required
    if not metavar:
        parser.add_argument(name, action="store_true", default=row.default or False, help=text)
        return
    if row.default is not None and "default: " not in text:
        shown = f"{row.default:g}" if isinstance(row.default, float) else row.default
        text += f" (default: {shown})"
    more: dict[str, Any] = {"required": True} if row.required else {}
    parser.add_argument(
        name,
        metavar=metavar,
        type=path if row.kind is Path else row.kind,
        default=row.default,
        nargs=row.count,
        action="append" if row.repeated else "store",
        help=text,
        **more,
    )


COMMON = (Option("--seed N", whole_number(0), 0), (Option("--quiet"), Option("--verbose")))
"""Options of all commands."""

CHANGE = Option("--change NAME=AMOUNT", change, repeated=True)
"""``--change`` of all commands that take a rig."""

CALIBRATION = (
    (Option("--full-scale PA", number(above=0.0)), Option("--calibrator TONE", Path)),
    Option("--level DB", number(least=40.0, most=170.0)),
)
"""Calibration of plain sound files; see `full_scale_of`."""


def full_scale_of(options: argparse.Namespace) -> float | None:
    """Return the pressure of a full-scale sample [Pa] from the options of `CALIBRATION`.

    Raises
    ------
    BushingNoiseError
        The recording of the calibrator cannot be used, or ``--level`` or ``--calibrator`` is
        missing.
    """
    stated: float | None = options.full_scale
    if stated is not None and _LEAST_LEVEL <= stated <= _MOST_LEVEL:
        pascal = 20e-6 * math.sqrt(2.0) * 10.0 ** (stated / 20.0)
        note(
            f"--full-scale {stated:g} is in Pa, an extremely loud sound; if you mean {stated:g} dB "
            f"of a sine at full scale, give --full-scale {pascal:.4g}"
        )
    if (options.calibrator is None) != (options.level is None):
        raise ParameterError(
            "--calibrator needs --level, the level that it gives in dB, and --level a --calibrator"
        )
    if options.calibrator is None:
        return stated
    from noise.recordings.calibrator import read_calibrator

    with naming("--calibrator ", ParameterError):
        tone = read_calibrator(options.calibrator, options.level)
    say(
        f"{options.calibrator.name}: {options.level:g} dB at {tone.frequency:.4g} Hz make full "
        f"scale {tone.full_scale:.4g} Pa"
    )
    return tone.full_scale


_LEAST_LEVEL, _MOST_LEVEL = 60.0, 170.0
"""Range of values that are probably levels in place of pascals [dB]."""


def changed(rig: Rig, changes: Sequence[tuple[str, str | float]] | None) -> Rig:
    """Return the rig with the changes of ``--change``.

    Raises
    ------
    ParameterError
        A change cannot be used, or is given twice.
    """
    if not changes:
        return rig
    from models.change import changed_rig

    return changed_rig(rig, change_table(changes), "--change")


def change_table(changes: Sequence[tuple[str, str | float]]) -> dict[str, str | float]:
    """Return the changes of ``--change`` as a table like ``[change]`` in a rig file.

    Raises
    ------
    ParameterError
        A change is given twice.
    """
    table = dict(changes)
    if len(table) < len(changes):
        raise ParameterError("--change: one name is given twice; give one change")
    return table


def check_folder(folder: Path | None, option: str = "--out", *, file: str = "") -> None:
    """Refuse an output folder that cannot be made, or in which `file` cannot be written.

    Without a folder there is nothing to check.

    Raises
    ------
    ParameterError
        The folder is a file or a broken link, or is not writable.
    """
    if folder is None:
        return
    if folder.exists() and not folder.is_dir():
        raise ParameterError(f"{option} {folder}: is a file; name a folder")
    if folder.is_symlink() and not folder.exists():
        raise ParameterError(f"{option} {folder}: links to nothing; name a folder")
    check_target(folder / file, option)


def refuse(error: object, name: str | Path = "") -> None:
    """Print the refusal of an input; `name` is added to messages without it."""
    named = f"{name}: " if Path(name).name not in str(error) else ""
    say(f"bushing-noise: refused: {named}{error}", error=True)
