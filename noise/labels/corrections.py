"""What somebody has written into a label table stays in it when recordings are labelled again.

That is what was corrected, and what stands in columns of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from hashlib import blake2b
from pathlib import Path

from models.errors import ParameterError, RecordingError
from noise.base.files import locked
from noise.base.labels import LABELS
from noise.base.progress import readable
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
"""The track of what holds for all channels."""

_DECIMALS = 6
"""Of times that are told apart, as `label` writes them."""


def track(row: Row) -> str:
    """Return the track that a row is of; ``all`` where the table does not say.

    Examples
    --------
    >>> track({"channel": None}), track({"channel": "2"})
    ('all', '2')
    """
    return str(row.get("channel") or WHOLE)


def place(row: Row) -> Place:
    """Return track, start and end [s] of a row; all of the recording where the table has no times.

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
    """Return the time that two places have in common; below zero how far they are apart [s].

    Examples
    --------
    >>> common_time(("all", 0.0, 2.0), ("all", 1.5, 4.0)), common_time(place({}), ("all", 1.5, 4.0))
    (0.5, 2.5)
    """
    return min(one[2], other[2]) - max(one[1], other[1])


def version(rows: Sequence[Row]) -> str:
    """Return what is another where a segment, its label, or who gave it is another.

    A table that was written again with the same labels is the same by it.

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
    """Return new rows of a table, with those recordings as they were that somebody has corrected.

    Parameters
    ----------
    path : Path or None
        The label table that the rows are for; there need be none yet.
    rows : list of dict
        By `COLUMNS`.

    Returns
    -------
    list of dict
        Where some row of a recording's track is by a human in the table that is there, all rows of
        that track are those of that table: whoever moves a border changes both sides of it. So are
        labels of a table of one's own, which says of none that a classifier gave it. Tracks
        that the new rows do not have come last. What the table has in columns of its own stays with
        the stretch of time that it is beside.

    Raises
    ------
    ParameterError
        What is there cannot be read as a label table or has a row that cannot be used, so that it
        must not be written over.

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
    return rows if before is None else with_corrected_rows(before, rows)


def sign_corrections(path: Path, names: Iterable[str]) -> None:
    """Mark labels of a table as a human's that differ from those that the program wrote.

    Whoever corrects a table in a spreadsheet may leave `label_source` as it was. The journal of the
    table knows what was written. It is forgotten by a call with other options, so this is done
    before the journal is opened.

    Parameters
    ----------
    path : Path
        The label table; there need be none yet.
    names : iterable of str
        Recordings that are to be labelled.

    Raises
    ------
    ParameterError
        As of `with_corrections`: corrections could not be kept after all the work.
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
    """Read a table that must not be written over unread; None where there is none."""
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
    """Sign rows whose label alone was changed: same segment and probabilities, other label."""
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
    """Refuse corrections of recordings whose names were saved in letters that say others."""
    plain = {_ascii(name): name for name in known if not name.isascii()}
    for name in {str(row["file"]) for row in before if _is_by_a_person(row)} - known:
        if not name.isascii() and _ascii(name) in plain:
            raise ParameterError(
                f"{path}: has {name!r}, by which {plain[_ascii(name)]!r} may be meant, so that "
                "what was corrected would be lost: save it as UTF-8, or name another table"
            )


def _ascii(name: str) -> str:
    return name.encode("ascii", "ignore").decode()


def with_corrected_rows(
    before: Iterable[dict[str, object]], rows: Iterable[dict[str, object]]
) -> list[dict[str, object]]:
    """Return new rows, with those tracks as they were `before` that somebody has corrected.

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
        at = _track(row)  # what is said of all of a file is said of each track
        whole = at[0], WHOLE
        if at in corrected or whole in corrected:
            merged += retained.pop(at if at in corrected else whole, [])
        else:
            merged.append(row | _own(row, beside.get(at, []), own))
    return merged + [row for of_one in retained.values() for row in of_one]


def _track(row: Mapping[str, object]) -> tuple[object, object]:
    return readable(str(row.get("file"))), track(row)


def _is_by_a_person(row: Mapping[str, object]) -> bool:
    """Whether a person has named a row: it says so, or nothing of it is a classifier's."""
    if row.get("label_source") is not None or row.get("label") is None:
        return row.get("label_source") == HUMAN
    return all(row.get(f"p_{label}") is None for label in LABELS)


def _own(
    row: Mapping[str, object], before: list[dict[str, object]], own: tuple[str, ...]
) -> dict[str, object]:
    """Return the columns of its own that a table had for the time of a new row."""
    nearest = max(before, key=lambda one: common_time(place(one), place(row)), default={})
    return {name: nearest.get(name) for name in own}
