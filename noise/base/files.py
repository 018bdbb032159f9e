"""Atomic file output, file locks, checks of output paths, and output names per recording.

A killed batch must not leave half a file that a later run, or another program, takes for a result.
So every output is written to a temporary file in the same folder and then renamed. The temporary
name starts with a dot, which folder searches skip, and has the suffix of the target, because many
writers choose their format by it. A target that cannot be written is refused before the work.

The operating system releases locks when a process ends.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from models.errors import ParameterError


@contextmanager
def atomic(target: str | Path) -> Iterator[Path]:
    """Write a file atomically: yield a temporary path and rename it to `target` on success.

    Parameters
    ----------
    target : str or Path
        File to write; parent folders are made and an existing file is replaced. A symbolic link
        is kept and the file that it points to is replaced.

    Yields
    ------
    Path
        Temporary path. After an exception it is removed and `target` is unchanged.

    Raises
    ------
    ParameterError
        The file cannot be written; also for every `OSError` inside the block.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with atomic(Path(folder) / "new" / "table.csv") as path:
    ...         _ = path.write_text("speed_rad_s")
    ...     (Path(folder) / "new" / "table.csv").read_text()
    'speed_rad_s'
    """
    target = Path(target)
    place = _place(target, target)
    temporary = place.parent / f".{uuid.uuid4().hex}.part{target.suffix}"
    try:
        if place.is_dir():
            raise ParameterError(f"{target}: is a folder; name a file to write")
        place.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(place)
    except OSError as error:
        reason = error.strerror or error
        raise ParameterError(f"{target}: cannot be written ({reason})") from error
    finally:
        with suppress(OSError):  # the original error is already on its way
            temporary.unlink(missing_ok=True)


def check_target(path: Path | None, option: str = "--out") -> None:
    """Refuse an output path that cannot be created.

    Parameters
    ----------
    path : Path or None
        File or folder to create; None is no output.
    option : str
        Command-line option that names it, for messages.

    Raises
    ------
    ParameterError
        The nearest existing parent of `path` (links resolved) is no folder or is not writable; or
        `path` is a pipe, a device or a circular link.

    Examples
    --------
    >>> check_target(Path("new") / "folder" / "table.csv")
    """
    if path is None:
        return
    place = _place(path, f"{option} {path}")
    try:
        parent = next(one for one in place.absolute().parents if one.exists() or one.is_symlink())
    except OSError as error:
        raise ParameterError(f"{option} {path}: cannot be written ({error.strerror})") from None
    if not parent.is_dir():
        kind = "is a file, not a folder" if parent.exists() else "links to nothing"
        raise ParameterError(f"{option} {path}: {parent} {kind}")
    from tempfile import TemporaryFile

    try:
        with TemporaryFile(dir=parent):  # permissions alone do not tell, as on network drives
            pass
    except OSError:
        raise ParameterError(
            f"{option} {path}: the folder {parent} may not be written to"
        ) from None


def _place(target: Path, where: object) -> Path:
    """Return the path behind a symbolic link; refuse a circular link, a pipe and a device."""
    try:
        place = target.resolve() if target.is_symlink() else target
    except (OSError, RuntimeError):
        raise ParameterError(f"{where}: is a link that leads nowhere") from None
    with suppress(OSError):  # writing will raise the same error
        if place.exists() and not (place.is_file() or place.is_dir()):
            raise ParameterError(f"{where}: is a pipe or a device; name a file to write")
    return place


@contextmanager
def locked(target: Path, *, wait: bool = True) -> Iterator[None]:
    """Hold an exclusive lock on a file inside the block.

    Parameters
    ----------
    target : Path
        File to lock; it need not exist. The lock is a temporary hidden file beside it.
    wait : bool
        Whether to wait while another process holds the lock.

    Yields
    ------
    None

    Raises
    ------
    ParameterError
        The folder is not writable, or another process holds the lock and `wait` is False.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with locked(Path(folder) / "labels.csv"):
    ...         names = [path.name for path in Path(folder).iterdir()]
    ...     names, list(Path(folder).iterdir())
    (['.labels.csv.lock'], [])
    """
    from filelock import FileLock, Timeout

    path = target.with_name(f".{target.name}.lock")
    lock = FileLock(path, timeout=-1 if wait else 0)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout:
        raise ParameterError(
            f"{target}: is being written by another process; wait for it"
        ) from None
    except OSError as error:
        raise ParameterError(f"{target}: cannot be written ({error.strerror or error})") from None
    try:
        yield
    finally:
        with suppress(OSError):  # Windows does not remove open files
            path.unlink()  # before the release: a waiting process makes its own file
        lock.release()
