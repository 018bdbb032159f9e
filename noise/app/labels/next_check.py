"""Which recording is best checked next: one the classifier is likely wrong on, unlike those asked.

How likely a label is wrong is what its probability leaves. Sounds that are alike to the classifier
teach the same, so what lies far from all that was asked before counts more.
"""

from __future__ import annotations

from math import log2
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from noise.base.label_names import LABELS
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    Row = dict[str, object]

__all__ = ["NextCheck", "doubt", "place"]

_OCTAVES = 10.0
"""Frequencies so far apart differ as much as two sure labels do [octave]."""

_SHORTEST = 0.1
"""Nothing is learned from what is shorter [s]."""


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


def place(row: Row) -> NDArray[np.float64]:
    """Where a segment lies among the others: what it is taken for, and how high it sounds.

    Returns
    -------
    ndarray, shape (6,)
        [-]
    """
    p = np.array([_number(row.get(f"p_{label}")) for label in LABELS])
    hertz = max(_number(row.get("frequency_hz")), 1.0)
    return np.append(np.sqrt(np.maximum(p, 0.0)), log2(hertz) / _OCTAVES)


class NextCheck:
    """The order in which recordings are best checked, as it is asked for."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._asked: dict[int, NDArray[np.float64]] = {}

    def next(self, recordings: Iterable[Sequence[Row]], after: int | None) -> dict[str, object]:
        """Return the next one, and which of its segments is in doubt; its id is None if none is.

        Parameters
        ----------
        recordings : iterable of sequence of dict
            Rows of each, in order.
        after : int or None
            The one that was looked at last, corrected or not; it does not come again.
        """
        with self._lock:
            ids: list[int] = []
            rows: list[Row] = []
            for index, of_one in enumerate(recordings):
                if index == after and index not in self._asked:
                    self._asked[index] = _most_doubtful(of_one)
                if index in self._asked or any(r.get("label_source") == HUMAN for r in of_one):
                    continue
                told = [row for row in of_one if doubt(row) > 0.0 and _length(row) >= _SHORTEST]
                ids += [index] * len(told)
                rows += told
            if not rows:
                return {"id": None}
            places = np.array([place(row) for row in rows])
            worth = np.array([doubt(row) for row in rows])
            if self._asked:
                asked = np.array(list(self._asked.values()))
                far = np.linalg.norm(places[:, None] - asked[None], axis=2).min(axis=1)
                worth = worth * far
            best = int(worth.argmax())
            self._asked[ids[best]] = places[best]
            row = rows[best]
            return {"id": ids[best], "left": len(set(ids))} | {
                name: row.get(name) for name in ("channel", "start_s", "end_s", "label")
            }


def _most_doubtful(rows: Sequence[Row]) -> NDArray[np.float64]:
    return place(max(rows, key=doubt, default={}))


def _length(row: Row) -> float:
    return _number(row.get("end_s")) - _number(row.get("start_s"))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else 0.0
