"""Results shown: one short line for ``print``, a data frame for a table."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeGuard, TypeVar

from models.errors import ParameterError, not_installed

if TYPE_CHECKING:
    import numpy as np
    from pandas import DataFrame

_Class = TypeVar("_Class", bound=type)

_LONGEST_TEXT = 60
"""Characters of a text that are shown."""

_MOST_SHOWN = 4
"""Values of a sequence that are shown one by one."""

_LONGEST = 400
"""Characters of the whole."""


def short_repr(cls: _Class) -> _Class:
    """Give a dataclass a representation that fits on a few lines, whatever it holds.

    Examples
    --------
    >>> import numpy as np
    >>> @short_repr
    ... @dataclasses.dataclass
    ... class Heard:
    ...     name: str
    ...     samples: np.ndarray
    >>> Heard("run07", np.zeros((2, 48000)))
    Heard(name='run07', samples=<2 x 48000 float64>)
    """

    def representation(self: object) -> str:
        shown = [
            f"{field.name}={short_words(getattr(self, field.name))}"
            for field in dataclasses.fields(cls)
            if field.repr
        ]
        whole = ", ".join(shown)
        if len(whole) > _LONGEST:
            whole = f"{whole[:_LONGEST]} ..."
        return f"{type(self).__name__}({whole})"

    cls.__repr__ = representation  # type: ignore[assignment]
    return cls


def short_words(value: object) -> str:
    """Return a value in a few words.

    Examples
    --------
    >>> import numpy as np
    >>> short_words(np.zeros(3)), short_words([1.0] * 9), short_words({"a": 1})
    ('<3 float64>', '<9 float>', "{'a': 1}")
    """
    if dataclasses.is_dataclass(value):
        return f"<{type(value).__name__}>"  # before anything is asked of it, which may take long
    if _is_array(value):
        shape = " x ".join(map(str, value.shape))
        return f"<{shape} {value.dtype}>" if shape else repr(value.item())
    if isinstance(value, str):
        return repr(value if len(value) <= _LONGEST_TEXT else f"{value[:_LONGEST_TEXT]} ...")
    if isinstance(value, Mapping):
        if len(value) > _MOST_SHOWN:
            return f"<{len(value)} entries>"
        return f"{{{', '.join(f'{key!r}: {short_words(one)}' for key, one in value.items())}}}"
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        if len(value) > _MOST_SHOWN:
            return f"<{len(value)} {type(value[0]).__name__}>"
        words = ", ".join(map(short_words, value))
        return f"[{words}]" if isinstance(value, list) else f"({words}{',' * (len(value) == 1)})"
    words = repr(value)
    return words if len(words) <= _LONGEST_TEXT else f"<{type(value).__name__}>"


def _is_array(value: object) -> TypeGuard[np.ndarray]:
    """Ask without loading numpy: a module that shows nothing starts without it."""
    return hasattr(value, "shape") and hasattr(value, "dtype") and hasattr(value, "item")


def data_frame(columns: Sequence[str], rows: Iterable[Mapping[str, object]]) -> DataFrame:
    """Return a table as a data frame.

    Parameters
    ----------
    columns : sequence of str
        All columns in their order; keys of a row that are not among them are left out.
    rows : iterable of mapping

    Returns
    -------
    pandas.DataFrame
        What is not there is NaN among numbers, and None elsewhere.

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
