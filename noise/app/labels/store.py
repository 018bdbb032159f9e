"""Labels of all recordings, as they arrive and as they are corrected.

They are those of the table; what the classifier has done since stands in its journal until the
table is written. A correction is in the table before it is answered.
"""

from __future__ import annotations

from dataclasses import dataclass
from threading import RLock
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.app.labels.corrections import as_rows
from noise.app.labels.measured_rows import measured_rows
from noise.app.labels.summary import summary
from noise.app.labels.table_cache import TableCache
from noise.base.lock import locked
from noise.batch import JournalReader
from noise.labels.kept_corrections import with_corrected_rows
from noise.labels.labelling import COLUMNS, Labelling
from noise.labels.row_places import track, version
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from noise.app.labels.corrections import Correction
    from noise.batch import Done, Job

    Row = dict[str, object]

__all__ = ["Labels"]


@dataclass(frozen=True, eq=False)
class _Correction:
    """Rows of the tracks of a recording that a correction changed, before and after it."""

    index: int
    before: list[Row]
    after: list[Row]
    by: str


class Labels:
    """Rows of the label table by recording; may be used from several threads.

    Parameters
    ----------
    jobs : sequence of Job
        The recordings.
    table : Path
        Of their labels, there or to be made.
    work : Labelling
        What labels them.

    Raises
    ------
    RecordingError
        The table cannot be read.
    """

    def __init__(self, jobs: Sequence[Job], table: Path, work: Labelling) -> None:
        self._lock = RLock()
        self._jobs = jobs
        self._table = TableCache(table)
        self._rows: list[list[Row]] = [[] for _ in jobs]
        self._others: list[Row] = []
        self._summaries: list[dict[str, object] | None] = [None for _ in jobs]
        self._undo: list[_Correction] = []
        self._fresh: dict[int, list[Row]] = {}
        self._classified: dict[int, list[Row]] = {}
        self._read_table()
        self.follow(work)
        for index, rows in self._arrived().items():
            if not self._rows[index]:
                self._put(index, rows)

    @property
    def path(self) -> Path:
        """Of the table."""
        return self._table.path

    def follow(self, work: Labelling) -> None:
        """Take what comes from now on from the journal of this work."""
        with self._lock:
            self._journal = JournalReader(self._table.path, work)
            self._fresh = {}

    def refresh(self) -> None:
        """Take what others wrote: the classifier its journal, anybody the table."""
        with self._lock:
            if self._table.changed():
                self._read_table()
                for index, rows in self._fresh.items():
                    self._put(index, with_corrected_rows(self._rows[index], rows))
            for index, rows in self._arrived().items():
                self._fresh[index] = rows
                self._put(index, with_corrected_rows(self._rows[index], rows))

    def ended(self) -> None:
        """Take the table as it stands, now that what filled the journal has written it."""
        with self._lock:
            self.refresh()
            self._fresh = {}

    def summaries(self) -> list[dict[str, object]]:
        """Return what the list shows of each recording, see `noise.app.labels.summary`."""
        with self._lock:
            self.refresh()
            for job in self._jobs:
                if self._summaries[job.index] is None:
                    self._summaries[job.index] = summary(job.index, job.name, self._rows[job.index])
            return [shown for shown in self._summaries if shown is not None]

    def rows(self, index: int) -> list[Row]:
        """Return the rows of a recording."""
        with self._lock:
            self.refresh()
            return list(self._rows[index])

    def all_rows(self) -> list[list[Row]]:
        """Return the rows of all recordings, in order."""
        with self._lock:
            self.refresh()
            return list(self._rows)

    def correct(self, index: int, said: Sequence[Correction], of: str, by: str = "") -> list[Row]:
        """Put what a person says in place of a recording's segments, and write the table.

        Parameters
        ----------
        index : int
            Of the recording.
        said : sequence of Correction
        of : str
            `noise.labels.row_places.version` of the rows that the person saw.
        by : str
            The page that it was said on.

        Raises
        ------
        ParameterError
            There are other rows by now, which nobody who said this has seen, or the table cannot
            be written; then all is as it was.
        RecordingError
            Somebody else has made something of the table that is none.
        """
        job = self._jobs[index]
        before = self.rows(index)
        self._check_seen(index, of, before)
        measured = measured_rows(job, said, before)
        with self._lock, locked(self.path):
            self.refresh()
            before = self._rows[index]
            self._check_seen(index, of, before)
            after = as_rows(said, job.name, before, measured)
            self._write(index, after)
            changed = _changed_tracks(before, after)
            was, now = ([row for row in rows if track(row) in changed] for rows in (before, after))
            self._undo.append(_Correction(index, was, now, by))
            return after

    def undo(self, by: str = "") -> tuple[int, list[Row]]:
        """Put back what the last correction of a page replaced, and write the table.

        Raises
        ------
        ParameterError
            There is none, somebody has changed the same since, or the table cannot be written.
        """
        with self._lock, locked(self.path):
            last = next((one for one in reversed(self._undo) if one.by == by), None)
            if last is None:
                raise ParameterError("there is no correction to undo")
            self.refresh()
            rows = self._rows[last.index]
            tracks = {track(row) for row in (*last.before, *last.after)}
            if version([row for row in rows if track(row) in tracks]) != version(last.after):
                self._undo.remove(last)
                name = self._jobs[last.index].name
                raise ParameterError(f"{name}: what was corrected last has been changed since then")
            # What the classifier has found since then is better than nothing.
            found = self._classified.get(last.index, []) if not last.before else []
            back = last.before or [row for row in found if track(row) in tracks]
            rows = [*(row for row in rows if track(row) not in tracks), *back]
            self._write(last.index, sorted(rows, key=_order))
            self._undo.remove(last)
            return last.index, self._rows[last.index]

    def _check_seen(self, index: int, of: str, rows: Sequence[Row]) -> None:
        """Refuse what was said of other rows than these."""
        # Whoever names a recording before the classifier has does not depend on what that says.
        unseen = of == version(()) and all(row.get("label_source") != HUMAN for row in rows)
        if of != version(rows) and not unseen:
            raise ParameterError(
                f"{self._jobs[index].name}: its labels have been changed elsewhere since they were "
                "shown; look at them as they are now"
            )

    def _write(self, index: int, rows: list[Row]) -> None:
        before = self._rows[index]
        self._put(index, rows)
        try:
            self._table.write([*(row for of_one in self._rows for row in of_one), *self._others])
        except BaseException:
            self._put(index, before)
            raise

    def _put(self, index: int, rows: list[Row]) -> None:
        self._rows[index] = rows
        self._summaries[index] = None

    def _read_table(self) -> None:
        rows = self._table.read()
        found = _by_recording(rows, self._jobs, self.path)
        for job in self._jobs:
            of_one = [row | {"file": job.name} for row in found.pop(job.index, [])]
            if of_one != self._rows[job.index]:
                self._put(job.index, of_one)
        self._others = found.pop(None, [])

    def _arrived(self) -> Mapping[int, list[Row]]:
        news = {index: _rows(done) for index, done in self._journal.news(self._jobs).items()}
        self._classified |= news
        return news


def _changed_tracks(before: Sequence[Row], after: Sequence[Row]) -> set[str]:
    return {track(row) for row in before if row not in after} | {
        track(row) for row in after if row not in before
    }


def _order(row: Row) -> tuple[int, float]:
    """Sort rows of a recording as `label` writes them: by track, then by time."""
    number, start = track(row), row.get("start_s")
    return (
        int(number) if number.isascii() and number.isdecimal() else 0,
        start if isinstance(start, float) else 0.0,
    )


def _rows(done: Done) -> list[Row]:
    return [dict(zip(COLUMNS, row, strict=True)) for row in done.rows]


def _by_recording(
    rows: Sequence[Row], jobs: Sequence[Job], table: Path
) -> dict[int | None, list[Row]]:
    """Part rows by their recording's index; None has those of recordings that are not open.

    A file of the table is the recording of that name, else the one at that place beside the table,
    else the only one whose path ends so.
    """
    by_name = {job.name: job.index for job in jobs}
    by_path = {job.path.absolute().as_posix(): job.index for job in jobs}

    def find(file: str) -> int | None:
        if file in by_name:
            return by_name[file]
        beside = (table.absolute().parent / file).as_posix()
        if beside in by_path:
            return by_path[beside]
        alike = [index for path, index in by_path.items() if path.endswith(f"/{file}")]
        return alike[0] if len(alike) == 1 else None

    place = {file: find(file) for file in dict.fromkeys(str(row["file"]) for row in rows)}
    parted: dict[int | None, list[Row]] = {}
    for row in rows:
        parted.setdefault(place[str(row["file"])], []).append(row)
    return parted
