"""A lock on a file that several programs read, change and write again.

Who holds it knows that nobody else who takes it writes in between. The system frees it when a
process ends, however it ends, so none is left behind.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from io import FileIO
    from pathlib import Path

__all__ = ["locked"]


@contextmanager
def locked(target: Path) -> Iterator[None]:
    """Keep others who take the same lock from a file until the block ends; wait for them.

    Parameters
    ----------
    target : Path
        The file; it need not exist. The lock is a hidden file beside it, which goes with the lock.

    Yields
    ------
    None

    Raises
    ------
    ParameterError
        Nothing can be written there.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with locked(Path(folder) / "labels.csv"):
    ...         there = [path.name for path in Path(folder).iterdir()]
    ...     there, list(Path(folder).iterdir())
    (['.labels.csv.lock'], [])
    """
    path = target.with_name(f".{target.name}.lock")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = _held(path)
    except OSError as error:
        raise ParameterError(f"{target}: cannot be written ({error.strerror or error})") from None
    with file:
        try:
            yield
        finally:
            _free(path)


def _held(path: Path) -> FileIO:
    """Open and lock the file that stands there once the lock is held."""
    while True:
        file = path.open("a+b", buffering=0)
        _claim(file)
        # Who held it before may have removed the file while this process waited for it.
        try:
            if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                return file
        except FileNotFoundError:
            pass
        file.close()


def _claim(file: FileIO) -> None:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)  # type: ignore[attr-defined]
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX)
    except OSError:  # a file system without locks
        return


def _free(path: Path) -> None:
    """Remove the file while it is held; where an open file cannot be removed, it stays."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return
