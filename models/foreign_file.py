"""Files from outside: looked at before they are opened, and read without trust.

Every reader goes through here. What is no plain file (a pipe, a device, a folder) is refused
without being opened, since opening it may wait forever. Sizes are bounded before anything is set
aside for them: of the file, of how deep its lists lie in one another, of what an archive inflates
to and an array's header announces. Nothing is unpickled. And whatever a library raises over a
damaged file becomes one error of one line that names the file.
"""

from __future__ import annotations

import json
import stat
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import BushingNoiseError, ParameterError

if TYPE_CHECKING:
    from numpy.typing import NDArray

LARGEST_TEXT = 1 << 30
"""Of a table in text, which is read line by line [byte]."""

LARGEST_TOML = 2 << 20
"""Of a TOML file, whose parser takes about a second a megabyte [byte]."""

LARGEST_JSON = 64 << 20
"""Of a JSON file, which is held as a whole [byte]."""

_ALLOWANCE, _MOST = 64 << 20, 100
"""An archive may inflate to so many bytes, or to so many times its size."""

_LONGEST_REASON = 200  # letters

_KINDS = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket"}


class ExcessError(ValueError):
    """A file asks for more than it may; the message goes on from its name."""


@contextmanager
def reading(
    path: Path,
    what: str,
    *,
    where: str | None = None,
    error: type[BushingNoiseError] = ParameterError,
    largest: int | None = None,
) -> Iterator[None]:
    """Read a file from outside within this block: what goes wrong there is one line about it.

    Parameters
    ----------
    path : Path
        Refused without being opened unless it is a plain file.
    what : str
        What it should be, such as ``"NPZ file"``.
    where : str, optional
        What messages call the file; by default its path.
    error : type
        Of the error; errors of `models.errors` pass as they are.
    largest : int, optional
        Size up to which it is opened [byte].

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
    """Make one line of whatever is raised in this block over values from a file.

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
    except Exception as raised:  # libraries raise whatever comes to them
        raise error(f"{where}: is damaged or no {what} ({_reason(raised)})") from raised


def check_plain_file(
    path: Path, *, where: str | None = None, error: type[BushingNoiseError] = ParameterError
) -> None:
    """Refuse what is no plain file, such as a pipe, without opening it; missing ones as well.

    Parameters
    ----------
    path : Path
    where : str, optional
        What messages call the file; by default its path.
    error : type
        Of the error.

    Raises
    ------
    BushingNoiseError
        Of the type `error`.

    Examples
    --------
    >>> check_plain_file(Path("/dev"))
    Traceback (most recent call last):
    models.errors.ParameterError: /dev: is a folder, not a file
    """
    with reading(path, "file", where=where, error=error):
        pass


def check_inflation(path: Path) -> None:
    """Refuse a ZIP archive whose members would inflate beyond measure.

    Parameters
    ----------
    path : Path
        Of an NPZ file, a workbook.

    Raises
    ------
    ValueError
        They would. What the library raises over no archive is left to `reading`.
    """
    size = path.stat().st_size
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
    for member in members:
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{member.filename} is compressed in a way that is not known")
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
        It is no JSON, or too deep.

    Examples
    --------
    >>> parse_json('{"speed_rad_s": 5.0}')
    {'speed_rad_s': 5.0}
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ExcessError("holds lists or tables too deep in one another") from None


def _reason(raised: Exception) -> str:
    if isinstance(raised, KeyError):
        return one_line(f"lacks {raised}")
    said = one_line(raised)
    if said and isinstance(raised, ValueError):
        return said
    return f"{type(raised).__name__}: {said}" if said else type(raised).__name__


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
        It is damaged, holds something else than arrays of numbers and texts, or would inflate
        beyond measure. What the libraries raise on top of that is left to `reading`.

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
        It is damaged, or its header announces more than there is.

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

    found = np.load(path, allow_pickle=False)
    if not isinstance(found, np.ndarray):
        raise ValueError("is an archive, expected one array")
    return found
