"""Manual corrections of segments: parsing of requests, and the resulting rows of the label table.

Unchanged segments keep their rows; new segments are measured again if the sound can be read.
Columns of the user, such as remarks, stay with the row.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from models.errors import BushingNoiseError, ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.app.requests import number
from noise.base.labels import LABELS
from noise.batch.work import Job
from noise.labels.corrections import common_time, place, track
from noise.labels.rows import human_rows
from noise.labels.summary import ASSUMED
from noise.labels.table import COLUMNS, CONDITIONS, HUMAN

Row = dict[str, object]

_MOST = 10_000
"""Maximum number of segments in a request."""

_LONGEST = 1e9
"""Maximum duration of a recording [s]."""


@dataclass(frozen=True)
class Correction:
    """Segment with a label set by a person.

    Parameters
    ----------
    start, end : float
        [s]
    label : str
        One of `noise.base.labels.LABELS`.
    channel : str
        ``all``, or a track counted from 1.
    confirmed : bool
        Whether the person confirmed it, even if nothing changed.
    """

    start: float
    end: float
    label: str
    channel: str = "all"
    confirmed: bool = False


def read_corrections(rows: object) -> list[Correction]:
    """Parse and check the segments of a request.

    Parameters
    ----------
    rows : list of dict
        `start_s`, `end_s`, `label`, `channel`, and `label_source` where a person stands for it.

    Raises
    ------
    ParameterError
        The rows are not valid segments of one recording.

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
        Its rows before the correction.
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
    """Return the label source of the rest of a segment that another was cut out of; else human."""
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
"""Note of a segment whose sound could not be read, or was too long."""

_MAY_END = ("frequency_hz", "snr_dba")
"""Columns that may become empty with a new label."""

_OF_RECORDING = ("calibrated", "material", "material_source", "note")
"""Columns that do not depend on the borders of a segment."""


def without_opinion(row: Row) -> Row:
    """Return a row without values that depend on its label, such as probabilities.

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
    """Return the row of a new segment before measurement.

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
    """Return a row updated with measured values; logged values of the table have priority.

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
    """Return a note without the remarks that have a given ending; None if nothing is left."""
    remarks = str(note or "").split("; ")
    return "; ".join(one for one in remarks if not one.endswith(ending)) or None


def measured_rows(job: Job, segments: Sequence[Correction], before: Sequence[Row]) -> list[Row]:
    """Measure the segments of a recording if some are new; return no rows on failure.

    Parameters
    ----------
    job : Job
        The recording.
    segments : sequence of Correction
        All its segments after the correction.
    before : sequence of dict
        Its rows before the correction.
    """
    there = {(*place(row), row["label"]) for row in before}
    new = [one for one in segments if (one.channel, one.start, one.end, one.label) not in there]
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
    return measured


def full_scale_of(rows: Sequence[Row]) -> float | None:
    """Return the full-scale sound pressure [Pa] implied by the levels of rows.

    Parameters
    ----------
    rows : sequence of dict
        Of one recording.

    Returns
    -------
    float or None
        [Pa]; None if the levels do not determine it.

    Examples
    --------
    >>> round(full_scale_of([{"level_db": 91.0, "level_dbfs": -3.0}]), 4)
    1.0024
    >>> full_scale_of([{"level_db": None, "level_dbfs": -3.0}]) is None
    True
    """
    for row in rows:
        level, level_dbfs = row.get("level_db"), row.get("level_dbfs")
        if isinstance(level, float) and isinstance(level_dbfs, float):
            return float(REFERENCE_PRESSURE * 10.0 ** ((level - level_dbfs) / 20.0))
    return None
