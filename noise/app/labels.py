"""Labels of all recordings, as they arrive and as a person corrects them.

They are those of the table; what the classifier has done since stands in its journal until the
table is written. A correction is in the table before it is answered, and refused where the rows
that it was made of are others by now. Columns that are not of a label table, such as a remark of
one's own, stay in it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from threading import RLock

from models.errors import BushingNoiseError, ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.app.requests import number
from noise.base.files import locked
from noise.base.labels import LABELS
from noise.batch.journal import JournalReader
from noise.batch.work import Job, JobResult
from noise.labels.corrections import common_time, place, track, version, with_corrected_rows
from noise.labels.human_rows import human_rows
from noise.labels.labelling import Labelling
from noise.labels.summary import ASSUMED, labels_in, naming_row
from noise.labels.table import COLUMNS, CONDITIONS, HUMAN, LabelTable, read_label_table

Row = dict[str, object]


_MOST = 10_000
"""Segments of one recording that a request may bring."""

_LONGEST = 1e9
"""Nothing is recorded for longer [s]."""


@dataclass(frozen=True)
class Correction:
    """A segment as a person says it is.

    Parameters
    ----------
    start, end : float
        [s]
    label : str
        One of `noise.base.labels.LABELS`.
    channel : str
        ``all``, or a track counted from 1.
    confirmed : bool
        Whether it is by a person also where nothing of it is new.
    """

    start: float
    end: float
    label: str
    channel: str = "all"
    confirmed: bool = False


def read_corrections(rows: object) -> list[Correction]:
    """Check the segments of a request.

    Parameters
    ----------
    rows : list of dict
        `start_s`, `end_s`, `label`, `channel`, and `label_source` where a person stands for it.

    Raises
    ------
    ParameterError
        They are no segments of one recording.

    Examples
    --------
    >>> read_corrections([{"start_s": 0.0, "end_s": 2.0, "label": "creak", "channel": "all"}])
    [Correction(start=0.0, end=2.0, label='creak', channel='all', confirmed=False)]
    """
    if not isinstance(rows, list) or not 0 < len(rows) <= _MOST:
        raise ParameterError(f"rows: expected a list of 1 to {_MOST} segments")
    segments = sorted(
        map(_one, rows), key=lambda one: (one.channel != "all", one.channel, one.start)
    )
    for one, after in pairwise(segments):
        if one.channel == after.channel and after.start < one.end:
            raise ParameterError(
                f"segments overlap: {one.label} until {one.end:g} s, {after.label} from "
                f"{after.start:g} s"
            )
    return segments


def _one(row: object) -> Correction:
    if not isinstance(row, dict):
        raise ParameterError("rows: a segment is an object of start_s, end_s, label, channel")
    start, end = (
        round(float(number(row, key, -_LONGEST, _LONGEST)), 6) for key in ("start_s", "end_s")
    )
    if not 0.0 <= start < end:
        raise ParameterError(f"a segment from {start:g} to {end:g} s: must end after it starts")
    label, channel = row.get("label"), str(row.get("channel") or "all")
    if label not in LABELS:
        raise ParameterError(f"label {label!r}: must be one of {', '.join(LABELS)}")
    if channel != "all" and not (channel.isascii() and channel.isdecimal() and int(channel) > 0):
        raise ParameterError(f"channel {channel!r}: must be all, or a track counted from 1")
    return Correction(start, end, str(label), channel, row.get("label_source") == HUMAN)


def news(segments: Sequence[Correction], before: Sequence[Row]) -> list[Correction]:
    """Return those segments that no row was before."""
    there = {(*place(row), row["label"]) for row in before}
    return [one for one in segments if (one.channel, one.start, one.end, one.label) not in there]


def as_rows(
    segments: Sequence[Correction], name: str, before: Sequence[Row], measured: Sequence[Row] = ()
) -> list[Row]:
    """Return the rows of a recording after a correction.

    Parameters
    ----------
    segments : sequence of Correction
    name : str
        Of the recording in the table.
    before : sequence of dict
        Its rows until now.
    measured : sequence of dict
        Rows of the segments as they were measured, as far as they were.

    Returns
    -------
    list of dict
        A segment that is as it was keeps its row; one with another label keeps what was measured
        of it, but no probability; one with other borders what was logged of that it was cut from.
        What is left of a segment, with its label, is by whoever gave it.

    Examples
    --------
    >>> row = {"channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "none", "level_dba": 50.0}
    >>> new, = as_rows([Correction(0.0, 2.0, "creak")], "run07.wav", [row])
    >>> new["label"], new["level_dba"], new["label_source"]
    ('creak', 50.0, 'human')
    """
    there = {place(row): row for row in before if row["label"] is not None}
    numbers = {place(row): row for row in measured}
    rows = []
    for one in segments:
        at = (one.channel, one.start, one.end)
        old = there.get(at)
        # What no table gives an end to ends with the recording.
        if old is None and not one.confirmed:
            old = there.get((one.channel, one.start, math.inf))
        if old is not None and old["label"] == one.label:
            rows.append(old | ({"label_source": HUMAN} if one.confirmed else {}))
            continue
        row = row_of_piece(at, before) if old is None else without_opinion(old)
        row = with_measured(row, numbers.get(at, {}))
        row |= {"file": name, "channel": one.channel, "start_s": one.start, "end_s": one.end}
        source = HUMAN if one.confirmed else _source_of_rest(one, before)
        rows.append(row | {"label": one.label, "label_source": source, "error": None})
    return rows


def _source_of_rest(one: Correction, before: Sequence[Row]) -> object:
    """Return who named what is left of a segment that another was cut out of; else a person."""
    for row in before:
        channel, start, end = place(row)
        spans = channel == one.channel and start <= one.start and one.end <= end
        if spans and row["label"] == one.label:
            return row.get("label_source") or HUMAN
    return HUMAN


_OF_LABEL = (*(f"p_{label}" for label in LABELS), "frequency_hz")

_PARTS = ("", "_low", "_high", "_source")

_LEVELS = ("level_db", "level_dbfs")

NOT_MEASURED = "not measured since its borders were changed"
"""What a segment's note says where its sound could not be read, or was too long to be."""

_MAY_END = ("frequency_hz", "snr_dba")
"""What a segment may have no longer by its new label: a pitch, a background to stand out of."""

_OF_RECORDING = ("calibrated", "material", "material_source", "note")
"""What holds wherever a segment's borders are, as do conditions that were logged."""


def without_opinion(row: Row) -> Row:
    """Return a row without what hangs on its label: probabilities, frequency, inferred conditions.

    Examples
    --------
    >>> row = {"label": "creak", "level_db": 60.0, "speed_rad_s": 5.2, "p_creak": 0.9}
    >>> left = without_opinion(row | {"speed_rad_s_source": "inferred", "note": None})
    >>> left["level_db"], left["speed_rad_s"], left["speed_rad_s_source"], left["p_creak"]
    (60.0, None, 'missing', None)
    """
    left = row | dict.fromkeys(_OF_LABEL)
    for name in CONDITIONS:
        if row.get(f"{name}_source") == "inferred":
            left |= dict.fromkeys(f"{name}{part}" for part in _PARTS)
            left[f"{name}_source"] = "missing"
    left["note"] = _without(row.get("note"), ASSUMED)
    return left


def row_of_piece(at: tuple[str, float, float], before: Sequence[Row]) -> Row:
    """Return what is known of a new segment before it is measured.

    Parameters
    ----------
    at : tuple of (str, float, float)
        Its track, start and end [s].
    before : sequence of dict
        The recording's rows until now.

    Returns
    -------
    dict
        What was logged, and columns that are not of a label table, of the row that most of it was
        in; all else is None.

    Examples
    --------
    >>> row = {"channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "creak", "level_db": 60.0}
    >>> row |= {"interference_mm": 0.2, "interference_mm_source": "logged", "remark": "left door"}
    >>> piece = row_of_piece(("all", 0.0, 0.5), [row])
    >>> piece["interference_mm"], piece["remark"], piece["level_db"]
    (0.2, 'left door', None)
    """
    kin = [row for row in before if row["label"] is not None]
    if not kin:
        sources = (*(f"{name}_source" for name in CONDITIONS), "material_source")
        return dict.fromkeys(COLUMNS) | dict.fromkeys(sources, "missing")
    nearest = max(kin, key=lambda row: (track(row) == at[0], common_time(place(row), at)))
    left = without_opinion(nearest)
    retained = {*_OF_RECORDING, *(f"{name}{part}" for name in CONDITIONS for part in _PARTS)}
    piece = {
        name: None if name in COLUMNS and name not in retained else left[name] for name in left
    }
    note = _without(piece.get("note"), NOT_MEASURED)
    if any(nearest.get(name) is not None for name in _LEVELS):
        note = "; ".join(filter(None, (note, NOT_MEASURED)))
    return piece | {"note": note}


def with_measured(row: Row, measured: Row) -> Row:
    """Return a row with what was measured of it; what the table alone knows of it stays.

    Examples
    --------
    >>> known = {"speed_rad_s": 5.0, "speed_rad_s_source": "logged", "level_db": None}
    >>> found = {"speed_rad_s": None, "speed_rad_s_source": "missing", "level_db": 61.2}
    >>> with_measured(known, found)
    {'speed_rad_s': 5.0, 'speed_rad_s_source': 'logged', 'level_db': 61.2, 'note': None}
    """
    new = {
        name: value
        for name, value in measured.items()
        if value not in (None, "missing") or name in _MAY_END
    }
    for name in CONDITIONS:
        source = f"{name}_source"
        if row.get(source) == "logged" and new.get(source) != "logged":
            for part in _PARTS:
                new.pop(f"{name}{part}", None)
    if measured and "note" not in new:
        new["note"] = _without(row.get("note"), NOT_MEASURED)
    return row | new


def _without(note: object, ending: str) -> str | None:
    """Return a note without the remarks that end so; None where nothing is left."""
    remarks = str(note or "").split("; ")
    return "; ".join(one for one in remarks if not one.endswith(ending)) or None


def measured_rows(job: Job, segments: Sequence[Correction], before: Sequence[Row]) -> list[Row]:
    """Measure a recording's segments where some are new; none where it cannot be.

    Parameters
    ----------
    job : Job
        The recording.
    segments : sequence of Correction
        All its segments, as a person says they are.
    before : sequence of dict
        Its rows until now.
    """
    new = news(segments, before)
    if not new:
        return []
    drawn, changed = (
        [(one.channel, one.start, one.end, one.label) for one in some] for some in (segments, new)
    )
    try:
        measured = human_rows(job.path, job.name, drawn, new=changed)
        known = any(row.get("calibrated") is True for row in before)
        if known and not all(row["calibrated"] for row in measured):
            # `label` was told a calibration that the file does not have.
            scale = full_scale_of(before)
            measured = (
                [] if scale is None else human_rows(job.path, job.name, drawn, scale, changed)
            )
    except (BushingNoiseError, OSError):  # the correction counts without numbers, too
        return []
    if len(measured) == len(segments):
        return measured
    # Of a part of the segments nothing tells the background; it is as `label` has found it.
    over = _over_background(before)
    for row in measured:
        level, above = row["level_dba"], over.get(track(row))
        if row["snr_dba"] is None and isinstance(level, float) and above is not None:
            row["snr_dba"] = round(level - above, 2)
    return measured


def full_scale_of(rows: Sequence[Row]) -> float | tuple[float, ...] | None:
    """Return the sound pressure of a full-scale sample that rows were calibrated by [Pa].

    Parameters
    ----------
    rows : sequence of dict
        Of one recording.

    Returns
    -------
    float or tuple of float or None
        One for each track of several [Pa]; None where their levels do not tell it.

    Examples
    --------
    >>> round(full_scale_of([{"level_db": 91.0, "level_dbfs": -3.0}]), 4)
    1.0024
    >>> full_scale_of([{"level_db": None, "level_dbfs": -3.0}]) is None
    True
    """
    by_track: dict[str, float] = {}
    for row in rows:
        level, level_dbfs = row.get("level_db"), row.get("level_dbfs")
        if isinstance(level, float) and isinstance(level_dbfs, float):
            by_track[track(row)] = REFERENCE_PRESSURE * 10.0 ** ((level - level_dbfs) / 20.0)
    if set(by_track) == {"all"}:
        return by_track["all"]
    numbers = [str(number) for number in range(1, len(by_track) + 1)]
    known = by_track and set(by_track) == set(numbers)
    return tuple(by_track[number] for number in numbers) if known else None


def _over_background(rows: Sequence[Row]) -> dict[str, float]:
    """Return the level of the background of each track, as `label` has found it [dB(A)]."""
    backgrounds = {}
    for row in rows:
        level, snr = row.get("level_dba"), row.get("snr_dba")
        if isinstance(level, float) and isinstance(snr, float):
            backgrounds[track(row)] = level - snr
    return backgrounds


@dataclass(frozen=True, eq=False)
class _Correction:
    """Rows of the tracks of a recording that a change replaced, before and after it."""

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
        self.path = table
        self._table_state: tuple[int, ...] | None = None
        self._rows: list[list[Row]] = [[] for _ in jobs]
        self._others: list[Row] = []
        self._summaries: list[dict[str, object] | None] = [None for _ in jobs]
        self._undo: list[_Correction] = []
        self._redo: list[_Correction] = []
        self._fresh: dict[int, list[Row]] = {}
        self._classified: dict[int, list[Row]] = {}
        self._read_table()
        self.follow(work)
        for index, rows in self._arrived().items():
            if not self._rows[index]:
                self._put(index, rows)

    def follow(self, work: Labelling) -> None:
        """Take what comes from now on from the journal of this work."""
        with self._lock:
            self._journal = JournalReader(self.path, work)
            self._fresh = {}

    def refresh(self) -> None:
        """Take what others wrote: the classifier its journal, anybody the table."""
        with self._lock:
            if self._state() != self._table_state:
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
        """Return what the list shows of each recording, as of `summary`."""
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

    def correct(
        self, index: int, segments: Sequence[Correction], of: str, by: str = ""
    ) -> list[Row]:
        """Put corrections in place of a recording's segments, and write the table.

        Parameters
        ----------
        index : int
            Of the recording.
        segments : sequence of Correction
        of : str
            `noise.labels.corrections.version` of the rows that the person saw.
        by : str
            The page that the correction comes from.

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
            after = as_rows(segments, job.name, before, measured)
            self._write(index, after)
            changed = _changed_tracks(before, after)
            was, now = ([row for row in rows if track(row) in changed] for rows in (before, after))
            self._undo.append(_Correction(index, was, now, by))
            self._redo = [one for one in self._redo if one.by != by]
            return after

    def history(self, by: str) -> dict[str, bool]:
        """Return whether a page has a correction to undo, and one to redo."""
        with self._lock:
            lists = {"undo": self._undo, "redo": self._redo}
            return {name: any(one.by == by for one in done) for name, done in lists.items()}

    def undo(self, by: str = "", *, redo: bool = False) -> tuple[int, list[Row]]:
        """Put back what the last correction of a page replaced, and write the table.

        Parameters
        ----------
        by : str
            The page that the corrections come from.
        redo : bool
            Undo its last undo instead; there is none after a new correction.

        Raises
        ------
        ParameterError
            There is none, somebody has changed the same since, or the table cannot be written.
        """
        done, undone = (self._redo, self._undo) if redo else (self._undo, self._redo)
        with self._lock, locked(self.path):
            last = next((one for one in reversed(done) if one.by == by), None)
            if last is None:
                raise ParameterError(f"there is no correction to {'redo' if redo else 'undo'}")
            self.refresh()
            rows = self._rows[last.index]
            tracks = {track(row) for row in (*last.before, *last.after)}
            if version([row for row in rows if track(row) in tracks]) != version(last.after):
                done.remove(last)
                name = self._jobs[last.index].name
                raise ParameterError(f"{name}: what was corrected last has been changed since then")
            # What the classifier has found since then is better than nothing.
            classified = self._classified.get(last.index, []) if not last.before else []
            back = last.before or [row for row in classified if track(row) in tracks]
            rows = [*(row for row in rows if track(row) not in tracks), *back]
            self._write(last.index, sorted(rows, key=_order))
            done.remove(last)
            undone.append(_Correction(last.index, last.after, back, by))
            return last.index, self._rows[last.index]

    def _check_version(self, index: int, of: str, rows: Sequence[Row]) -> None:
        """Refuse corrections of other rows than these."""
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
            rows = [*(row for of_one in self._rows for row in of_one), *self._others]
            LabelTable(rows).write(self.path)
            self._table_state = self._state()
        except BaseException:
            self._put(index, before)
            raise

    def _put(self, index: int, rows: list[Row]) -> None:
        self._rows[index] = rows
        self._summaries[index] = None

    def _read_table(self) -> None:
        state = self._state()  # before: what is written meanwhile is read again
        rows = [] if state is None else read_label_table(self.path)
        self._table_state = state  # after: what could not be read is not taken for what was
        by_recording = _by_recording(rows, self._jobs, self.path)
        for job in self._jobs:
            of_one = [row | {"file": job.name} for row in by_recording.pop(job.index, [])]
            if of_one != self._rows[job.index]:
                self._put(job.index, of_one)
        self._others = by_recording.pop(None, [])

    def _state(self) -> tuple[int, ...] | None:
        """Tell one version of the table on disk from another; None where there is none."""
        try:
            status = self.path.stat()
        except OSError:
            return None
        return status.st_ino, status.st_size, status.st_mtime_ns

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


def _rows(done: JobResult) -> list[Row]:
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


def summary(index: int, name: str, rows: Sequence[Row]) -> dict[str, object]:
    """Return what the list shows of a recording.

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
    """Probability that a row's label is wrong, by the classifier [-]; 0 of a person's label."""
    p = row.get(f"p_{row.get('label')}")
    if row.get("label_source") == HUMAN or not isinstance(p, float):
        return 0.0
    return round(1.0 - p, 6)
