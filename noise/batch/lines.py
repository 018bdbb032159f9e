"""Results on disk line by line, each as soon as it is there, for a call that goes on after a kill.

They lie hidden beside what the call is to write. A line is one result, and is on the disk before
the next is begun; so a process may be killed at any moment, and what it leaves behind is whole
lines and at most one torn one, which is cut off. Each line ends with its checksum, so that what a
failing disk or a crash of the system garbled is no result. The first line says what decides the
results; where that is another, the file begins again.
"""

from __future__ import annotations

import json
import os
import zlib
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from models.errors import BushingNoiseError, ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from io import FileIO
    from pathlib import Path

__all__ = ["Lines", "Results", "header_of", "journal_path", "kept_results", "open_lines", "parsed"]

_FORMAT = 2


class Lines:
    """What is kept of a call; see `open_lines`."""

    def __init__(self, path: Path, file: FileIO) -> None:
        self._path = path
        self._file = file
        self.n_kept = 0

    def add(self, *entries: list[Any]) -> None:
        """Keep a result as JSON knows it, in a line or several; it is on the disk on return."""
        with _writing(self._path):
            for entry in entries:
                _write(self._file, _line(entry))
            os.fsync(self._file.fileno())
        self.n_kept += len(entries)


class Results:
    """Results by their keys, of earlier calls and of this one; see `kept_results`."""

    def __init__(self, found: dict[str, list[Any]], lines: Lines) -> None:
        self.found = found
        self._lines = lines

    def add(self, key: str, *values: object) -> None:
        """Keep a result as JSON knows it."""
        self._lines.add([key, *values])


def journal_path(target: Path) -> Path:
    """Where the results lie that are kept for a file, or folder, to be written.

    Examples
    --------
    >>> from pathlib import Path
    >>> journal_path(Path("runs") / "labels.csv").name
    '.labels.csv.journal'
    """
    return target.with_name(f".{target.name}.journal")


def header_of(identity: str) -> bytes:
    """Return the first line of what this decides."""
    return json.dumps([_FORMAT, identity]).encode() + b"\n"


@contextmanager
def open_lines(
    target: Path, identity: str, *, take: Callable[[list[Any]], None], fresh: bool = False
) -> Iterator[Lines]:
    """Open what is kept for a file to be written.

    Parameters
    ----------
    target : Path
        Parent folders are made.
    identity : str
        Digest of all that decides the results beside what their lines say.
    take : callable
        Is given each line that is kept of these, without those that are damaged.
    fresh : bool
        Whether to forget what is in it.

    Raises
    ------
    ParameterError
        It cannot be written, or another process is writing it.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with open_lines(Path(folder) / "t.csv", "a", take=print) as lines:
    ...         lines.add(["run07", 1.5, None])
    ...     with open_lines(Path(folder) / "t.csv", "a", take=print):
    ...         pass
    ['run07', 1.5, None]
    """
    path, header = journal_path(target), header_of(identity)
    with _writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        file = path.open("a+b", buffering=0)
    with file:
        _claim(file, target)
        lines = Lines(path, file)
        end = 0 if fresh else _read(path, header, take)
        if not end:
            with _writing(path):
                file.truncate(0)
                _write(file, header)
        else:  # what follows the last line break was torn off when the process was killed
            file.truncate(end)
        lines.n_kept = int(end > len(header))
        yield lines


@contextmanager
def kept_results(target: Path | None, identity: str) -> Iterator[Results | None]:
    """Keep results until the block ends well, or is refused, and has no more need of them.

    Parameters
    ----------
    target : Path, optional
        Without it nothing is kept.
    identity : str
        As for `open_lines`.
    """
    if target is None:
        yield None
        return
    found: dict[str, list[Any]] = {}
    done_with, made = False, not target.parent.exists()

    def take(line: list[Any]) -> None:
        found[str(line[0])] = line[1:]

    try:
        with open_lines(target, identity, take=take) as lines:
            try:
                yield Results(found, lines)
                done_with = True
            except BushingNoiseError as error:  # what is refused leaves nothing, a full disk does
                done_with = not isinstance(error.__context__, OSError)
                raise
            finally:
                done_with |= not lines.n_kept
    finally:
        if done_with:
            journal_path(target).unlink(missing_ok=True)
            if made:
                with suppress(OSError):  # there is something in it
                    target.parent.rmdir()


def parsed(line: bytes) -> list[Any]:
    """Return what a line holds; nothing where it is damaged or none."""
    entry, _, checksum = line.rstrip(b"\n").rpartition(b" ")
    if checksum != b"%08x" % zlib.crc32(entry):  # damaged: it is done again
        return []
    try:
        found = json.loads(entry)
    except (ValueError, RecursionError):  # no line of ours
        return []
    return found if isinstance(found, list) else []


def _read(path: Path, header: bytes, take: Callable[[list[Any]], None]) -> int:
    """Go through what is kept; return how far it is whole: nowhere if something else decides it."""
    with path.open("rb") as lines:
        if lines.readline() != header:
            return 0
        end = len(header)
        for line in lines:
            if not line.endswith(b"\n"):
                break
            end += len(line)
            if found := parsed(line):
                take(found)
        return end


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ParameterError(f"{path}: cannot be written ({error.strerror or error})") from None


def _write(file: FileIO, data: bytes) -> None:
    """Write all of it: of what a disk has no more room for, the system takes a part."""
    while data:
        data = data[file.write(data) :]


def _line(entry: list[Any]) -> bytes:
    content = json.dumps(entry).encode()
    return b"%s %08x\n" % (content, zlib.crc32(content))


def _claim(file: FileIO, target: Path) -> None:
    """Keep other processes from the journal, as far as the system knows of locks."""
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ParameterError(
            f"{target}: is being written by another process; wait for it"
        ) from None
    except OSError:  # a file system without locks
        return
