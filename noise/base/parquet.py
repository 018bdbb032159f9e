"""Tables as Parquet files, written some thousand rows at a time."""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING, Any

from models.foreign_file import ExcessError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    Cell = bool | int | float | str | None

__all__ = ["finite", "read_parquet", "write_parquet"]

_FEW_CELLS, _MOST_CELLS = 1_000_000, 20
"""Cells that a Parquet file may hold: so many, and so many a byte."""

_CELLS_AT_ONCE = 1_000_000
"""Of a table that is written into a Parquet file, of which each part is a group of rows."""


def read_parquet(path: Path) -> tuple[list[str], list[dict[str, object]]]:
    """Read all rows and the columns' names, as `noise.base.tables.read_table` does."""
    from pyarrow import parquet

    with parquet.ParquetFile(path) as file:
        announced = file.metadata.num_rows * file.metadata.num_columns
        if announced > _FEW_CELLS + _MOST_CELLS * path.stat().st_size:
            raise ExcessError(f"announces {announced} cells, more than a file of its size holds")
        table = file.read()
    return list(table.column_names), table.to_pylist()


def write_parquet(path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write rows, of which an infinite number is none.

    Parameters
    ----------
    path : Path
    columns : sequence of str
    rows : iterable of sequence
        Gone through twice.
    """
    import pyarrow as pa
    from pyarrow import parquet

    def tables(schema: Any = None) -> Iterator[Any]:
        """Give the table in parts; at least one, empty or not."""
        coming, n_rows = iter(rows), max(1, _CELLS_AT_ONCE // max(1, len(columns)))
        part = list(islice(coming, n_rows))
        while True:
            arrays = {
                column: pa.array(
                    [finite(row[index]) for row in part],
                    None if schema is None else schema.field(index).type,
                )
                for index, column in enumerate(columns)
            }
            yield pa.table(arrays)
            part = list(islice(coming, n_rows))
            if not part:
                return

    # Which types columns have is known at the end: the first thousands of a column may be empty.
    schemas = [table.schema for table in tables()]
    schema = pa.unify_schemas(schemas, promote_options="permissive")
    with parquet.ParquetWriter(path, schema) as writer:
        for table in tables(schema):
            writer.write_table(table)


def finite(value: Cell) -> Cell:
    """Return a value as programs read it: an infinite number is none."""
    return None if isinstance(value, float) and math.isinf(value) else value
