"""Declared entries of rig files: key, unit, bounds and plausible range of each, stated once.

A dataclass declares how a file states a field: ``Annotated[float, Quantity("wall_mm", 1e-3)]``.
From the declarations follow reading, with refusals that name key, value and what would be right;
remarks on values that are unusual; and writing. Fields without a declaration are in no file.
"""

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import lru_cache, partial
from reprlib import repr as show
from typing import Any, TypeVar

from models.errors import ParameterError

_Kind = TypeVar("_Kind")


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the question whether the nearest known name was meant, empty where none is near.

    Examples
    --------
    >>> did_you_mean("desing", ["design", "fit"]), did_you_mean("x", ["design"])
    ("; did you mean 'design'?", '')
    """
    near = get_close_matches(name, list(known), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def refuse_unknown(table: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    """Refuse keys that are not known, which are most often misspelt.

    Raises
    ------
    ParameterError
        A key is not among `known`.

    Examples
    --------
    >>> refuse_unknown({"speed": 1.0}, {"speed"}, "rig.toml")
    """
    for key in table:
        if key not in (names := sorted(known)):
            raise ParameterError(
                f"{where}: unknown key {key!r}{did_you_mean(key, names)}; known are "
                f"{', '.join(names)}"
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
    """An entry of a file.

    Parameters
    ----------
    key : str
        By which files state it.
    """

    key: str

    def read(self, value: Any, where: str, old: Any = None) -> Any:
        """Return what a file's value means; `old` is that of the base which the file changes.

        Raises
        ------
        ParameterError
            It cannot be used; the message begins with `where` and names the key.
        """
        raise NotImplementedError

    def write(self, value: Any) -> Any:
        """Return the value as a file states it."""
        return value


@dataclass(frozen=True)
class ReadBy(Entry):
    """An entry that functions read and write.

    Parameters
    ----------
    reads : callable
        From a file's value, the key and what messages begin with to what the value means.
    writes : callable
        Back to a file's value.
    """

    reads: Callable[[Any, str, str], Any]
    writes: Callable[[Any], Any] = lambda value: value

    def read(self, value: Any, where: str, old: Any = None) -> Any:  # noqa: ARG002
        """Return what `reads` makes of a file's value."""
        return self.reads(value, self.key, where)

    def write(self, value: Any) -> Any:
        """Return what `writes` makes of the value."""
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
"""A text."""

Texts = partial(ReadBy, reads=_texts, writes=list)
"""A list of texts."""

Flag = partial(ReadBy, reads=_flag)
"""True or false."""


def Vector(key: str, size: int) -> Entry:  # noqa: N802  # stands among types
    """Declare a list of so many finite numbers."""
    return ReadBy(key, partial(_vector, size=size), list)


@dataclass(frozen=True)
class Table(Entry):
    """A table of the entries that a dataclass declares.

    Parameters
    ----------
    kind : type
        The dataclass.
    whole : bool
        Whether the table states all, or changes the base's.
    """

    kind: Any
    whole: bool = False

    def read(self, value: Any, where: str, old: Any = None) -> Any:
        """Return the object; what the table does not state is that of `old`."""
        return read_table(self.kind, value, f"{where}, {self.key}", None if self.whole else old)

    def write(self, value: Any) -> Any:
        """Return the table."""
        return table_of(value)


@dataclass(frozen=True)
class Quantity(Entry):
    """A number with a unit and bounds.

    Parameters
    ----------
    size : float
        Of the unit of the key [SI unit].
    unit : str
        Shown behind values.
    low, high : float
        Between which a value is possible, as wide as numbers still mean something [`unit`].
    usual : tuple of float
        Outside of which a value is used with a remark [`unit`]: from the thesis's rig to bushings
        of a wiper and of a lorry's spring eye.
    slips : tuple of (float, str)
        Factors that bring a value in a wrong unit to the right one, and that unit.
    default : float
        Where nothing is stated [`unit`].
    closed : bool, optional
        Whether `low` itself is possible; by default, unless it is 0.
    infinite : str
        Word that stands for infinity.

    Examples
    --------
    >>> wall = Quantity("wall_mm", 1e-3, "mm", usual=(1.0, 30.0), slips=((1e3, "metres"),))
    >>> wall.read(4.5, "rig"), wall.remark(0.0045)
    (0.0045000000000000005, 'wall_mm = 0.0045 is outside the usual 1 to 30 mm (is it in metres?)')
    >>> wall.read("thick", "rig, sleeve")
    Traceback (most recent call last):
    models.errors.ParameterError: rig, sleeve: wall_mm = 'thick' must be a number above 0 mm
    """

    size: float = 1.0
    unit: str = ""
    low: float = 0.0
    high: float = math.inf
    usual: tuple[float, float] = (-math.inf, math.inf)
    slips: tuple[tuple[float, str], ...] = ()
    default: float = math.nan
    closed: bool | None = None
    infinite: str = ""

    def possible(self, value: float) -> bool:
        """Whether a value [`unit`] can be."""
        closed = self.low != 0.0 if self.closed is None else self.closed
        above = self.low <= value if closed else self.low < value
        largest = sys.float_info.max  # an integer may be larger than any float
        return -largest <= value <= largest and above and value <= self.high

    @property
    def wanted(self) -> str:
        """What would be right, in words."""
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
        """Return a number in SI units."""
        if self.infinite and value == self.infinite:
            return math.inf
        found = math.nan
        if isinstance(value, int | float) and not isinstance(value, bool):
            with suppress(OverflowError):
                found = float(value)
        if not self.possible(found):
            raise ParameterError(f"{where}: {self.key} = {show(value)} must be {self.wanted}")
        return self.size * found

    def write(self, value: Any) -> Any:
        """Return a number in the unit of the key, or the word for infinity."""
        return self.infinite if math.isinf(value) else self.of(value)

    def of(self, value: float) -> float:
        """Return a value [SI unit] in the unit of the key [`unit`], without noise of rounding."""
        return value if self.size == 1.0 else float(f"{value / self.size:.12g}")

    def remark(self, *values: float) -> str:
        """Say in one line which values [`unit`] are outside the usual; empty where none is."""
        low, high = self.usual
        outside = sorted({value for value in values if not low <= value <= high})
        if not outside:
            return ""
        named = f"{outside[0]:g}" + (f" to {outside[-1]:g}" if len(outside) > 1 else "")
        units = (
            unit
            for factor, unit in self.slips
            if all(low <= factor * value <= high for value in outside)
        )
        unit = next(units, "")
        hint = f" (is it in {unit}?)" if unit else ""
        return f"{self.key} = {named} is outside the usual {low:g} to {high:g} {self.unit}{hint}"


def number(table: Mapping[str, Any], key: str, where: str, **bounds: Any) -> float:
    """Return the number at a key; the bounds are those of `Quantity` [unit of the key].

    Raises
    ------
    ParameterError
        It is missing, no number, or out of bounds.

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
    """Entries that a dataclass declares, by the names of its fields.

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
    """Build an object of a table that states its fields.

    Parameters
    ----------
    kind : type
        Dataclass that declares its entries.
    table : mapping
        As TOML or JSON gives it.
    where : str
        What messages begin with; it ends with the table's name.
    old : object, optional
        Of the same kind: what the table does not state stays as it is in this one.
    **others : object
        Fields that no table states.

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
    found = {
        field: entry.read(table[entry.key], where, getattr(old, field, None))
        for field, entry in entries.items()
        if entry.key in table
    }
    if old is None:
        for field in fields(kind):  # type: ignore[arg-type]
            given = field.name in found or field.name not in entries
            if not given and field.default is field.default_factory is MISSING:
                raise ParameterError(f"{where}: {entries[field.name].key} is missing")
    try:
        if old is None:
            return kind(**found, **others)
        return replace(old, **found, **others)  # type: ignore[type-var]
    except ParameterError as error:
        raise ParameterError(f"{where}: {str(error).removeprefix(f'{name}: ')}") from None


def table_of(shown: Any, *, whole: bool = False) -> dict[str, Any]:
    """Return the table of an object's entries, with those that have their default if `whole`."""
    defaults = {field.name: field.default for field in fields(shown)}
    return {
        entry.key: entry.write(value)
        for name, entry in declared(type(shown)).items()  # type: ignore[arg-type]
        if (value := getattr(shown, name)) is not None and (whole or value != defaults[name])
    }


def quantities(shown: Any) -> Iterator[tuple[Quantity, list[float]]]:
    """Go through the declared quantities of an object and of those in it, each with its values.

    Values are in the unit of the key; infinite ones that a word may stand for are left out.

    Examples
    --------
    >>> from models.bushing import Sleeve
    >>> [(one.key, values) for one, values in quantities(Sleeve(0.015, 0.0045, 0.04, 7e6))][:2]
    [('inner_radius_mm', [15.0]), ('wall_mm', [4.5])]
    """
    found: dict[Quantity, list[float]] = {}
    _collect(shown, found)
    yield from found.items()


def _collect(shown: Any, found: dict[Quantity, list[float]]) -> None:
    if isinstance(shown, tuple):
        for each in shown:
            _collect(each, found)
    elif hasattr(shown, "quantities"):
        for quantity, values in shown.quantities():
            found.setdefault(quantity, []).extend(values)
    elif is_dataclass(shown) and not isinstance(shown, type):
        entries = declared(type(shown))
        for field in fields(shown):
            value, entry = getattr(shown, field.name), entries.get(field.name)
            quantity = getattr(entry, "value", entry)  # of a table by support
            if not isinstance(quantity, Quantity):
                _collect(value, found)
                continue
            values = value.values() if isinstance(value, Mapping) else (value,)
            stated = [x for x in values if not (x is None or (quantity.infinite and x == math.inf))]
            found.setdefault(quantity, []).extend(map(quantity.of, stated))


def remarks(shown: Any) -> tuple[str, ...]:
    """Say of each quantity of an object that is outside the usual so, a line a quantity.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> remarks(load_material_rig("fluorocarbon"))
    ()
    """
    return tuple(text for one, values in quantities(shown) if (text := one.remark(*values)))


def refuse_impossible(shown: Any, where: str) -> None:
    """Refuse an object of which a declared quantity cannot be.

    Raises
    ------
    ParameterError
        A value is not possible; the message begins with `where` and names it.
    """
    for one, values in quantities(shown):
        for value in values:
            if not one.possible(value):
                raise ParameterError(f"{where}: {one.key} = {value:g} must be {one.wanted}")


def toml_text(content: Mapping[str, Any], notes: Iterable[str] = ()) -> str:
    """Write tables as TOML.

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
