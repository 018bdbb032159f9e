"""Rows of a recording in a table: a few as a list, many in a temporary file until they are written.

All long recordings of a process share the file, which has no name, so that nothing is left of it.
"""

from __future__ import annotations

import pickle
import threading
import weakref
from itertools import islice
from tempfile import TemporaryFile
from typing import IO, TYPE_CHECKING, Any, TypeAlias

from models.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    Cell = bool | int | float | str | None
    Rows: TypeAlias = "list[list[Cell]] | StoredRows"

__all__ = ["StoredRows", "part_count", "parts_of", "stored"]

_A_PART = 1000
"""Rows that are kept, written and sent together."""


def stored(rows: Iterable[list[Cell]]) -> Rows:
    """Take rows as they come; return them to be gone through as often as one likes.

    Raises
    ------
    RecordingError
        There is no room for them.

    Examples
    --------
    >>> stored([["run07.wav", 1.5]])
    [['run07.wav', 1.5]]
    >>> many = stored([f"run{i}.wav", 1.5] for i in range(2500))
    >>> len(many), next(iter(many)), [len(part) for part in parts_of(many)]
    (2500, ['run0.wav', 1.5], [1000, 1000, 500])
    """
    coming = iter(rows)
    first = list(islice(coming, _A_PART))
    part = list(islice(coming, _A_PART))
    if not part:
        return first
    kept = StoredRows()
    kept.add(first)
    while part:
        kept.add(part)
        part = list(islice(coming, _A_PART))
    return kept


def parts_of(rows: Rows) -> Iterator[list[list[Cell]]]:
    """Go through rows in lists of no more than are held at once; at least one, empty or not."""
    if isinstance(rows, StoredRows):
        yield from rows.parts()
    else:
        yield from (rows[first : first + _A_PART] for first in range(0, len(rows) or 1, _A_PART))


def part_count(rows: Rows) -> int:
    """Return how many lists `parts_of` gives."""
    return len(rows.places) if isinstance(rows, StoredRows) else max(1, -(-len(rows) // _A_PART))


class StoredRows:
    """Rows in a file, to be gone through; see `stored`."""

    def __init__(self) -> None:
        self.places: list[int] = []
        self._count = 0
        _file.enter(self)

    def add(self, part: list[list[Cell]]) -> None:
        """Put some more after the others."""
        self.places.append(_file.put(part))
        self._count += len(part)

    def parts(self) -> Iterator[list[list[Cell]]]:
        """Go through them as they were put."""
        for place in self.places:
            yield _file.get(place)

    def __iter__(self) -> Iterator[list[Cell]]:
        for part in self.parts():
            yield from part

    def __len__(self) -> int:
        return self._count

    def __reduce__(self) -> tuple[type, tuple[list[list[Cell]]]]:
        return list, (list(self),)  # to another process, as what they are


class _SharedFile:
    """The file of a process; emptied when nothing in it is wanted any more."""

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None
        self._users = 0
        self._lock = threading.RLock()  # rows may be let go wherever something is set aside

    def enter(self, user: StoredRows) -> None:
        with self._lock:
            self._users += 1
        weakref.finalize(user, self._leave).atexit = False

    def _leave(self) -> None:
        with self._lock:
            self._users -= 1
            if self._file is not None and not self._users:
                self._file.close()
                self._file = None

    def put(self, part: object) -> int:
        try:
            with self._lock:
                if self._file is None:
                    self._file = TemporaryFile()  # noqa: SIM115  # closed by who is last
                place = self._file.seek(0, 2)
                pickle.dump(part, self._file, protocol=5)
                self._file.flush()
                return place
        except OSError as error:
            reason = error.strerror or error
            raise RecordingError(f"a temporary file cannot be written ({reason})") from error

    def get(self, place: int) -> Any:
        with self._lock:
            assert self._file is not None
            self._file.seek(place)
            return pickle.load(self._file)


_file = _SharedFile()
