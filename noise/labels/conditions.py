"""Conditions map: counts of labels by speed, interference and support stiffness.

Logged values scatter and ramps cover ranges, so values within 5 % of the smallest are one group, or
within as much more as leaves few groups. Speeds have no sign. An unknown condition is a bin of its
own, so that the map shows how much of the data has none. Inferred conditions count as unknown: a
number from a wide interval would look like a measurement, and conditions inferred from the noise
cannot show at which conditions the noise occurs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from noise.base.labels import LABELS

_WIDTH = 1.05
"""Ratio of the largest to the smallest value of a group, unless there are too many groups."""

_AXES = {"speed_rad_s": 15, "interference_mm": 8, "support_stiffness_Nm_rad": 6}
"""Columns of a condition, and about the most groups of each."""

MAP_COLUMNS = (
    "material",
    *(f"{axis}_{end}" for axis in _AXES for end in ("from", "to")),
    "label", "recordings", "segments",
    *(f"{label}_segments" for label in LABELS),
    *(f"{label}_s" for label in LABELS),
)  # fmt: skip
"""Columns of the table of the map."""


class Range(NamedTuple):
    """Range of a condition in the map, and the value that represents it in a picture."""

    low: float
    high: float
    middle: float


@dataclass
class Place:
    """Counts of labels at one condition.

    Parameters
    ----------
    material : str or None
    speed, interference, support_stiffness : Range or None
        In rad/s, mm and Nm/rad as in the table; ``None`` if unknown.
    segments : dict of str to int
        Number of segments by label.
    seconds : dict of str to float
        Total duration of the segments by label [s].
    recordings : set of str
        Files of the segments.
    """

    material: str | None
    speed: Range | None
    interference: Range | None
    support_stiffness: Range | None
    segments: dict[str, int] = field(default_factory=lambda: dict.fromkeys(LABELS, 0))
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(LABELS, 0.0))
    recordings: set[str] = field(default_factory=set)

    @property
    def label(self) -> str:
        """Label with the longest total duration, ``none`` aside."""
        audible = [label for label in LABELS if self.segments[label] and label != "none"]
        return max(audible, key=self.seconds.__getitem__) if audible else "none"


def conditions_map(rows: Iterable[Mapping[str, object]]) -> list[Place]:
    """Count the segments of a label table by operating condition.

    Parameters
    ----------
    rows : iterable of mapping
        Rows of the label table; rows without a label are ignored, and conditions with the source
        ``inferred`` count as unknown.

    Returns
    -------
    list of Place
        Sorted by material, support, interference and speed; unknown conditions come last.

    Examples
    --------
    >>> from noise.labels.table import COLUMNS
    >>> row = dict.fromkeys(COLUMNS) | {"start_s": 0.0, "end_s": 2.0, "interference_mm": 0.279}
    >>> rows = [row | {"file": "a.wav", "speed_rad_s": 4.98, "label": "squawk"},
    ...         row | {"file": "b.wav", "speed_rad_s": -5.0, "label": "squawk"}]
    >>> place, = conditions_map(rows)
    >>> place.label, place.segments["squawk"], place.speed, place.support_stiffness
    ('squawk', 2, Range(low=4.98, high=5.0, middle=4.99), None)
    """
    labelled = [row for row in rows if row.get("label") in LABELS]
    groups = {
        axis: _groups([_logged(row, axis) for row in labelled], _AXES[axis]) for axis in _AXES
    }
    places: dict[tuple[object, ...], Place] = {}
    for row in labelled:
        material = row.get("material")
        name = None if material is None else str(material)
        speed, fit, support = (groups[axis].get(_logged(row, axis)) for axis in _AXES)
        place = Place(name, speed, fit, support)
        place = places.setdefault((name, speed, fit, support), place)
        label = str(row["label"])
        place.segments[label] += 1
        start, end = _number(row.get("start_s")), _number(row.get("end_s"))
        place.seconds[label] += 0.0 if start is None or end is None else end - start
        place.recordings.add(str(row.get("file")))
    return sorted(places.values(), key=_order)


def map_rows(places: Sequence[Place]) -> list[dict[str, object]]:
    """Return the map as rows of `MAP_COLUMNS`, for `noise.base.tables.write_table`."""
    rows = []
    for place in places:
        row: dict[str, object] = {"material": place.material}
        ranges = (place.speed, place.interference, place.support_stiffness)
        for axis, span in zip(_AXES, ranges, strict=True):
            row[f"{axis}_from"] = None if span is None else round(span.low, 6)
            row[f"{axis}_to"] = None if span is None else round(span.high, 6)
        row["label"] = place.label
        row["recordings"] = len(place.recordings)
        row["segments"] = sum(place.segments.values())
        row |= {f"{label}_segments": place.segments[label] for label in LABELS}
        row |= {f"{label}_s": round(place.seconds[label], 6) for label in LABELS}
        rows.append(row)
    return rows


def _groups(values: Sequence[float | None], most: int) -> dict[float | None, Range]:
    """Return the group of each value that is known."""
    ordered = sorted({value for value in values if value is not None})
    width = _WIDTH
    while True:
        groups: list[list[float]] = []
        for value in ordered:
            if groups and value <= width * groups[-1][0]:
                groups[-1].append(value)
            else:
                groups.append([value])
        if len(groups) <= most:
            break
        width *= width
    ranges = [Range(group[0], group[-1], sum(group) / len(group)) for group in groups]
    return {value: span for group, span in zip(groups, ranges, strict=True) for value in group}


def _logged(row: Mapping[str, object], axis: str) -> float | None:
    value = None if row.get(f"{axis}_source") == "inferred" else _number(row.get(axis))
    return value if value is None or axis != "speed_rad_s" else abs(value)


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _order(place: Place) -> tuple[tuple[bool, str], list[tuple[bool, float]]]:
    """Return the sort key of a place: unknown conditions come last."""
    ranges = (place.support_stiffness, place.interference, place.speed)
    material = (place.material is None, place.material or "")
    return material, [(span is None, span.middle if span else 0.0) for span in ranges]
