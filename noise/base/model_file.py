"""Model files: a header in JSON and plain arrays in one NPZ file, read and written whole.

Opening such a file runs no code. The header says what the model is (``kind``), in which form it is
kept (``format``), the names of what it takes and gives, and under ``card`` how it was made.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.foreign_file import ExcessError, parse_json, read_arrays, reading
from noise.base.files import atomic

if TYPE_CHECKING:
    Header = Mapping[str, Any]
    Arrays = Mapping[str, NDArray[Any]]


_Model = TypeVar("_Model")


class ModelKind(NamedTuple):
    """A kind of model, and the form in which this version of the program keeps it.

    Parameters
    ----------
    name : str
        As messages call it.
    version : int
        Of the form.
    made_by : str
        The command that makes such a file, whose name follows.
    shipped : tuple of str
        Package and name of the file that is used where none is named.
    """

    name: str
    version: int
    made_by: str
    shipped: tuple[str, str]


_LONGEST_HEADER = 16 << 20
"""As an array of characters; those that are shipped have a hundredth of it [byte]."""


def save_model(path: str | Path, kind: ModelKind, header: Header, arrays: Arrays) -> None:
    """Write a model, whole or not at all.

    Parameters
    ----------
    path : path-like
        NPZ file; parent folders are made.
    kind : ModelKind
    header : mapping
        What JSON can hold: names of what the model takes and gives, and its ``card``.
    arrays : mapping of str to ndarray
        Of any shape and unit, by any name but ``header``.

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
    """Load a model.

    Parameters
    ----------
    path : path-like or None
        NPZ file that `save_model` wrote; None is the one that is shipped, which is read once.
    kind : ModelKind
    build : callable
        ``build(header, arrays)`` returns the model; it raises ValueError where they do not fit
        together, in words that go on from "its file".

    Raises
    ------
    ParameterError
        There is no such file, or it holds no model of this kind and form.
    """
    return _shipped(kind, build) if path is None else _read(Path(path), kind, build)


def model_digest(path: Path | None, kind: ModelKind) -> str:
    """Return the SHA-256 of a model's file; None is the one that is shipped."""
    package, name = kind.shipped
    shipped = resources.files(package) / "data" / name if path is None else path
    return hashlib.sha256(shipped.read_bytes()).hexdigest()


@cache
def _shipped(kind: ModelKind, build: Callable[[Header, Arrays], _Model]) -> _Model:
    package, name = kind.shipped
    with resources.as_file(resources.files(package) / "data" / name) as path:
        return _read(path, kind, build)


def _read(path: Path, kind: ModelKind, build: Callable[[Header, Arrays], _Model]) -> _Model:
    refused = f"{kind.name} {path}"
    with reading(path, f"file that `{kind.made_by}` wrote", where=refused):
        arrays = read_arrays(path)
        said = arrays.pop("header")
        if said.nbytes > _LONGEST_HEADER:
            raise ExcessError(f"holds a header of {said.nbytes / 1e6:.3g} MB")
        header = parse_json(str(said))
        other = header.get("kind", kind.name)
        if other != kind.name:
            raise ParameterError(f"{refused}: is a {other}, expected a {kind.name}")
        if header["format"] != kind.version:
            raise ParameterError(
                f"{refused}: of format {header['format']!r}, expected {kind.version}; make it "
                f"again with `{kind.made_by} {path.name}`"
            )
        return build(header, arrays)
