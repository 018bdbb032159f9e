"""Safe reading of foreign files: checks before opening, bounded sizes, uniform errors.

All readers use this module. Anything but a plain file (a pipe, a device, a folder) is refused
without opening it, since opening may block forever. Sizes are bounded before memory is allocated:
of the file, the depth of nested lists, the inflated size of an archive, and the size in an array's
header. Nothing is unpickled. Whatever a library raises for a damaged file becomes one error of one
line that names the file.

Text tables of numbers are CSV as loggers, analysers and spreadsheets write it. Columns are
separated by semicolons, tabs, commas or blanks; numbers may have a decimal comma unless commas
separate columns. The rows above the numbers give names and units of the columns: ``Force [kN]``, or
a row of units below a row of names.
"""

from __future__ import annotations

import codecs
import csv
import io
import json
import stat
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import BushingNoiseError, ParameterError
from models.units import quantity_of_unit, split_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LARGEST_TEXT = 1 << 30
"""Largest text table, which is read line by line [byte]."""

LARGEST_TOML = 1 << 17
"""Largest TOML file, whose parser takes quadratic time for dotted keys [byte]."""

LARGEST_JSON = 64 << 20
"""Largest JSON file, which is read as a whole [byte]."""

_ALLOWANCE, _MOST = 64 << 20, 100
"""Allowed inflated size of an archive in bytes, and as a multiple of its size."""

_LONGEST_REASON = 200  # characters

_KINDS = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket"}


class ExcessError(ValueError):
    """Error for a file beyond a limit; the message continues after the file's name."""


@contextmanager
def reading(
    path: Path,
    what: str,
    *,
    where: str | None = None,
    error: type[BushingNoiseError] = ParameterError,
    largest: int | None = None,
) -> Iterator[None]:
    """Context of reading a foreign file: every error in it becomes one line about the file.

    Parameters
    ----------
    path : Path
        Path of the file; anything but a plain file is refused without opening it.
    what : str
        Expected kind of file, such as ``"NPZ file"``.
    where : str, optional
        Name of the file in messages; by default its path.
    error : type
        Type of the error; errors of `models.errors` pass unchanged.
    largest : int, optional
        Largest size [byte].

    Raises
    ------
    BushingNoiseError
        Of the type `error`.

    Examples
    --------
    >>> with reading(Path("nowhere.npz"), "NPZ file"):
    ...     raise AssertionError
    Traceback (most recent call last):
    models.errors.ParameterError: nowhere.npz: there is no such file
    """
    where = str(path) if where is None else where
    with refusing(where, what, error):
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            kind = _KINDS.get(stat.S_IFMT(status.st_mode), "a device")
            raise ExcessError(f"is {kind}, not a file")
        if largest is not None and status.st_size > largest:
            raise ExcessError(
                f"has {status.st_size / 1e6:.0f} MB, and {largest / 1e6:.0f} MB are the most that "
                f"is read of a {what}"
            )
        yield


@contextmanager
def refusing(
    where: str, what: str, error: type[BushingNoiseError] = ParameterError
) -> Iterator[None]:
    """Context of using a file's values: every error in it becomes one line.

    Parameters
    ----------
    where, what, error
        As for `reading`.

    Raises
    ------
    BushingNoiseError
        Of the type `error`.

    Examples
    --------
    >>> with refusing("rig file a.toml", "rig file"):
    ...     float(10 ** 400)
    Traceback (most recent call last):
    models.errors.ParameterError: rig file a.toml: is damaged or no rig file (OverflowError: int ...
    """
    try:
        yield
    except BushingNoiseError:
        raise
    except ExcessError as raised:
        raise error(f"{where}: {raised}") from None
    except FileNotFoundError:
        raise error(f"{where}: there is no such file") from None
    except OSError as raised:
        raise error(f"{where}: cannot be read ({one_line(raised.strerror or raised)})") from raised
    except MemoryError as raised:
        raise error(f"{where}: needs more memory than there is") from raised
    except RecursionError as raised:
        raise error(f"{where}: is no {what} (too deep)") from raised
    except Exception as raised:  # libraries raise exceptions of any type
        reason = f"lacks {raised}" if isinstance(raised, KeyError) else one_line(raised)
        if not reason or not isinstance(raised, ValueError | KeyError):
            reason = f"{type(raised).__name__}: {reason}".removesuffix(": ")
        raise error(f"{where}: is damaged or no {what} ({reason})") from raised


def check_plain_file(path: Path) -> None:
    """Raise unless a path is an existing plain file, without opening it.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ParameterError
        If it is none.

    Examples
    --------
    >>> check_plain_file(Path("/dev"))
    Traceback (most recent call last):
    models.errors.ParameterError: /dev: is a folder, not a file
    """
    with reading(path, "file"):
        pass


def check_inflation(path: Path) -> None:
    """Raise if a ZIP archive would inflate beyond the limits.

    Parameters
    ----------
    path : Path
        Path of an NPZ file.

    Raises
    ------
    ValueError
        It would. Errors of the library for other files are left to `reading`.
    """
    size = path.stat().st_size
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
    for member in members:
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{member.filename} has an unknown compression")
    total = sum(member.file_size for member in members)
    if total > max(_ALLOWANCE, _MOST * size):
        raise ExcessError(f"would inflate from {size / 1e6:.3g} MB to {total / 1e6:.3g} MB")


def one_line(text: object) -> str:
    r"""Return a message as one line of bounded length.

    Examples
    --------
    >>> one_line("Error:\n  in line 2")
    'Error: in line 2'
    """
    line = " ".join(str(text).split())
    return line if len(line) <= _LONGEST_REASON else f"{line[:_LONGEST_REASON]}..."


def parse_json(text: str | bytes) -> Any:
    """Parse JSON.

    Parameters
    ----------
    text : str or bytes
        Bytes in UTF-8, UTF-16 or UTF-32.

    Raises
    ------
    ValueError
        The text is not JSON, or nested too deep.

    Examples
    --------
    >>> parse_json('{"speed_rad_s": 5.0}')
    {'speed_rad_s': 5.0}
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ExcessError("holds lists or tables too deep in one another") from None


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Read the arrays of an NPZ file, within `models.foreign_file.reading`.

    Parameters
    ----------
    path : Path

    Returns
    -------
    dict of str to ndarray
        Of any shape and unit, by name.

    Raises
    ------
    ValueError
        The file is damaged, contains anything but arrays of numbers and texts, or would inflate
        beyond the limits. Other errors of the libraries are left to `reading`.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.savez(Path(folder) / "a.npz", torque=np.ones(3))
    ...     read_arrays(Path(folder) / "a.npz")
    {'torque': array([1., 1., 1.])}
    """
    import numpy as np

    check_inflation(path)
    with np.load(path, allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray):
            raise ValueError(f"{name} is no array")
    return arrays


def read_array(path: Path) -> NDArray[Any]:
    """Read the array of an NPY file, within `models.foreign_file.reading`.

    Parameters
    ----------
    path : Path

    Returns
    -------
    ndarray, shape (...)
        In any unit, such as [Nm].

    Raises
    ------
    ValueError
        The file is damaged, or its header announces more than it contains.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder) / "hit.npy", np.ones((3, 2)))
    ...     read_array(Path(folder) / "hit.npy").shape
    (3, 2)
    """
    import numpy as np

    array = np.load(path, allow_pickle=False)
    if not isinstance(array, np.ndarray):
        raise ValueError("is an archive, expected one array")
    return array


_SEPARATORS = (";", "\t", ",", " ")


@dataclass(frozen=True, eq=False)
class ForeignTable:
    """Table of numbers with named columns.

    Parameters
    ----------
    names, units : tuple of str
        One per column; units as the file spells them, empty where it states none.
    values : ndarray, shape (n_rows, n_columns)
        [units of the file]; NaN for an empty cell.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: NDArray[np.float64]


def read_table(path: Path) -> ForeignTable:
    r"""Read a table of two or more columns, within `models.foreign_file.reading`.

    Parameters
    ----------
    path : Path
        Text in UTF-8, UTF-16 with a byte order mark, or Windows-1252.

    Raises
    ------
    ValueError
        The table has no numbers, rows differ in length, or a cell is not a number.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "hit.csv"
    ...     _ = path.write_text("Zeit [s];Kraft [N]\n0;1,5\n0,001;80\n", encoding="utf-8")
    ...     table = read_table(path)
    >>> table.names, table.units, table.values.tolist()
    (('Zeit', 'Kraft'), ('s', 'N'), [[0.0, 1.5], [0.001, 80.0]])
    """
    import numpy as np

    text, _ = decoded(path.read_bytes())
    for separator in _SEPARATORS:
        reader = csv.reader(
            io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=separator == " "
        )
        try:
            rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
        except csv.Error:  # a long line without this separator is one field, longer than allowed
            continue
        rows = [(line, row) for line, row in rows if any(row)]
        first = next((i for i, (_, row) in enumerate(rows) if _begins_numbers(row)), None)
        if first is not None:
            break
    else:
        raise ExcessError("holds no rows of numbers; columns are separated by ; or , or tabs")
    n = len(rows[first][1])
    if not any(row[-1] for _, row in rows[first:]):  # a separator at the end of each line
        n -= 1
    values = np.empty((len(rows) - first, n))
    names, units = _headings([row[:n] for _, row in rows[:first] if len(row) >= n], n)
    for target, (line, row) in zip(values, rows[first:], strict=True):
        if len(row) < n or any(row[n:]):
            raise ExcessError(
                f"line {line} has {len(row)} columns, those before it have {n}"
                + "; where commas separate columns, numbers have a decimal point"
                * (separator == ",")
            )
        for column, cell in enumerate(row[:n]):
            try:
                target[column] = float(cell.replace(",", ".")) if cell else np.nan
            except ValueError:
                name = names[column] or f"column {column + 1}"
                raise ExcessError(f"{name} is {cell!r} in line {line}, expected a number") from None
    return ForeignTable(names, units, values)


def decoded(content: bytes) -> tuple[str, str]:
    """Return a text and its encoding; for that of a code page, the one to write it in.

    Examples
    --------
    >>> decoded("Größe".encode("utf-16")), decoded("Größe".encode("cp1252"))
    (('Größe', 'utf-16'), ('Größe', 'utf-8-sig'))
    """
    if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return content.decode("utf-16"), "utf-16"
    marked = content.startswith(codecs.BOM_UTF8)
    try:
        return content.decode("utf-8-sig"), "utf-8-sig" if marked else "utf-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace"), "utf-8-sig"


def _begins_numbers(row: list[str]) -> bool:
    try:
        float(row[0].replace(",", "."))
    except ValueError:
        return False
    return sum(map(bool, row)) > 1


def _headings(rows: list[list[str]], n: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of columns from the rows nearest above the numbers."""
    stated = [""] * n
    for row in reversed(rows):
        if quantity_of_unit(row[0]) and not any(stated):  # a row of units
            stated = row
        elif any(row[1:]):
            parts = [split_unit(cell.lstrip("#% ")) for cell in row]
            # A column whose only heading is a unit has that unit.
            units = [
                unit or below or (name if quantity_of_unit(name) else "")
                for (name, unit), below in zip(parts, stated, strict=True)
            ]
            return tuple(name for name, _ in parts), tuple(units)
    return ("",) * n, tuple(stated)
