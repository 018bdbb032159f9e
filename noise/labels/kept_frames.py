"""Frames of a recording, of which only those about a change of label are looked at again.

Which they are is known at the end. Those of a long recording wait in a temporary file, that memory
does not grow with its length.
"""

from __future__ import annotations

from tempfile import SpooledTemporaryFile
from typing import TYPE_CHECKING

import numpy as np

from models.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KeptFrames"]

_IN_MEMORY = 8 << 20
"""What is kept without a file [byte]: a quarter of an hour."""


class KeptFrames:
    """Rows of one length that are put and had by their numbers.

    Examples
    --------
    >>> kept = KeptFrames()
    >>> kept.put(0, np.zeros((4, 2), dtype=np.float32))
    >>> kept.put(3, np.ones((2, 2), dtype=np.float32))
    >>> len(kept), kept[2:4].tolist()
    (5, [[0.0, 0.0], [1.0, 1.0]])
    """

    def __init__(self) -> None:
        self._file = SpooledTemporaryFile(max_size=_IN_MEMORY)  # noqa: SIM115  # goes with this
        self._columns = self._count = 0

    def __len__(self) -> int:
        return self._count

    def put(self, first: int, rows: NDArray[np.float32]) -> None:
        """Put rows from number `first` on, in place of those that are there.

        Parameters
        ----------
        first : int
            At most the number of rows.
        rows : ndarray of float32, shape (n, n_columns)
            As `features.windows.table.WindowTable` has them [unit of each column].

        Raises
        ------
        RecordingError
            There is no room for them.
        """
        self._columns = rows.shape[1]
        try:
            self._file.seek(4 * self._columns * first)
            self._file.write(np.ascontiguousarray(rows).tobytes())
        except OSError as error:
            reason = error.strerror or error
            raise RecordingError(f"a temporary file cannot be written ({reason})") from error
        self._count = first + len(rows)

    def __getitem__(self, part: slice) -> NDArray[np.float32]:
        first, last, _ = part.indices(self._count)
        self._file.seek(4 * self._columns * first)
        content = self._file.read(4 * self._columns * max(0, last - first))
        return np.frombuffer(content, dtype=np.float32).reshape(-1, self._columns)
