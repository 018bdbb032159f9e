"""A file that gives no more than it has, however much is asked for.

Python sets aside what a `read` asks for before it looks. A damaged header that announces a text of
4 GB in a file of 8 kB therefore costs 4 GB, and a library that follows headers asks for it.
"""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["BoundedFile"]


class BoundedFile(io.BufferedReader):
    """A file opened for reading; a request beyond its end is cut to what there is.

    Parameters
    ----------
    path : Path

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "text").write_bytes(b"short")
    ...     with BoundedFile(Path(folder) / "text") as file:
    ...         file.read(1 << 60)
    b'short'
    """

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path, "rb"))
        self.size = os.fstat(self.fileno()).st_size

    def read(self, size: int | None = -1, /) -> bytes:
        """Up to `size` bytes, all that are left where it is negative."""
        left = max(0, self.size - self.tell())
        return super().read(left if size is None or size < 0 else min(size, left))
