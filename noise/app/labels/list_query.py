"""Which recordings a list shows: those with a label in them, of a name, in an order."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.base.label_names import LABELS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    Shown = dict[str, object]

__all__ = ["ListQuery", "read_list_query", "whole_number"]

_ORDERS = {
    "name": "name",
    "label": "label",
    "frequency": "frequency_hz",
    "level": "level_dba",
    "duration": "duration_s",
    "least_sure": "least_sure",
}
"""What a list is sorted by."""

UNLABELLED, CORRECTED, REFUSED = "unlabelled", "corrected", "refused"
"""What is filtered by beside the labels."""

_MOST = 1000
"""Recordings that one answer holds."""


@dataclass(frozen=True)
class ListQuery:
    """What is asked of a list.

    Parameters
    ----------
    label : str
        A label that is in some segment, or ``unlabelled``, ``corrected``, ``refused``; empty for
        all.
    text : str
        That the name holds, whatever its case.
    sort : str
        Column to sort by; empty for the order of the table.
    descending : bool
    first, count : int
        Which of them are wanted [-].
    place : int or None
        Number of a recording whose place among them is asked.
    """

    label: str = ""
    text: str = ""
    sort: str = ""
    descending: bool = False
    first: int = 0
    count: int = 200
    place: int | None = None

    def answer(self, shown: Sequence[Shown]) -> dict[str, object]:
        """Return the recordings asked for, how many there are, and how many by label."""
        named = [one for one in shown if self.text.casefold() in str(one["name"]).casefold()]
        found = [one for one in named if not self.label or self.label in _kinds(one)]
        if self.sort:
            found = _sorted(found, _ORDERS[self.sort], descending=self.descending)
        counts = Counter(kind for one in named for kind in _kinds(one))
        return {
            "total": len(found),
            "counts": {
                "": len(named),
                **{name: counts[name] for name in (*LABELS, UNLABELLED, CORRECTED, REFUSED)},
            },
            "rows": found[self.first : self.first + self.count],
            "place": next((at for at, one in enumerate(found) if one["id"] == self.place), None),
        }


def read_list_query(query: Mapping[str, str]) -> ListQuery:
    """Read what a request asks.

    Raises
    ------
    ParameterError
        It is not understood.

    Examples
    --------
    >>> read_list_query({"label": "squeal", "sort": "level", "order": "desc"}).descending
    True
    """
    label, sort, order = query.get("label", ""), query.get("sort", ""), query.get("order", "asc")
    if label not in ("", *LABELS, UNLABELLED, CORRECTED, REFUSED):
        raise ParameterError(f"label {label!r}: must be one of {', '.join(LABELS)}")
    if sort not in ("", *_ORDERS):
        raise ParameterError(f"sort {sort!r}: must be one of {', '.join(_ORDERS)}")
    if order not in ("asc", "desc"):
        raise ParameterError(f"order {order!r}: must be asc or desc")
    return ListQuery(
        label,
        query.get("text", ""),
        sort,
        order == "desc",
        whole_number(query, "first", 0, 1 << 31),
        whole_number(query, "count", 200, _MOST),
        whole_number(query, "place", 0, 1 << 31) if query.get("place") else None,
    )


def whole_number(query: Mapping[str, str], key: str, missing: int, most: int) -> int:
    """Read a whole number of a request [-].

    Raises
    ------
    ParameterError
        It is none, or beyond `most`.
    """
    said = query.get(key, str(missing))
    if not (said.isascii() and said.isdecimal()) or len(said) > len(str(most)) or int(said) > most:
        raise ParameterError(f"{key} {said!r}: must be a whole number from 0 to {most}")
    return int(said)


def _kinds(one: Shown) -> list[str]:
    """Return what a recording is found under: each label in it."""
    kinds = list(one["labels"])  # type: ignore[call-overload]
    kinds += [REFUSED] * bool(one["error"]) + [CORRECTED] * bool(one["corrected"])
    return kinds if one["labels"] or one["error"] else [*kinds, UNLABELLED]


def _sorted(shown: Sequence[Shown], key: str, *, descending: bool) -> list[Shown]:
    """Sort by a column; what has nothing there comes last either way."""
    there = [one for one in shown if one[key] is not None]
    rest = [one for one in shown if one[key] is None]

    def value(one: Shown) -> object:
        found = one[key]
        return found.casefold() if isinstance(found, str) else found

    return [*sorted(there, key=value, reverse=descending), *rest]  # type: ignore[arg-type]
