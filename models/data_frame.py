"""Tables as data frames of pandas, an optional extra: one column a name, one row a mapping."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ParameterError, not_installed

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from pandas import DataFrame

__all__ = ["data_frame"]


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
