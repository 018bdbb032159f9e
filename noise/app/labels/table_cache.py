"""The label table on disk: read again where somebody else has written it, written whole.

Columns that are not of a label table, such as a remark of one's own, stay in it, and CSV for Excel
stays CSV for Excel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.labels.table import LabelTable, read_label_table

if TYPE_CHECKING:
    from pathlib import Path

    Row = dict[str, object]

__all__ = ["TableCache"]


class TableCache:
    """A label table that several programs may write.

    Parameters
    ----------
    path : Path
        There, or to be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._seen: tuple[int, ...] | None = None

    def changed(self) -> bool:
        """Whether it is another than was last read or written."""
        return self._state() != self._seen

    def read(self) -> list[Row]:
        """Return its rows; none where there is no table.

        Raises
        ------
        RecordingError
            It is no label table, or has a row that cannot be used.
        """
        state = self._state()  # before: what is written meanwhile is read again
        rows = [] if state is None else read_label_table(self.path)
        self._seen = state  # after: what could not be read is not taken for what was
        return rows

    def write(self, rows: list[Row]) -> None:
        """Write it, whole or not at all.

        Raises
        ------
        ParameterError
            It cannot be written.
        """
        LabelTable(rows).write(self.path)
        self._seen = self._state()

    def _state(self) -> tuple[int, ...] | None:
        try:
            found = self.path.stat()
        except OSError:
            return None
        return found.st_ino, found.st_size, found.st_mtime_ns
