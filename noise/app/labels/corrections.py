"""What a person says of a recording: segments from the browser, checked, as rows of the table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.app.labels.split_rows import row_of_piece, with_measured, without_opinion
from noise.base.label_names import LABELS
from noise.labels.row_places import place
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from collections.abc import Sequence

    Row = dict[str, object]

__all__ = ["Correction", "as_rows", "news", "read_corrections"]

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
        One of `noise.base.label_names.LABELS`.
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
    said = sorted(map(_one, rows), key=lambda one: (one.channel != "all", one.channel, one.start))
    for one, after in pairwise(said):
        if one.channel == after.channel and after.start < one.end:
            raise ParameterError(
                f"segments overlap: {one.label} until {one.end:g} s, {after.label} from "
                f"{after.start:g} s"
            )
    return said


def _one(row: object) -> Correction:
    if not isinstance(row, dict):
        raise ParameterError("rows: a segment is an object of start_s, end_s, label, channel")
    start, end = (_seconds(row, key) for key in ("start_s", "end_s"))
    if not 0.0 <= start < end:
        raise ParameterError(f"a segment from {start:g} to {end:g} s: must end after it starts")
    label, channel = row.get("label"), str(row.get("channel") or "all")
    if label not in LABELS:
        raise ParameterError(f"label {label!r}: must be one of {', '.join(LABELS)}")
    if channel != "all" and not (channel.isascii() and channel.isdecimal() and int(channel) > 0):
        raise ParameterError(f"channel {channel!r}: must be all, or a track counted from 1")
    return Correction(start, end, str(label), channel, row.get("label_source") == HUMAN)


def _seconds(row: dict[object, object], key: str) -> float:
    value = row.get(key)
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < _LONGEST:
        return round(float(value), 6)
    raise ParameterError(f"{key} {str(value)[:40]}: must be a number of seconds")


def news(said: Sequence[Correction], before: Sequence[Row]) -> list[Correction]:
    """Return those segments that no row was before."""
    there = {(*place(row), row["label"]) for row in before}
    return [one for one in said if (one.channel, one.start, one.end, one.label) not in there]


def as_rows(
    said: Sequence[Correction], name: str, before: Sequence[Row], measured: Sequence[Row] = ()
) -> list[Row]:
    """Return the rows of a recording after a correction.

    Parameters
    ----------
    said : sequence of Correction
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
    for one in said:
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
        rows.append(row | {"label": one.label, "label_source": HUMAN, "error": None})
    return rows
