"""Display of results: a short representation for ``print``, and a data frame for tables."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from models.errors import ParameterError, not_installed

if TYPE_CHECKING:
    from pandas import DataFrame

_Class = TypeVar("_Class", bound=type)

_LONGEST = 400
"""Longest representation in characters."""


class _Short(reprlib.Repr):
    """Short representation of values: arrays by shape and type, dataclasses by name."""

    def repr1(self, x: Any, level: int) -> str:
        if dataclasses.is_dataclass(x):
            return f"<{type(x).__name__}>"  # without its attributes, which may be slow
        if hasattr(x, "shape") and hasattr(x, "dtype"):
            return f"<{' x '.join(map(str, x.shape))} {x.dtype}>" if x.shape else repr(x.item())
        return super().repr1(x, level)


_short = _Short()
_short.maxstring = _short.maxother = 60


def short_repr(cls: _Class) -> _Class:
    """Give a dataclass a representation of bounded length.

    Examples
    --------
    >>> import numpy as np
    >>> @short_repr
    ... @dataclasses.dataclass
    ... class Sound:
    ...     name: str
    ...     samples: np.ndarray
    >>> Sound("run07", np.zeros((2, 48000)))
    Sound(name='run07', samples=<2 x 48000 float64>)
    """

    def representation(self: object) -> str:
        shown = [
            f"{field.name}={_short.repr(getattr(self, field.name))}"
            for field in dataclasses.fields(cls)
            if field.repr
        ]
        whole = ", ".join(shown)
        if len(whole) > _LONGEST:
            whole = f"{whole[:_LONGEST]} ..."
        return f"{type(self).__name__}({whole})"

    cls.__repr__ = representation  # type: ignore[assignment]
    return cls


def data_frame(columns: Sequence[str], rows: Iterable[Mapping[str, object]]) -> DataFrame:
    """Return a table as a pandas data frame.

    Parameters
    ----------
    columns : sequence of str
        Columns in order; other keys of a row are left out.
    rows : iterable of mapping

    Returns
    -------
    pandas.DataFrame
        Missing values are NaN among numbers, and None elsewhere.

    Raises
    ------
    ParameterError
        pandas is not installed.

    Examples
    --------
    >>> from importlib.util import find_spec
    >>> rows = [{"file": "run07.wav", "level_db": 81.5}, {"file": "bad.wav"}]
    >>> if find_spec("pandas"):
    ...     assert data_frame(["file", "level_db"], rows)["level_db"].mean() == 81.5
    """
    try:
        from pandas import DataFrame
    except ImportError:
        raise ParameterError(not_installed("a data frame needs", "pandas", "pandas")) from None
    return DataFrame([[row.get(column) for column in columns] for row in rows], columns=columns)
