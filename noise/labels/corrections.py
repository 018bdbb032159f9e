"""Corrections of a label table, which stay when recordings are labelled again.

Rows labelled by a person and additional columns are preserved.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from hashlib import blake2b
from pathlib import Path

from models.errors import ParameterError, RecordingError
from noise.base.files import locked
from noise.base.labels import LABELS
from noise.base.progress import note, readable
from noise.batch.journal import written_rows
from noise.labels.table import (
    CLASSIFIER,
    COLUMNS,
    HUMAN,
    LabelTable,
    own_columns,
    read_label_table,
)

Row = Mapping[str, object]
Place = tuple[str, float, float]


WHOLE = "all"
"""Track of a row that holds for all channels."""

_DECIMALS = 6
"""Decimals of times, as `label` writes them."""


_SAME_END = 0.02
"""Largest difference between the ends of a correction and of its recording [s]; assumed."""


def track(row: Row) -> str:
    """Return the track of a row; ``all`` without a channel.

    Examples
    --------
    >>> track({"channel": None}), track({"channel": "2"})
    ('all', '2')
    """
    return str(row.get("channel") or WHOLE)


def place(row: Row) -> Place:
    """Return track, start and end [s] of a row; the whole recording without times.

    Examples
    --------
    >>> place({"channel": "2", "start_s": 0.5, "end_s": 2.0}), place({})
    (('2', 0.5, 2.0), ('all', 0.0, inf))
    """
    start, end = row.get("start_s"), row.get("end_s")
    return (
        track(row),
        round(start, _DECIMALS) if isinstance(start, float) else 0.0,
        round(end, _DECIMALS) if isinstance(end, float) else math.inf,
    )


def common_time(one: Place, other: Place) -> float:
    """Return the overlap of two places in time [s]; negative if they are apart.

    Examples
    --------
    >>> common_time(("all", 0.0, 2.0), ("all", 1.5, 4.0)), common_time(place({}), ("all", 1.5, 4.0))
    (0.5, 2.5)
    """
    return min(one[2], other[2]) - max(one[1], other[1])


def version(rows: Sequence[Row]) -> str:
    """Return a hash of the segments of rows, their labels and the sources of the labels.

    Examples
    --------
    >>> row = {"start_s": 0.0, "end_s": 2.0, "label": "none", "label_source": "classifier"}
    >>> version([row]) == version([row | {"p_none": 0.9}])
    True
    >>> version([row]) == version([row | {"label": "creak"}])
    False
    """
    identities = sorted(repr((*place(row), row["label"], row.get("label_source"))) for row in rows)
    return blake2b("\n".join(identities).encode(), digest_size=8).hexdigest()


def with_corrections(path: Path | None, rows: list[dict[str, object]]) -> list[dict[str, object]]:
    """Return new rows of a label table, merged with the corrections of the present table.

    Parameters
    ----------
    path : Path or None
        Label table to be replaced; it need not exist.
    rows : list of dict
        By `COLUMNS`.

    Returns
    -------
    list of dict
        If a row of a track has a label by a person in the present table, all rows of the track are
        taken from that table, because a moved border changes both segments. Rows without any
        column of a classifier count as a person's. Tracks without new rows come last. Values of
        additional columns stay with the segment that they overlap most.

    Raises
    ------
    ParameterError
        The present table cannot be read as a label table or has an invalid row, so it is not
        replaced.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.labels.table import LabelTable
    >>> row = {"file": "run07.wav", "channel": "all", "label": "squeal", "label_source": "human"}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     LabelTable([row]).write(Path(folder) / "labels.csv")
    ...     new = [row | {"label": "creak", "label_source": "classifier"}]
    ...     with_corrections(Path(folder) / "labels.csv", new)[0]["label"]
    'squeal'
    """
    if path is None:
        return rows
    before = _corrected_table(path, (str(row.get("file")) for row in rows))
    if before is None:
        return rows
    _note_other_recordings(path, before, rows)
    return with_corrected_rows(before, rows)


def sign_corrections(path: Path, names: Iterable[str]) -> None:
    """Mark labels that differ from those written by the program as labels by a person.

    A person who edits a table in a spreadsheet may leave `label_source` unchanged. The journal of
    the table stores the written rows until a call with other options, so this is done before the
    journal is opened.

    Parameters
    ----------
    path : Path
        Label table; it need not exist.
    names : iterable of str
        Names of the recordings to be labelled.

    Raises
    ------
    ParameterError
        As in `with_corrections`, before the work is done.
    """
    if not path.exists():
        return
    with locked(path):
        before = _corrected_table(path, names) or []
        written = [dict(zip(COLUMNS, row, strict=False)) for row in written_rows(path)]
        signed = _signed(before, written)
        if signed != before:
            LabelTable(signed).write(path)


def _corrected_table(path: Path, names: Iterable[str]) -> list[dict[str, object]] | None:
    """Read the present label table; return None if there is none."""
    if not path.exists() or not path.stat().st_size:
        return None
    known = {readable(name) for name in names}
    try:
        before = read_label_table(path)
    except RecordingError as error:
        raise ParameterError(
            f"{error}; what was corrected in it would be lost: mend it, move it away, or name "
            "another table"
        ) from None
    _check_names(path, before, known)
    return before


def _signed(
    before: Iterable[dict[str, object]], rows: Iterable[dict[str, object]]
) -> list[dict[str, object]]:
    """Mark rows in which only the label was changed as labelled by a person."""
    new = {(readable(str(row.get("file"))), place(row)): row for row in rows}

    def changed(row: dict[str, object]) -> bool:
        now = new.get((readable(str(row.get("file"))), place(row)))
        if now is None or row.get("label_source") != CLASSIFIER or not row.get("label"):
            return False
        return row["label"] != now["label"] and all(
            isinstance(row.get(name), float) and row.get(name) == now.get(name)
            for name in (f"p_{label}" for label in LABELS)
        )

    return [row | {"label_source": HUMAN} if changed(row) else row for row in before]


def _check_names(path: Path, before: Iterable[dict[str, object]], known: set[str]) -> None:
    """Refuse corrections of recordings whose names were garbled by another encoding."""
    plain = {_ascii(name): name for name in known if not name.isascii()}
    for name in {str(row["file"]) for row in before if _is_by_a_person(row)} - known:
        if not name.isascii() and _ascii(name) in plain:
            raise ParameterError(
                f"{path}: has {name!r}, by which {plain[_ascii(name)]!r} may be meant, so that "
                "what was corrected would be lost: save it as UTF-8, or name another table"
            )


def _note_other_recordings(
    path: Path, before: Iterable[dict[str, object]], rows: Iterable[Row]
) -> None:
    """Note corrections that end after the recording, which may be another one of that name."""
    durations = _ends(rows)
    for name, last in _ends(filter(_is_by_a_person, before)).items():
        duration = durations.get(name, math.inf)
        if math.inf > last > duration + _SAME_END:
            note(
                f"{path}: the correction of {name} ends at {last:.2f} s, the recording at "
                f"{duration:.2f} s; if it is another recording of that name, name another table"
            )


def _ends(rows: Iterable[Row]) -> dict[str, float]:
    """Return the largest end of the rows of each file [s]; infinite for a row without times."""
    ends: dict[str, float] = {}
    for row in rows:
        name = readable(str(row.get("file")))
        ends[name] = max(ends.get(name, 0.0), place(row)[2])
    return ends


def _ascii(name: str) -> str:
    return name.encode("ascii", "ignore").decode()


def with_corrected_rows(
    before: Iterable[dict[str, object]], rows: Iterable[dict[str, object]]
) -> list[dict[str, object]]:
    """Return new rows, in which corrected tracks are replaced by the rows `before`.

    Parameters
    ----------
    before, rows : iterable of dict
        By `COLUMNS`.

    Returns
    -------
    list of dict
        As `with_corrections` does.

    Examples
    --------
    >>> row = {"file": "run07.wav", "channel": "all", "label": "squeal", "label_source": "human"}
    >>> with_corrected_rows([row], [row | {"label": "creak"}])[0]["label"]
    'squeal'
    """
    before = list(before)
    own = own_columns(before)
    corrected = {_track(row) for row in before if _is_by_a_person(row)}
    beside: dict[tuple[object, object], list[dict[str, object]]] = {}
    for row in before if own else ():
        beside.setdefault(_track(row), []).append(row)
    retained: dict[tuple[object, object], list[dict[str, object]]] = {}
    for row in before:
        if _track(row) in corrected:
            retained.setdefault(_track(row), []).append(row)
    merged: list[dict[str, object]] = []
    for row in rows:
        at = _track(row)  # a correction of the whole file holds for each track
        whole = at[0], WHOLE
        if at in corrected or whole in corrected:
            merged += retained.pop(at if at in corrected else whole, [])
        else:
            merged.append(row | _own(row, beside.get(at, []), own))
    return merged + [row for of_one in retained.values() for row in of_one]


def _track(row: Mapping[str, object]) -> tuple[object, object]:
    return readable(str(row.get("file"))), track(row)


def _is_by_a_person(row: Mapping[str, object]) -> bool:
    """Whether a person labelled a row: by its source, or because it has no probabilities."""
    if row.get("label_source") is not None or row.get("label") is None:
        return row.get("label_source") == HUMAN
    return all(row.get(f"p_{label}") is None for label in LABELS)


def _own(
    row: Mapping[str, object], before: list[dict[str, object]], own: tuple[str, ...]
) -> dict[str, object]:
    """Return the additional columns of the present row that overlaps a new row most."""
    nearest = max(before, key=lambda one: common_time(place(one), place(row)), default={})
    return {name: nearest.get(name) for name in own}
