"""Entry of a page: a stretch of sound, its labels, and what is known of its condition.

A page is for the ear, so a long recording is represented by the stretch that shows why it has its
name, not by its beginning.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from models.condition import Condition
from noise.base.label_names import LABELS
from noise.base.progress import counted
from noise.labels.label_display import labels_in, naming_row

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from features.kernels.orders import OrderMap

    Row = Mapping[str, object]
    FastLevels = tuple[NDArray[np.float64], NDArray[np.float64]]

__all__ = [
    "RATE", "Entry", "Part", "label_counts", "labels_sentence",
    "stretch_start",
]  # fmt: skip

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
    rows : tuple of mapping
        Of the label table; none where it is not labelled.
    condition : Condition
        As the recording says.
    duration : float
        Of the whole recording [s].
    sound : ndarray of float32, shape (n,), optional
        Sound pressure at `RATE` [Pa], or in fractions of full scale where not `calibrated`; of
        the whole recording or of a stretch of it.
    offset : float
        Where that stretch begins [s].
    calibrated : bool
    orders : OrderMap, optional
        Of a sound whose shaft's speed was recorded and changes.
    fast_levels : tuple of 2 ndarrays, shape (n,), optional
        Time [s] and A-weighted level, Fast [dB], where they were measured before the sound was
        faded and resampled, as by `noise.pictures.recorded.recorded_levels`.
    note : str
        Where the labels come from, or why there is no sound.
    data : mapping of str to str
        Names under which a program finds the sound on the page again.
    """

    title: str
    rows: tuple[Row, ...] = ()
    condition: Condition = field(default_factory=Condition)
    duration: float = 0.0
    sound: NDArray[np.float32] | None = None
    offset: float = 0.0
    calibrated: bool = True
    note: str = ""
    orders: OrderMap | None = None
    fast_levels: FastLevels | None = None
    data: Mapping[str, str] = field(default_factory=dict)

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
    def labels(self) -> tuple[str, ...]:
        """All labels in it, the longest first."""
        return labels_in(self.rows)


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


def label_counts(entries: Iterable[Entry]) -> list[tuple[str, int]]:
    """Count entries that have a label in them, by label; those without one last, as "".

    Examples
    --------
    >>> label_counts([Entry("a"), Entry("b", ({"label": "creak"}, {"label": "none"}))])
    [('creak', 1), ('none', 1), ('', 1)]
    """
    counts = Counter(label for entry in entries for label in entry.labels or ("",))
    return [(label, counts[label]) for label in (*LABELS, "") if counts[label]]


def labels_sentence(entries: Sequence[Entry]) -> str:
    """Say how many entries have which label in them.

    Examples
    --------
    >>> labels_sentence([Entry("a"), Entry("b", ({"label": "creak"},))])
    '2 recordings: 1 creak, 1 without a label'
    """
    words = [f"{number} {label or 'without a label'}" for label, number in label_counts(entries)]
    return f"{counted(len(entries), 'recording')}: {', '.join(words)}"


def _number(value: object, missing: float) -> float:
    return float(value) if isinstance(value, int | float) else missing
