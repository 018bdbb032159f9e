"""Model files: one NPZ file with a JSON header and plain arrays.

Opening such a file runs no code. The header holds the type of the model (``kind``), the version of
the file format (``format``), the names of inputs and outputs, and the origin (``card``).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.foreign_file import ExcessError, parse_json, read_arrays, reading
from noise.base.files import atomic

Header = Mapping[str, Any]
Arrays = Mapping[str, NDArray[Any]]
_Model = TypeVar("_Model")


class ModelKind(NamedTuple):
    """Type of a model and version of its file format.

    Parameters
    ----------
    name : str
        Name in messages.
    version : int
        Version of the file format.
    made_by : str
        Command that writes such a file, without the file name.
    shipped : tuple of str
        Package and file name of the default model.
    """

    name: str
    version: int
    made_by: str
    shipped: tuple[str, str]


_LONGEST_HEADER = 16 << 20
"""Largest header; those of the shipped models take a hundredth of it [byte]."""


def save_model(path: str | Path, kind: ModelKind, header: Header, arrays: Arrays) -> None:
    """Write a model file atomically.

    Parameters
    ----------
    path : path-like
        NPZ file; parent folders are made.
    kind : ModelKind
    header : mapping
        JSON values: names of inputs and outputs, and the ``card``.
    arrays : mapping of str to ndarray
        Arrays of any shape and unit under any name but ``header``.

    Raises
    ------
    ParameterError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> mean = ModelKind("mean", 1, "make-mean --out", ("", ""))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "mean.npz"
    ...     save_model(path, mean, {"unit": "Nm"}, {"value": np.array(3.0)})
    ...     load_model(path, mean, lambda header, arrays: (header["unit"], float(arrays["value"])))
    ('Nm', 3.0)
    """
    text = json.dumps({"kind": kind.name, "format": kind.version, **header})
    with atomic(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **{"header": np.array(text), **arrays})  # type: ignore[arg-type]


def load_model(
    path: str | Path | None, kind: ModelKind, build: Callable[[Header, Arrays], _Model]
) -> _Model:
    """Load a model file.

    Parameters
    ----------
    path : path-like or None
        NPZ file from `save_model`; None is the shipped model, which is cached.
    kind : ModelKind
    build : callable
        ``build(header, arrays)`` returns the model. It raises ValueError for inconsistent
        contents, with a message that follows the name of the file.

    Raises
    ------
    ParameterError
        There is no such file, or it holds another kind of model or format.
    """
    return _shipped(kind, build) if path is None else _read(Path(path), kind, build)


def model_digest(path: Path | None, kind: ModelKind) -> str:
    """Return the SHA-256 of a model file; None is the shipped model."""
    package, name = kind.shipped
    shipped = resources.files(package) / "data" / name if path is None else path
    return hashlib.sha256(shipped.read_bytes()).hexdigest()


@cache
def _shipped(kind: ModelKind, build: Callable[[Header, Arrays], _Model]) -> _Model:
    """Load the shipped model of a kind."""
    package, name = kind.shipped
    with resources.as_file(resources.files(package) / "data" / name) as path:
        return _read(path, kind, build)


def _read(path: Path, kind: ModelKind, build: Callable[[Header, Arrays], _Model]) -> _Model:
    """Read a model file and check its kind and format."""
    where = f"{kind.name} {path}"
    with reading(path, f"file that `{kind.made_by}` wrote", where=where):
        arrays = read_arrays(path)
        text = arrays.pop("header")
        if text.nbytes > _LONGEST_HEADER:
            raise ExcessError(f"holds a header of {text.nbytes / 1e6:.3g} MB")
        header = parse_json(str(text))
        other = header.get("kind", kind.name)
        if other != kind.name:
            raise ParameterError(f"{where}: is a {other}, expected a {kind.name}")
        if header["format"] != kind.version:
            raise ParameterError(
                f"{where}: of format {header['format']!r}, expected {kind.version}; make it "
                f"again with `{kind.made_by} {path.name}`"
            )
        return build(header, arrays)
