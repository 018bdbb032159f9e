"""Declared entries of rig files: key, unit, bounds and usual range of each.

A dataclass declares the file's entry of a field: ``Annotated[float, Quantity("wall_mm", 1e-3)]``.
Reading, error messages with key, value and the expected value, remarks on unusual values, and
writing follow from the declarations. Fields without a declaration are in no file.
"""

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import lru_cache, partial
from reprlib import repr as show
from typing import Any, TypeVar

from models.errors import ParameterError

_Kind = TypeVar("_Kind")


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """Return a question for the nearest name, empty if none is near.

    Examples
    --------
    >>> did_you_mean("desing", ["design", "fit"]), did_you_mean("x", ["design"])
    ("; did you mean 'design'?", '')
    """
    near = get_close_matches(name, list(names), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def refuse_unknown(table: Mapping[str, Any], names: Iterable[str], where: str) -> None:
    """Raise if a table has an unknown key, most often a misspelt one.

    Raises
    ------
    ParameterError
        A key is not among `names`.

    Examples
    --------
    >>> refuse_unknown({"speed": 1.0}, {"speed"}, "rig.toml")
    """
    for key in table:
        if key not in (known := sorted(names)):
            raise ParameterError(
                f"{where}: unknown key {key!r}{did_you_mean(key, known)}; known are "
                f"{', '.join(known)}"
            )


def as_table(value: Any, key: str, where: str) -> Mapping[str, Any]:
    """Return `value` if it is a table.

    Raises
    ------
    ParameterError
        It is not; the message names file and key.

    Examples
    --------
    >>> as_table({"speed": 1.0}, "shaft", "rig.toml")
    {'speed': 1.0}
    """
    if not isinstance(value, Mapping):
        raise ParameterError(f"{where}: {key} must be a table")
    return value


def as_text(value: Any, key: str, where: str) -> str:
    """Return `value` if it is a text.

    Raises
    ------
    ParameterError
        It is not; the message names file and key.

    Examples
    --------
    >>> as_text("PDMS", "material", "rig.toml")
    'PDMS'
    """
    if not isinstance(value, str):
        raise ParameterError(f"{where}: {key} = {show(value)} must be a text in quotes")
    return value


@dataclass(frozen=True)
class Entry:
    """Entry of a file.

    Parameters
    ----------
    key : str
        Key of the entry in files.
    """

    key: str

    def read(self, value: Any, where: str, old: Any = None) -> Any:
        """Convert a file's value; `old` is the value of the base that the file changes.

        Raises
        ------
        ParameterError
            The value cannot be used; the message begins with `where` and names the key.
        """
        raise NotImplementedError

    def write(self, value: Any) -> Any:
        """Convert a value to the file's representation."""
        return value


@dataclass(frozen=True)
class ReadBy(Entry):
    """Entry that is read and written by functions.

    Parameters
    ----------
    reads : callable
        Function of a file's value, the key and the prefix of messages that returns the value.
    writes : callable
        Function of the value that returns the file's value.
    """

    reads: Callable[[Any, str, str], Any]
    writes: Callable[[Any], Any] = lambda value: value

    def read(self, value: Any, where: str, old: Any = None) -> Any:  # noqa: ARG002
        """Convert a file's value by `reads`."""
        return self.reads(value, self.key, where)

    def write(self, value: Any) -> Any:
        """Convert a value by `writes`."""
        return self.writes(value)


def _texts(value: Any, key: str, where: str) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise ParameterError(f"{where}: {key} must be a list of texts")
    return tuple(as_text(each, key, where) for each in value)


def _flag(value: Any, key: str, where: str) -> bool:
    if not isinstance(value, bool):
        raise ParameterError(f"{where}: {key} = {show(value)} must be true or false")
    return value


def _vector(value: Any, key: str, where: str, size: int) -> tuple[float, ...]:
    if not isinstance(value, list) or len(value) != size:
        raise ParameterError(f"{where}: {key} = {show(value)} must be a list of {size} numbers")
    return tuple(number({key: each}, key, where, low=-math.inf) for each in value)


Text = partial(ReadBy, reads=as_text)
"""Entry of a text."""

Texts = partial(ReadBy, reads=_texts, writes=list)
"""Entry of a list of texts."""

Flag = partial(ReadBy, reads=_flag)
"""Entry that is true or false."""


def Vector(key: str, size: int) -> Entry:  # noqa: N802  # used like the other entries
    """Return the entry of a list of `size` finite numbers."""
    return ReadBy(key, partial(_vector, size=size), list)


@dataclass(frozen=True)
class Table(Entry):
    """Entry of a table, whose entries a dataclass declares.

    Parameters
    ----------
    kind : type
        The dataclass.
    whole : bool
        Whether the table is complete, or changes that of the base.
    """

    kind: Any
    whole: bool = False

    def read(self, value: Any, where: str, old: Any = None) -> Any:
        """Return the object; fields that the table does not state are those of `old`."""
        return read_table(self.kind, value, f"{where}, {self.key}", None if self.whole else old)

    def write(self, value: Any) -> Any:
        """Return the table of an object."""
        return table_of(value)


@dataclass(frozen=True)
class Quantity(Entry):
    """Entry of a number with a unit and bounds.

    Parameters
    ----------
    size : float
        Size of the unit of the key [SI unit].
    unit : str
        Unit after values.
    low, high : float
        Bounds of possible values [`unit`].
    usual : tuple of float
        Range outside of which a value is used with a remark [`unit`]: from bushings of wipers to
        spring eyes of lorries.
    default : float
        Default value [`unit`].
    closed : bool, optional
        Whether `low` itself is possible; by default unless it is 0.
    infinite : str
        Word for infinity.

    Examples
    --------
    >>> wall = Quantity("wall_mm", 1e-3, "mm", usual=(1.0, 30.0))
    >>> wall.read(4.5, "rig"), wall.remark(0.0045)
    (0.0045000000000000005, 'wall_mm = 0.0045 is outside the usual 1 to 30 mm')
    >>> wall.read("thick", "rig, sleeve")
    Traceback (most recent call last):
    models.errors.ParameterError: rig, sleeve: wall_mm = 'thick' must be a number above 0 mm
    """

    size: float = 1.0
    unit: str = ""
    low: float = 0.0
    high: float = math.inf
    usual: tuple[float, float] = (-math.inf, math.inf)
    default: float = math.nan
    closed: bool | None = None
    infinite: str = ""

    def possible(self, value: float) -> bool:
        """Return whether a value [`unit`] is within the bounds."""
        closed = self.low != 0.0 if self.closed is None else self.closed
        above = self.low <= value if closed else self.low < value
        largest = sys.float_info.max  # an integer may be larger than any float
        return -largest <= value <= largest and above and value <= self.high

    @property
    def wanted(self) -> str:
        """Expected value in words."""
        closed = self.low != 0.0 if self.closed is None else self.closed
        if math.isinf(self.low) and math.isinf(self.high):
            words = "a number"
        elif closed and math.isfinite(self.high):
            words = f"a number from {self.low:g} to {self.high:g}"
        else:
            words = f"a number {'of at least' if closed else 'above'} {self.low:g}"
            words += "" if math.isinf(self.high) else f" and at most {self.high:g}"
        return f"{words} {self.unit}".rstrip() + (
            f', or "{self.infinite}"' if self.infinite else ""
        )

    def read(self, value: Any, where: str, old: Any = None) -> Any:  # noqa: ARG002
        """Convert a number of a file to SI units."""
        if self.infinite and value == self.infinite:
            return math.inf
        converted = math.nan
        if isinstance(value, int | float) and not isinstance(value, bool):
            with suppress(OverflowError):
                converted = float(value)
        if not self.possible(converted):
            raise ParameterError(f"{where}: {self.key} = {show(value)} must be {self.wanted}")
        return self.size * converted

    def write(self, value: Any) -> Any:
        """Convert a number to the unit of the key, or to the word for infinity."""
        return self.infinite if math.isinf(value) else self.of(value)

    def of(self, value: float) -> float:
        """Convert a value [SI unit] to the unit of the key [`unit`], without rounding noise."""
        return value if self.size == 1.0 else float(f"{value / self.size:.12g}")

    def remark(self, *values: float) -> str:
        """Return a remark on values [`unit`] outside the usual range; empty if there are none."""
        low, high = self.usual
        outside = sorted({value for value in values if not low <= value <= high})
        if not outside:
            return ""
        named = f"{outside[0]:g}" + (f" to {outside[-1]:g}" if len(outside) > 1 else "")
        return f"{self.key} = {named} is outside the usual {low:g} to {high:g} {self.unit}"


def number(table: Mapping[str, Any], key: str, where: str, **bounds: Any) -> float:
    """Read the number at a key; the bounds are those of `Quantity` [unit of the key].

    Raises
    ------
    ParameterError
        The number is missing, not a number, or out of bounds.

    Examples
    --------
    >>> number({"speed": 5}, "speed", "rig.toml", high=10.0)
    5.0
    """
    if key not in table:
        raise ParameterError(f"{where}: {key} is missing")
    return float(Quantity(key, **bounds).read(table[key], where))


@lru_cache
def declared(kind: Any) -> dict[str, Any]:
    """Return the declared entries of a dataclass, by the names of its fields.

    Examples
    --------
    >>> from models.bench import Beams
    >>> declared(Beams)["lever"].key
    'lever_m'
    """
    return {
        field.name: entry
        for field in fields(kind)
        for entry in getattr(field.type, "__metadata__", ())
        if isinstance(entry, Entry)
    }


def read_table(
    kind: type[_Kind], table: Any, where: str, old: _Kind | None = None, **others: Any
) -> _Kind:
    """Build an object from a table of its fields.

    Parameters
    ----------
    kind : type
        Dataclass that declares its entries.
    table : mapping
        Table of TOML or JSON.
    where : str
        Prefix of messages, which ends with the table's name.
    old : object, optional
        Object of the same kind, from which fields that the table does not state are taken.
    **others : object
        Fields that are not in the table.

    Raises
    ------
    ParameterError
        A key is unknown or missing, or a value cannot be used.

    Examples
    --------
    >>> from models.bench import Microphone
    >>> read_table(Microphone, {"position_m": [0.0, 0.1, 1.0]}, "rig, microphone")
    Microphone(position=(0.0, 0.1, 1.0))
    """
    name = where.rpartition(", ")[2]
    table = as_table(table, name, where.removesuffix(f", {name}"))
    entries: dict[str, Entry] = declared(kind)  # type: ignore[arg-type]
    refuse_unknown(table, [entry.key for entry in entries.values()], where)
    values = {
        field: entry.read(table[entry.key], where, getattr(old, field, None))
        for field, entry in entries.items()
        if entry.key in table
    }
    if old is None:
        for field in fields(kind):  # type: ignore[arg-type]
            stated = field.name in values or field.name not in entries
            if not stated and field.default is field.default_factory is MISSING:
                raise ParameterError(f"{where}: {entries[field.name].key} is missing")
    try:
        if old is None:
            return kind(**values, **others)
        return replace(old, **values, **others)  # type: ignore[type-var]
    except ParameterError as error:
        raise ParameterError(f"{where}: {str(error).removeprefix(f'{name}: ')}") from None


def table_of(obj: Any) -> dict[str, Any]:
    """Return the table of an object's entries, without those at their default."""
    defaults = {field.name: field.default for field in fields(obj)}
    return {
        entry.key: entry.write(value)
        for name, entry in declared(type(obj)).items()  # type: ignore[arg-type]
        if (value := getattr(obj, name)) is not None and value != defaults[name]
    }


def _quantities(
    obj: Any, collected: dict[Quantity, list[float]] | None = None
) -> dict[Quantity, list[float]]:
    """Return the declared quantities of an object and its parts, each with its values.

    Values are in the unit of the key; infinite ones that have a word are left out.
    """
    collected = {} if collected is None else collected
    if isinstance(obj, tuple):
        for each in obj:
            _quantities(each, collected)
    elif is_dataclass(obj) and not isinstance(obj, type):
        entries = declared(type(obj))
        for field in fields(obj):
            value, entry = getattr(obj, field.name), entries.get(field.name)
            quantity = getattr(entry, "value", entry)  # the value of a table by support
            if not isinstance(quantity, Quantity):
                _quantities(value, collected)
                continue
            values = value.values() if isinstance(value, Mapping) else (value,)
            stated = [x for x in values if not (x is None or (quantity.infinite and x == math.inf))]
            collected.setdefault(quantity, []).extend(map(quantity.of, stated))
    return collected


def remarks(obj: Any) -> tuple[str, ...]:
    """Return a remark for each quantity of an object outside its usual range.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> remarks(load_material_rig("fluorocarbon"))
    ()
    """
    return tuple(text for one, values in _quantities(obj).items() if (text := one.remark(*values)))


def refuse_impossible(obj: Any, where: str) -> None:
    """Raise if a declared quantity of an object is not possible.

    Raises
    ------
    ParameterError
        A value is out of bounds; the message begins with `where` and names it.
    """
    for one, values in _quantities(obj).items():
        for value in values:
            if not one.possible(value):
                raise ParameterError(f"{where}: {one.key} = {value:g} must be {one.wanted}")


def toml_text(content: Mapping[str, Any], notes: Iterable[str] = ()) -> str:
    """Return tables as TOML text.

    Parameters
    ----------
    content : mapping
        Tables and lists of tables by name.
    notes : iterable of str
        Lines of comment at the top.

    Examples
    --------
    >>> print(toml_text({"base": "PDMS", "change": {"damping": "x2"}}, ["mine"]), end="")
    # mine
    base = "PDMS"
    <BLANKLINE>
    [change]
    damping = "x2"
    """
    import tomli_w

    return "".join(f"# {note}".rstrip() + "\n" for note in notes) + tomli_w.dumps(content)
