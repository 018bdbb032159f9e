"""Files as results are written: whole or not at all, by one process at a time, one a recording.

A batch that is killed half-way must not leave half a file that a later run, or another program,
takes for a result. So every output is written under another name beside its target, on the same
volume, and moved over it in one step of the file system. The passing name starts with a dot, which
folder walks leave out, and ends as the target does, because many writers choose their format by
that ending. A target that cannot be written is refused before the work whose result it is to hold.

A process that is killed while it writes cannot remove what it wrote; who writes into the folder a
day later does. A lock is freed by the system when a process ends, so none is left behind.
"""

from __future__ import annotations

import time
import uuid
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path, PurePosixPath

from models.errors import ParameterError

_FORGOTTEN = 86_400.0
"""Age of a file that nobody goes on writing [s]."""


@contextmanager
def atomic(target: str | Path) -> Iterator[Path]:
    """Give a temporary path to write to, which becomes `target` when the block ends well.

    Parameters
    ----------
    target : str or Path
        The file to write; parent folders are made, an older file is replaced. Of a link, what it
        leads to is replaced, and the link stays.

    Yields
    ------
    Path
        Where to write. On an error, or an interrupt, it is removed and `target` is left as it was.

    Raises
    ------
    ParameterError
        The file cannot be written there; every `OSError` of the block is taken to say so.

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
    place = _behind_links(target)
    temporary = place.parent / f".{uuid.uuid4().hex}.part{target.suffix}"
    try:
        if place.is_dir():
            raise ParameterError(f"{target}: is a folder; name a file to write")
        _refuse_device(place, target)
        place.parent.mkdir(parents=True, exist_ok=True)
        _tidy(place.parent)
        yield temporary
        temporary.replace(place)
    except OSError as error:
        reason = error.strerror or error
        raise ParameterError(f"{target}: cannot be written ({reason})") from error
    finally:
        with suppress(OSError):  # the folder cannot be used, as the error on its way says
            temporary.unlink(missing_ok=True)


def check_target(path: Path, option: str = "--out") -> None:
    """Refuse a file, or folder, that cannot be made because of what stands above it.

    Parameters
    ----------
    path : Path
    option : str
        Of the command line, that names it.

    Raises
    ------
    ParameterError
        The nearest folder above `path`, or above what it links to, is none or may not be written
        to; or `path` is a pipe, a device or a link in a circle.

    Examples
    --------
    >>> check_target(Path("new") / "folder" / "table.csv")
    """
    _refuse_device(path, f"{option} {path}")
    place = _behind_links(path, option)
    try:
        above = next(one for one in place.absolute().parents if one.exists() or one.is_symlink())
    except OSError as error:
        raise ParameterError(f"{option} {path}: cannot be written ({error.strerror})") from None
    if not above.is_dir():
        kind = "is a file, not a folder" if above.exists() else "links to nothing"
        raise ParameterError(f"{option} {path}: {above} {kind}")
    from tempfile import TemporaryFile

    try:
        with TemporaryFile(dir=above):  # what counts is not the permission but whether it works
            pass
    except OSError:
        raise ParameterError(f"{option} {path}: the folder {above} may not be written to") from None


def _refuse_device(place: Path, said: object) -> None:
    with suppress(OSError):  # what cannot be looked at is refused by who writes it
        if place.exists() and not (place.is_file() or place.is_dir()):
            raise ParameterError(f"{said}: is a pipe or a device; name a file to write")


def _behind_links(target: Path, option: str = "") -> Path:
    """Return the file that a link leads to, which need not be there yet."""
    if not target.is_symlink():
        return target
    try:
        return target.resolve()
    except (OSError, RuntimeError):
        said = f"{option} {target}".lstrip()
        raise ParameterError(f"{said}: is a link that leads nowhere") from None


@cache
def _tidy(folder: Path) -> None:
    """Remove what processes that were killed left in a folder."""
    with suppress(OSError):  # a folder that may be written to but not listed
        for path in folder.glob(f".{'[0-9a-f]' * 32}.part*"):  # as `atomic` names them
            if time.time() - path.stat().st_mtime > _FORGOTTEN:
                path.unlink()


@contextmanager
def locked(target: Path, *, wait: bool = True) -> Iterator[None]:
    """Keep others who take the same lock from a file until the block ends.

    Parameters
    ----------
    target : Path
        The file; it need not exist. The lock is a hidden file beside it, which goes with the lock.
    wait : bool
        Whether to wait for another who has it.

    Yields
    ------
    None

    Raises
    ------
    ParameterError
        Nothing can be written there, or another has the lock and is not waited for.

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
        with suppress(OSError):  # an open file cannot be removed on Windows
            path.unlink()  # while it is held; who waited for it makes another
        lock.release()


def export_paths(
    target: Path, files: Sequence[str], endings: Sequence[str], option: str
) -> dict[str, Path]:
    """Return where the file of each recording goes.

    Parameters
    ----------
    target : Path
        A folder, in which they lie as the recordings do in theirs; or a file of one of the endings,
        for one recording.
    files : sequence of str
        Recordings, as tables call them.
    endings : sequence of str
        That a file may have; in a folder, files have the first.
    option : str
        Of the command line, that names the target.

    Raises
    ------
    ParameterError
        Two recordings have the same name, or there are several for one file.

    Examples
    --------
    >>> from pathlib import Path
    >>> paths = export_paths(Path("tracks"), ["day1/run07.wav"], [".txt"], "--audacity")
    >>> paths["day1/run07.wav"].as_posix()
    'tracks/day1/run07.txt'
    """
    if target.suffix.lower() in endings:
        if len(set(files)) > 1:
            raise ParameterError(
                f"{option} {target}: is one file, but there are {len(set(files))} recordings; "
                "name a folder"
            )
        return dict.fromkeys(files, target)
    times = Counter(files)
    for file in files:
        if times[file] > 1:
            raise ParameterError(
                f"{option} {target}: two recordings are called {file}; name the folder that "
                "holds them both"
            )
        if PurePosixPath(file).is_absolute() or ".." in PurePosixPath(file).parts:
            raise ParameterError(f"{option} {target}: {file} lies outside of the folder named")
    # Recordings that differ in the ending alone keep it.
    short = [PurePosixPath(file).with_suffix(endings[0]) for file in files]
    alike = Counter(short)
    return {
        file: target / (name if alike[name] == 1 else f"{file}{endings[0]}")
        for file, name in zip(files, short, strict=True)
    }
