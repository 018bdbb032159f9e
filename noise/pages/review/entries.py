"""What is heard on a review: a stretch of sound, its labels, and what is known of its condition.

A review is for the ear, so a long recording is represented by the stretch that shows why it has
its name, not by its beginning. What is read is cut at once: a campaign may be larger than memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError, RecordingError
from noise.audio.sound import audible
from noise.labels.segments import label_recording
from noise.labels.table import label_rows
from noise.pages.review.inputs import Refusal
from noise.recordings import read_recording
from noise.recordings.blocks import RecordingBlocks, open_blocks

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from models.condition import Condition
    from noise.classifier import Classifier
    from noise.pages.review.inputs import LabelTable, Row

__all__ = ["RATE", "Entry", "Part", "naming_row", "read_entry", "stretch_start", "without_sound"]

RATE = 48000
"""Of the sounds on a page [Hz]."""


@dataclass(frozen=True)
class Part:
    """A labelled stretch; `start` and `end` in s of the recording, `track` where there are many."""

    start: float
    end: float
    label: str
    track: str


@dataclass(frozen=True, eq=False)
class Entry:
    """Something to be heard, or at least to be named.

    Parameters
    ----------
    title : str
    rows : tuple of dict
        Of the label table; none where it is not labelled.
    condition : Condition
        As the recording says.
    origin : str
        ``recorded``, ``simulated`` or ``diagnosis``.
    duration : float
        Of the whole recording [s].
    sound : ndarray of float32, shape (n,), optional
        Sound pressure at `RATE` [Pa], or in fractions of full scale where not `calibrated`; of
        the whole recording or of a stretch of it.
    offset : float
        Where that stretch begins [s].
    calibrated : bool
    note : str
        Where the labels come from, or why there is no sound.
    """

    title: str
    rows: tuple[Row, ...]
    condition: Condition
    origin: str
    duration: float
    sound: NDArray[np.float32] | None
    offset: float
    calibrated: bool
    note: str = ""

    @property
    def parts(self) -> tuple[Part, ...]:
        """Labels in time."""
        return tuple(
            Part(
                _number(row.get("start_s"), 0.0),
                min(_number(row.get("end_s"), self.duration), self.duration),
                str(row["label"]),
                "" if row.get("channel") in ("all", None) else str(row["channel"]),
            )
            for row in self.rows
            if row["label"] is not None
        )

    @property
    def row(self) -> Row | None:
        """The row that names the whole."""
        return naming_row(self.rows)

    @property
    def label(self) -> str | None:
        """The label of the whole; None where it is not labelled."""
        row = self.row
        return None if row is None else str(row["label"])


def naming_row(rows: Sequence[Row]) -> Row | None:
    """Return the longest row that is not ``none``, by which a file is named.

    Examples
    --------
    >>> short = {"label": "creak", "start_s": 0.0, "end_s": 1.0}
    >>> naming_row([short, {"label": "none", "start_s": 1.0, "end_s": 9.0}])["label"]
    'creak'
    """
    labelled = [row for row in rows if row["label"] is not None]
    loud = [row for row in labelled if row["label"] != "none"]
    return max(loud or labelled, key=_length, default=None)


def stretch_start(rows: Sequence[Row], duration: float, length: float) -> float:
    """Where a stretch of `length` begins that shows what a recording is named for [s].

    Examples
    --------
    >>> rows = [{"label": "squeal", "start_s": 40.0, "end_s": 42.0}]
    >>> stretch_start(rows, 60.0, 10.0), stretch_start([], 60.0, 10.0)
    (36.0, 0.0)
    """
    row = naming_row(rows)
    if row is None or length >= duration:
        return 0.0
    start, end = _number(row.get("start_s"), 0.0), _number(row.get("end_s"), duration)
    wanted = start if end - start >= length else 0.5 * (start + end - length)
    return float(min(max(wanted, 0.0), duration - length))


def read_entry(
    path: Path,
    name: str,
    tables: Sequence[LabelTable],
    classifier: Classifier | None,
    *,
    longest: float,
    full_scale: float | None = None,
) -> Entry | Refusal:
    """Read what a review shows of a recording.

    Parameters
    ----------
    path : Path
    name : str
        What it is called.
    tables : sequence of LabelTable
        The first that has rows for it labels it.
    classifier : Classifier or None
        Labels what no table does; None leaves it without a label.
    longest : float
        Of the stretch that is kept [s].
    full_scale : float, optional
        As for `noise.recordings.read_recording`.
    """
    try:
        rows = next(filter(None, (table.of(path) for table in tables)), ())
        with open_blocks(path, full_scale=full_scale) as opened:
            blocks = opened or RecordingBlocks.of(read_recording(path, full_scale=full_scale))
            note = ""
            if any(row["label"] is not None for row in rows):
                note = "labelled by the table"
            elif classifier is not None:
                note = "labelled for this page"
                rows = tuple(label_rows(name, blocks, label_recording(blocks, classifier)))
            duration = blocks.n_samples / blocks.rate
            offset = stretch_start(rows, duration, longest)
            sound, why = _sound(blocks, offset, longest)
    except BushingNoiseError as error:
        return Refusal(str(path), str(error).removeprefix(f"{path}: "))
    return Entry(
        name, tuple(rows), blocks.condition, "recorded", duration, sound, offset,
        blocks.calibrated, "; ".join(filter(None, (note, why))),
    )  # fmt: skip


def without_sound(name: str, rows: Sequence[Row], condition: Condition) -> Entry:
    """Return what a label table says of a recording that is not at hand."""
    duration = max((_number(row.get("end_s"), 0.0) for row in rows), default=0.0)
    why = "labelled by the table; the recording is not at hand"
    return Entry(name, tuple(rows), condition, "recorded", duration, None, 0.0, False, why)


def _sound(
    blocks: RecordingBlocks, offset: float, longest: float
) -> tuple[NDArray[np.float32] | None, str]:
    row = blocks.first("pressure")
    if row is None:
        return None, "no sound pressure to be heard"
    first = round(offset * blocks.rate)
    last = min(blocks.n_samples, first + round(longest * blocks.rate))
    sound = audible(blocks.cut(first, last), RATE)
    if not np.isfinite(sound).all():
        raise RecordingError(f"{blocks.name}: holds sound pressures beyond any number")
    others = sum(channel.kind == "pressure" for channel in blocks.channels) - 1
    return sound.astype(np.float32), f"1 of {others + 1} channels is heard" if others else ""


def _length(row: Row) -> float:
    return _number(row.get("end_s"), 0.0) - _number(row.get("start_s"), 0.0)


def _number(value: object, missing: float) -> float:
    return float(value) if isinstance(value, int | float) else missing
