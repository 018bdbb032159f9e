"""Label table of the app: results of the classifier and manual corrections.

A correction is written before the request is answered; it is refused if its rows have changed
meanwhile. A table that another program has written is read again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import RLock

from models.errors import ParameterError
from noise.app.corrected_segments import Correction, Row, as_rows, measured_rows
from noise.base.files import locked
from noise.batch.work import Job
from noise.labels.corrections import track, version
from noise.labels.summary import labels_in, naming_row
from noise.labels.table import HUMAN, LabelTable, read_label_table, table_recordings


@dataclass(frozen=True, eq=False)
class _Correction:
    """Rows of the changed tracks of a recording, before and after a correction."""

    index: int
    before: list[Row]
    after: list[Row]


class Labels:
    """Rows of the label table by recording, safe for several threads.

    Parameters
    ----------
    jobs : sequence of Job
        The recordings.
    table : Path
        Label table, which need not exist.

    Raises
    ------
    RecordingError
        The table cannot be read.
    """

    def __init__(self, jobs: Sequence[Job], table: Path) -> None:
        self._lock = RLock()
        self._jobs = jobs
        self.path = table
        self._table_state: tuple[int, ...] | None = None
        self._rows: list[list[Row]] = [[] for _ in jobs]
        self._others: list[Row] = []
        self._undo: list[_Correction] = []
        self._redo: list[_Correction] = []
        self._read_table()

    def foreign_file(self) -> str | None:
        """Return a file of the table if it names none of the recordings."""
        with self._lock:
            if not self._others or any(self._rows):
                return None
            return min(str(row["file"]) for row in self._others)

    def refresh(self) -> None:
        """Read the table if it has changed."""
        with self._lock:
            if self._state() != self._table_state:
                self._read_table()

    def summaries(self) -> list[dict[str, object]]:
        """Return the `summary` of each recording."""
        with self._lock:
            self.refresh()
            return [summary(job.index, job.name, self._rows[job.index]) for job in self._jobs]

    def rows(self, index: int) -> list[Row]:
        """Return the rows of a recording."""
        with self._lock:
            self.refresh()
            return list(self._rows[index])

    def correct(self, index: int, segments: Sequence[Correction], of: str) -> list[Row]:
        """Replace the segments of a recording, and write the table.

        Parameters
        ----------
        index : int
            Of the recording.
        segments : sequence of Correction
        of : str
            `noise.labels.corrections.version` of the rows that were shown.

        Raises
        ------
        ParameterError
            There are other rows by now than those that were corrected, or the table cannot be
            written; then all is as it was.
        RecordingError
            Somebody else has made something of the table that is none.
        """
        job = self._jobs[index]
        before = self.rows(index)
        self._check_version(index, of, before)
        measured = measured_rows(job, segments, before)
        with self._lock, locked(self.path):
            self.refresh()
            before = self._rows[index]
            self._check_version(index, of, before)
            name = str(before[0]["file"]) if before else job.name  # as in the table
            after = as_rows(segments, name, before, measured)
            self._write(index, after)
            changed = _changed_tracks(before, after)
            was, now = ([row for row in rows if track(row) in changed] for rows in (before, after))
            self._undo.append(_Correction(index, was, now))
            self._redo.clear()
            return after

    @property
    def history(self) -> dict[str, bool]:
        """Whether undo and redo are possible."""
        return {"undo": bool(self._undo), "redo": bool(self._redo)}

    def undo(self, *, redo: bool = False) -> tuple[int, list[Row]]:
        """Undo the last correction, and write the table.

        Parameters
        ----------
        redo : bool
            Whether to redo the last undo instead.

        Raises
        ------
        ParameterError
            There is none, somebody has changed the same since, or the table cannot be written.
        """
        done, undone = (self._redo, self._undo) if redo else (self._undo, self._redo)
        with self._lock, locked(self.path):
            if not done:
                raise ParameterError(f"there is no correction to {'redo' if redo else 'undo'}")
            last = done[-1]
            self.refresh()
            rows = self._rows[last.index]
            tracks = {track(row) for row in (*last.before, *last.after)}
            if version([row for row in rows if track(row) in tracks]) != version(last.after):
                done.pop()
                name = self._jobs[last.index].name
                raise ParameterError(f"{name}: what was corrected last has been changed since then")
            rows = [*(row for row in rows if track(row) not in tracks), *last.before]
            self._write(last.index, sorted(rows, key=_order))
            undone.append(_Correction(last.index, last.after, last.before))
            done.pop()
            return last.index, self._rows[last.index]

    def _check_version(self, index: int, of: str, rows: Sequence[Row]) -> None:
        """Refuse a correction if the rows have changed."""
        # Whoever names a recording before the classifier has does not depend on what that says.
        unseen = of == version(()) and all(row.get("label_source") != HUMAN for row in rows)
        if of != version(rows) and not unseen:
            raise ParameterError(
                f"{self._jobs[index].name}: its labels have been changed elsewhere since they were "
                "shown; look at them as they are now"
            )

    def _write(self, index: int, rows: list[Row]) -> None:
        before = self._rows[index]
        self._rows[index] = rows
        try:
            rows = [*(row for of_one in self._rows for row in of_one), *self._others]
            LabelTable(rows).write(self.path)
            self._table_state = self._state()
        except BaseException:
            self._rows[index] = before
            raise

    def _read_table(self) -> None:
        state = self._state()  # before: what is written meanwhile is read again
        rows = [] if state is None else read_label_table(self.path)
        self._table_state = state  # after: what could not be read is not taken for what was
        paths, names = [job.path for job in self._jobs], [job.name for job in self._jobs]
        files = (str(row["file"]) for row in rows)
        path_of = table_recordings(files, self.path, paths, names)
        by_path: dict[Path | None, list[Row]] = {}
        for row in rows:
            by_path.setdefault(path_of[str(row["file"])], []).append(row)
        self._rows = [by_path.pop(job.path, []) for job in self._jobs]
        self._others = by_path.pop(None, [])

    def _state(self) -> tuple[int, ...] | None:
        """Return the file state of the table; None if it does not exist."""
        try:
            status = self.path.stat()
        except OSError:
            return None
        return status.st_ino, status.st_size, status.st_mtime_ns


def _changed_tracks(before: Sequence[Row], after: Sequence[Row]) -> set[str]:
    return {track(row) for row in before if row not in after} | {
        track(row) for row in after if row not in before
    }


def _order(row: Row) -> tuple[int, float]:
    """Return the sort key of a row: track, then time."""
    number, start = track(row), row.get("start_s")
    return (
        int(number) if number.isascii() and number.isdecimal() else 0,
        start if isinstance(start, float) else 0.0,
    )


def summary(index: int, name: str, rows: Sequence[Row]) -> dict[str, object]:
    """Return the entry of a recording in the list.

    Examples
    --------
    >>> row = {"label": "creak", "start_s": 0.0, "end_s": 2.0, "label_source": "human"}
    >>> shown = summary(7, "run07.wav", [row])
    >>> shown["id"], shown["label"], shown["labels"], shown["duration_s"], shown["corrected"]
    (7, 'creak', ('creak',), 2.0, True)
    """
    naming = naming_row(rows) or {}
    ends = [end for row in rows if isinstance(end := row.get("end_s"), float)]
    by_person = [row.get("label_source") == HUMAN for row in rows if row.get("label")]
    return {
        "id": index,
        "name": name,
        "label": naming.get("label"),
        "labels": labels_in(rows),
        "frequency_hz": naming.get("frequency_hz"),
        "level_dba": naming.get("level_dba"),
        "duration_s": max(ends, default=None),
        "least_sure": max(map(_doubt, rows), default=None),
        "corrected": any(by_person) and all(by_person),
        "partly": any(by_person) and not all(by_person),
        "error": next((row["error"] for row in rows if row.get("error")), None),
    }


def _doubt(row: Row) -> float:
    """Probability that a label is wrong [-]; 0 for labels by a person."""
    p = row.get(f"p_{row.get('label')}")
    if row.get("label_source") == HUMAN or not isinstance(p, float):
        return 0.0
    return round(1.0 - p, 6)
