"""Conditions map: counts of labels by speed, interference and support stiffness.

Logged speeds scatter and ramps cover ranges, so speeds are binned in steps of a round width,
without the sign of the rotation. Interferences and supports are few in most campaigns; values
within 5 % are one group, and many values are binned too. An unknown condition is a bin of its own,
so that the map shows how much of the data has none. Inferred conditions count as unknown: a number
from a wide interval would look like a measurement, and conditions inferred from the noise cannot
show at which conditions the noise occurs.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from noise.base.labels import LABELS

if TYPE_CHECKING:
    Grouping = Callable[[float], "Range"]


_NEAR = 1.02
"""Maximum ratio of neighbouring values in a group."""

_WIDEST = 1.05
"""Maximum ratio of the largest to the smallest value of a group."""

_FINEST = 0.04
"""Minimum step width, as a share of the largest value."""

_MOST_SPEEDS, _MOST_FITS, _MOST_SUPPORTS = 15, 8, 6

_AXES = ("speed_rad_s", "interference_mm", "support_stiffness_Nm_rad")

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
    ('squawk', 2, Range(low=4.9, high=5.1, middle=5.0), None)
    """
    labelled = [row for row in rows if row.get("label") in LABELS]
    speeds, fits, supports = ([_logged(row, axis) for row in labelled] for axis in _AXES)
    of_speed = _steps([abs(v) for v in speeds if v is not None], _MOST_SPEEDS)
    of_fit = _groups([v for v in fits if v is not None], _MOST_FITS)
    of_support = _groups([v for v in supports if v is not None], _MOST_SUPPORTS, _factor)
    places: dict[tuple[str | None, *tuple[Range | None, ...]], Place] = {}
    for row, speed, fit, support in zip(labelled, speeds, fits, supports, strict=True):
        material = row.get("material")
        name = None if material is None else str(material)
        where = (
            None if speed is None else of_speed(abs(speed)),
            None if fit is None else of_fit(fit),
            None if support is None else of_support(support),
        )
        place = places.setdefault((name, *where), Place(name, *where))
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


def _groups(values: Sequence[float], most: int, otherwise: Grouping | None = None) -> Grouping:
    """Return a function from a value to its group, or to its step if there are too many groups."""
    groups: list[list[float]] = []
    for value in sorted(set(values)):
        if groups and value < _NEAR * groups[-1][-1]:
            groups[-1].append(value)
        else:
            groups.append([value])
    if len(groups) > most or any(group[-1] > _WIDEST * group[0] for group in groups):
        return otherwise or _steps(values, most)
    ranges = {
        value: Range(group[0], group[-1], sum(group) / len(group))
        for group in groups
        for value in group
    }
    return ranges.__getitem__


def _steps(values: Sequence[float], most: int) -> Grouping:
    """Return a function from a value to its step; there are about `most` steps of a round width."""
    if not values:
        return _itself
    highest = max(values)
    width = _round_up(max((highest - min(values)) / (most - 1), _FINEST * highest))

    def step(value: float) -> Range:
        middle = round(value / width) * width
        return Range(max(0.0, middle - width / 2.0), middle + width / 2.0, middle)

    return step if width else _itself


def _factor(value: float) -> Range:
    """Return the range of a value on a scale of 1, 2, 5, 10."""
    if math.isinf(value) or value <= 0.0:
        return _itself(value)
    high = _round_up(value)
    low = _round_up(high / 2.51)
    return Range(low, high, math.sqrt(low) * math.sqrt(high))


def _itself(value: float) -> Range:
    return Range(value, value, value)


def _round_up(value: float) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that is not below a value."""
    if value <= 0.0:
        return 0.0
    if value < sys.float_info.min:  # subnormal numbers have no such power of ten
        return value
    decade = 10.0 ** math.floor(math.log10(value) + 1e-9)
    return next(step * decade for step in (1, 2, 5, 10) if value <= step * decade * (1 + 1e-9))


def _logged(row: Mapping[str, object], axis: str) -> float | None:
    return None if row.get(f"{axis}_source") == "inferred" else _number(row.get(axis))


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _order(place: Place) -> tuple[tuple[bool, str], list[tuple[bool, float]]]:
    """Return the sort key of a place: unknown conditions come last."""
    ranges = (place.support_stiffness, place.interference, place.speed)
    material = (place.material is None, place.material or "")
    return material, [(span is None, span.middle if span else 0.0) for span in ranges]
