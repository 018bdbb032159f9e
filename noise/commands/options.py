"""Options: the rows of a command's table, the values that they take, and those that many share.

A command states its options as rows, `add_options` makes a parser of them; what the help says of
each is in ``help.toml``. A text that cannot be used is refused while the call is read, by a message
that names the option.
"""

from __future__ import annotations

import argparse
import math
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from models.errors import ParameterError, naming
from models.schema import Quantity
from noise.base import packaged_toml
from noise.base.files import check_target
from noise.base.progress import note, say

if TYPE_CHECKING:
    from models.rig import Rig
    from noise.recordings.meaning import PascalPerFullScale


def number_or_none(text: str) -> float | None:
    """Read a number, which may be infinite [-]; None where the text is none.

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
    """Return a parser of finite numbers larger than `above`, from `least` up to `most`.

    Parameters
    ----------
    above, least, most : float
        In the unit of the option, such as [mm].

    Returns
    -------
    callable
        Of the text of an option; raises ArgumentTypeError where it is no such number.

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


_LONGEST_NUMBER = 18  # digits

MOST_WORKERS = 1024
"""Processes or threads that a command starts at most: beyond it systems refuse to start more."""


def whole_number(least: int, *, most: int | None = None, more: str = "") -> Callable[[str], int]:
    """Return a parser of whole numbers from `least` on; `more` ends what it says it expected.

    Examples
    --------
    >>> whole_number(1)("2")
    2
    """

    def parse(text: str) -> int:
        plain = text.strip()
        decimal = plain.isdecimal() and len(plain) <= _LONGEST_NUMBER
        if not decimal or int(plain) < least or (most is not None and int(plain) > most):
            span = f"of {least} or more" if most is None else f"from {least} to {most}"
            raise ArgumentTypeError(f"is {text!r}, expected a whole number {span}{more}")
        return int(plain)

    return parse


def one_of(*values: str | int) -> Callable[[str], str | int]:
    """Return a parser of one of several values, of words in either case.

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
    """Read a band of frequencies [Hz].

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
    """Read a path, which is not empty."""
    if not text:
        raise ArgumentTypeError("is '', expected a path ('.' is the current folder)")
    return Path(text)


def change(text: str) -> tuple[str, str | float]:
    """Read a change of the rig: a name, and a number in the unit of its key or a text."""
    name, equals, amount = (part.strip() for part in text.partition("="))
    if not (name and equals and amount):
        raise ArgumentTypeError(f"is {text!r}, expected NAME=AMOUNT, such as damping=x2")
    number = number_or_none(amount)
    return name, amount if number is None else number


@dataclass(frozen=True)
class Option:
    """One row of a table of options.

    Parameters
    ----------
    name : str
        As the help shows it: ``--gap S`` takes a value, ``--ab`` is a switch, ``paths PATH`` is
        given by its place.
    kind : callable
        From the text of the value to the value; raises ArgumentTypeError where it cannot be used.
    default : object
        Of an option that is not given.
    count : str, optional
        How many values it takes: ``*``, ``+`` or ``?``.
    repeated : bool
        Whether it may be given several times, which makes a list.
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
        """Its name in what the parser returns."""
        return self.name.partition(" ")[0].removeprefix("--").replace("-", "_")


class OneOf(tuple[Option, ...]):
    """Rows of which a call may have one."""

    __slots__ = ()

    def __new__(cls, *rows: Option) -> OneOf:
        """Take the rows."""
        return super().__new__(cls, rows)


class Group(NamedTuple):
    """Rows under a title of their own."""

    title: str
    text: str
    rows: Sequence[Option]


Row = Option | OneOf | Group


class Help(NamedTuple):
    """What the help of a command says: what it does, examples, and each option by its name."""

    description: str
    epilog: str
    options: Mapping[str, str]


def help_of(command: str) -> Help:
    """Read what the help of a command says.

    Examples
    --------
    >>> help_of("render").options["--gap"]
    'silence between two of them in s'
    """
    texts = packaged_toml("noise.commands", "help.toml")
    own = texts[command]
    return Help(
        _filled(own["description"]),
        _filled(own.get("epilog", "")),
        {
            name: _filled(line)
            for name, line in (texts["shared"]["options"] | own.get("options", {})).items()
        },
    )


def _filled(text: str) -> str:
    """Return a text with the lists that it names in braces."""
    for place, (module, name) in _LISTS.items():
        if place in text:
            found = getattr(import_module(module), name)
            text = text.replace(place, ", ".join(found() if callable(found) else found))
    return text


_LISTS = {
    "{environments}": ("noise.screening.environments", "environment_names"),
    "{effects}": ("sim.effects", "EFFECTS"),
    "{materials}": ("models.rig_file", "material_names"),
}


def add_options(
    parser: argparse._ActionsContainer, rows: Iterable[Row], texts: Mapping[str, str] | None = None
) -> None:
    """Add the rows of a table to a parser.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Or a group of one.
    rows : iterable of Option, OneOf or Group
    texts : mapping of str to str, optional
        For the help, by the name of the option.

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
        elif isinstance(row, OneOf):
            add_options(parser.add_mutually_exclusive_group(), row, texts)
        else:
            _add(parser, row, texts or {})


def option_names(rows: Iterable[Row]) -> Iterator[str]:
    """Names of the rows of a table, as they are given in a call.

    Examples
    --------
    >>> list(option_names([Option("--gap S"), OneOf(Option("--ab"), Option("--set"))]))
    ['--gap', '--ab', '--set']
    """
    for row in rows:
        if isinstance(row, Option):
            yield row.name.partition(" ")[0]
        else:
            yield from option_names(row.rows if isinstance(row, Group) else row)


def _add(parser: argparse._ActionsContainer, row: Option, texts: Mapping[str, str]) -> None:
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


SEED = Option("--seed N", whole_number(0), 0)
"""``--seed``, which all commands take."""

COMMON = (
    OneOf(
        Option("--quiet"),
        Option("--verbose"),
    ),
)
"""Options of all commands."""

CHANGE = Option("--change NAME=AMOUNT", change, repeated=True)
"""``--change``, of every command that takes a rig."""

CALIBRATION = (
    OneOf(
        Option("--full-scale PA", number(above=0.0)),
        Option("--calibrator TONE", Path),
    ),
    Option("--level DB", number(least=40.0, most=170.0)),
)
"""Calibration of plain sound files, of which `full_scale_of` makes a number."""


def full_scale_of(options: argparse.Namespace) -> PascalPerFullScale | None:
    """Return what the options of `CALIBRATION` make a full-scale sample worth [Pa].

    Raises
    ------
    BushingNoiseError
        The calibrator's recording cannot be used, or one option is given without the other.
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
        tones = read_calibrator(options.calibrator, options.level)
    for tone in tones:
        say(
            f"{options.calibrator.name}: {options.level:g} dB at {tone.frequency:.4g} Hz make full "
            f"scale {tone.full_scale:.4g} Pa"
        )
    values = tuple(tone.full_scale for tone in tones)
    return values[0] if len(values) == 1 else values


_LEAST_LEVEL, _MOST_LEVEL = 60.0, 170.0
"""Of sound levels that are taken for pascals by mistake [dB]."""


def changed(rig: Rig, changes: Sequence[tuple[str, str | float]] | None) -> Rig:
    """Return the rig with what ``--change`` says.

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
    """Return what ``--change`` says as the table of ``[change]``.

    Raises
    ------
    ParameterError
        A change is given twice.
    """
    table = dict(changes)
    if len(table) < len(changes):
        raise ParameterError("--change: one name is given twice; give one change")
    return table


def check_folder(folder: Path, option: str = "--out", *, file: str = "") -> None:
    """Refuse a folder of results that cannot be made, or `file` not in it, before the work.

    Raises
    ------
    ParameterError
        It is a file or a link to nothing, or cannot be written to.
    """
    if folder.exists() and not folder.is_dir():
        raise ParameterError(f"{option} {folder}: is a file; name a folder")
    if folder.is_symlink() and not folder.exists():
        raise ParameterError(f"{option} {folder}: links to nothing; name a folder")
    check_target(folder / file, option)


def refuse(error: object, name: str | Path = "") -> None:
    """Say that an input is refused, and why; `name` stands before what does not name it."""
    named = f"{name}: " if Path(name).name not in str(error) else ""
    say(f"bushing-noise: refused: {named}{error}", error=True)
