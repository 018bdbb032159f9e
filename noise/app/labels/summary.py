"""A recording in the list: what it is named for, what else is in it, how sure that is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.app.labels.next_check import doubt
from noise.base.tables import plain_cell
from noise.labels.label_display import labels_in, naming_row
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from collections.abc import Sequence

    Row = dict[str, object]

__all__ = ["conditions", "plain", "summary"]

_CONDITIONS = ("speed", "interference", "stiffness", "material")
_SUPPORT = "support_stiffness"


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
    ends = [row["end_s"] for row in rows if isinstance(row.get("end_s"), float)]
    return {
        "id": index,
        "name": name,
        "label": naming.get("label"),
        "labels": labels_in(rows),
        "frequency_hz": naming.get("frequency_hz"),
        "level_dba": naming.get("level_dba"),
        "duration_s": max(ends, default=None),  # type: ignore[type-var]
        "least_sure": max(map(doubt, rows), default=None),
        "corrected": any(row.get("label_source") == HUMAN for row in rows),
        "error": next((row["error"] for row in rows if row.get("error")), None),
    }


def conditions(row: Row) -> list[str]:
    """Return the operating conditions of a segment in words, as pages say them.

    Examples
    --------
    >>> row = {"label": "creak", "interference_mm": 0.279}
    >>> speed = {"speed_rad_s": 5.2, "speed_rad_s_low": 3.1, "speed_rad_s_high": 8.0}
    >>> conditions({**row, **speed, "speed_rad_s_source": "inferred"})
    ['speed 3.1 to 8 rad/s (inferred)', 'interference 0.279 mm']
    """
    # The list is there before what only pages need is loaded.
    from noise.pages.engine.entry import Entry
    from noise.pages.engine.entry_display import facts_of

    facts = facts_of(Entry("", (row,)))
    if not row.get("material"):  # which one is assumed, the row's note says
        facts.pop("material", None)
    return [f"{name} {facts[name].words}" for name in _CONDITIONS if name in facts]


def plain(rows: Sequence[Row]) -> list[Row]:
    """Return rows as JSON can hold them, numbered; the bolted clamp is the word ``fixed``."""
    return [
        {name: _plain(name, value) for name, value in row.items()} | {"row": number}
        for number, row in enumerate(rows)
    ]


def _plain(name: str, value: object) -> object:
    if isinstance(value, float) and not math.isfinite(value):
        return "fixed" if name.startswith(_SUPPORT) and value > 0.0 else None
    return plain_cell(value)  # a date of a column of one's own is text
