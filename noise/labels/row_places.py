"""Where rows of a recording lie, and what they say, to tell whether they are still the same."""

from __future__ import annotations

import math
from hashlib import blake2b
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    Row = Mapping[str, object]
    Place = tuple[str, float, float]

__all__ = ["WHOLE", "common_time", "place", "track", "version"]

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
    said = sorted(repr((*place(row), row["label"], row.get("label_source"))) for row in rows)
    return blake2b("\n".join(said).encode(), digest_size=8).hexdigest()
