"""Arrays from outside (NPZ, NPY), of which no more is set aside than their file can hold.

An NPZ file of a few megabytes can inflate to as many gigabytes, and a header can announce any
shape. So what each member announces is added up and compared with the size of the file before the
first is read. Nothing is unpickled.
"""

from __future__ import annotations

import math
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib import format as npy

from models.foreign_file import ExcessError, check_inflation

if TYPE_CHECKING:
    from pathlib import Path
    from typing import IO

    from numpy.typing import NDArray

__all__ = ["read_array", "read_arrays"]

_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_ENDING = ".npy"


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
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.savez(Path(folder) / "a.npz", torque=np.ones(3))
    ...     read_arrays(Path(folder) / "a.npz")
    {'torque': array([1., 1., 1.])}
    """
    check_inflation(path)
    arrays: dict[str, NDArray[Any]] = {}
    with zipfile.ZipFile(path) as archive:
        for member in archive.infolist():
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise ValueError(f"{member.filename} is compressed in a way that is not known")
            with archive.open(member) as file:
                name = member.filename.removesuffix(_ENDING)
                arrays[name] = _array(file, member.file_size, member.filename)
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
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder) / "hit.npy", np.ones((3, 2)))
    ...     read_array(Path(folder) / "hit.npy").shape
    (3, 2)
    """
    with path.open("rb") as file:
        return _array(file, path.stat().st_size, "its header")


def _array(file: IO[bytes], size: int, name: str) -> NDArray[Any]:
    """Read an array of which so many bytes are there."""
    version = npy.read_magic(file)
    if version not in _HEADERS:
        raise ValueError(f"{name} has version {version}")
    shape, fortran_order, dtype = _HEADERS[version](file)
    if dtype.hasobject:
        raise ValueError(f"{name} is of objects, expected numbers or texts")
    n = math.prod(shape) * dtype.itemsize
    if n > size or min(shape, default=0) < 0:
        raise ExcessError(f"{name} announces {n} bytes, of which {size} are there")
    values = np.frombuffer(file.read(n), dtype) if n else np.empty(0, dtype)
    if n and values.nbytes != n:
        raise ValueError(f"{name} is cut short")
    return values.reshape(shape, order="F" if fortran_order else "C").copy(order="A")
