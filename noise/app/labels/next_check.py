"""Which recording is best checked next: one the classifier is likely wrong on, unlike those asked.

How likely a label is wrong is what its probability leaves. Sounds that are alike to the classifier
teach the same, so what lies far from all that was asked before counts more: by what the classifier
hears in them where that is known already, else by what it has said of them.
"""

from __future__ import annotations

from math import log2
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from noise.base.label_names import LABELS
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.app.labels.segment_features import SegmentFeatures, Wanted
    from noise.batch import Job

    Row = dict[str, object]

__all__ = ["NextCheck", "doubt"]

_OCTAVES = 10.0
"""Frequencies so far apart differ as much as two sure labels do [octave]."""

_SHORTEST = 0.1
"""Nothing is learned from what is shorter [s]."""

_MOST = 200
"""Segments that are described: the most doubtful, one of each recording."""

_ENOUGH = 40
"""As many have to be described before those alone are compared."""

_DIMENSIONS = 15
"""In which sounds that are described differ most."""


def doubt(row: Row) -> float:
    """Probability that a row's label is wrong, by the classifier [-]; 0 of what a person has said.

    Examples
    --------
    >>> doubt({"label": "unknown", "p_unknown": 0.4, "p_creak": 0.6})
    0.6
    """
    p = row.get(f"p_{row.get('label')}")
    if row.get("label_source") == HUMAN or not isinstance(p, float):
        return 0.0
    return round(1.0 - p, 6)


class NextCheck:
    """The order in which recordings are best checked, as it is asked for.

    Parameters
    ----------
    jobs : sequence of Job
        The recordings.
    describing : SegmentFeatures, optional
        What tells how they sound; by default their labels' probabilities stand for it.
    """

    def __init__(self, jobs: Sequence[Job], describing: SegmentFeatures | None = None) -> None:
        self._lock = Lock()
        self._jobs = jobs
        self._describing = describing
        self._asked: dict[int, Row] = {}

    def next(self, recordings: Sequence[Sequence[Row]], after: int | None) -> dict[str, object]:
        """Return the next one, and which of its segments is in doubt; its id is None if none is.

        Parameters
        ----------
        recordings : sequence of sequence of dict
            Rows of each recording.
        after : int or None
            The one that was looked at last, corrected or not; it does not come again.
        """
        with self._lock:
            if after is not None and recordings[after]:
                self._asked.setdefault(after, max(recordings[after], key=doubt))
            left = [
                (index, max(rows, key=doubt))
                for index, rows in enumerate(recordings)
                if index not in self._asked and _in_doubt(rows)
            ]
            if not left:
                return {"id": None}
            index, row = self._best(left)
            told = {name: row.get(name) for name in ("channel", "start_s", "end_s", "label")}
            return {"id": index, "left": len(left)} | told

    def _best(self, left: list[tuple[int, Row]]) -> tuple[int, Row]:
        left = sorted(left, key=lambda one: -doubt(one[1]))[:_MOST]
        asked = list(self._asked.items())
        known = self._known(left)
        described = [one for one in left if self._wanted(*one) in known]
        if len(described) >= min(_ENOUGH, len(left)) and described:
            left = described
            asked = [one for one in asked if self._wanted(*one) in known]
            places = _sounds([known[self._wanted(*one)] for one in (*left, *asked)])
        else:
            places = np.array([_said(row) for _, row in (*left, *asked)])
        worth = np.array([doubt(row) for _, row in left])
        if asked:
            here, there = places[: len(left)], places[len(left) :]
            worth *= np.linalg.norm(here[:, None] - there[None], axis=2).min(axis=1)
        return left[int(worth.argmax())]

    def _known(self, left: list[tuple[int, Row]]) -> dict[Wanted, NDArray[np.float64]]:
        if self._describing is None:
            return {}
        self._describing.ask(self._wanted(*one) for one in left)
        return self._describing.known()

    def _wanted(self, index: int, row: Row) -> Wanted:
        path = str(self._jobs[index].path.absolute())
        start, end = _number(row.get("start_s")), _number(row.get("end_s"))
        return path, str(row.get("channel") or "all"), start, end


def _in_doubt(rows: Sequence[Row]) -> bool:
    """Whether nobody has looked at a recording, and something of it may be wrong."""
    if any(row.get("label_source") == HUMAN for row in rows):
        return False
    return any(doubt(r) > 0.0 and _length(r) >= _SHORTEST for r in rows)


def _said(row: Row) -> NDArray[np.float64]:
    """Return what a segment is taken for, and how high it sounds, shape (6,) [-]."""
    p = np.array([_number(row.get(f"p_{label}")) for label in LABELS])
    hertz = max(_number(row.get("frequency_hz")), 1.0)
    return np.append(np.sqrt(np.maximum(p, 0.0)), log2(hertz) / _OCTAVES)


def _sounds(features: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return where sounds lie by what they differ in most, shape (n, at most 15) [-].

    Each feature counts by its own spread; one that is missing is as in the others.
    """
    x = np.array(features)
    x = x[:, np.isfinite(x).any(axis=0)]
    low, middle, high = np.nanpercentile(x, (10.0, 50.0, 90.0), axis=0)
    x = np.nan_to_num(np.clip((x - middle) / (high - low + 1e-9), -2.0, 2.0))
    left, size, _ = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
    return np.asarray((left * size)[:, :_DIMENSIONS])


def _length(row: Row) -> float:
    return _number(row.get("end_s")) - _number(row.get("start_s"))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else 0.0
