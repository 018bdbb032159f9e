"""What a segment with another label or other borders keeps of the row that it was before."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.base.label_names import LABELS
from noise.labels.label_display import ASSUMED
from noise.labels.labelling import COLUMNS, CONDITIONS
from noise.labels.row_places import common_time, place, track

if TYPE_CHECKING:
    from collections.abc import Sequence

    Row = dict[str, object]

__all__ = ["NOT_MEASURED", "row_of_piece", "with_measured", "without_opinion"]

_OF_LABEL = (*(f"p_{label}" for label in LABELS), "frequency_hz")

_PARTS = ("", "_low", "_high", "_source")

_LEVELS = ("level_db", "level_dbfs")

NOT_MEASURED = "not measured since its borders were changed"
"""What a segment's note says where its sound could not be read, or was too long to be."""

_MAY_END = ("frequency_hz", "snr_dba")
"""What a segment may have no longer by its new label: a pitch, a background to stand out of."""

_OF_RECORDING = ("calibrated", "material", "material_source", "note")
"""What holds wherever a segment's borders are, as do conditions that were logged."""


def without_opinion(row: Row) -> Row:
    """Return a row without what hangs on its label: probabilities, frequency, inferred conditions.

    Examples
    --------
    >>> row = {"label": "creak", "level_db": 60.0, "speed_rad_s": 5.2, "p_creak": 0.9}
    >>> left = without_opinion(row | {"speed_rad_s_source": "inferred", "note": None})
    >>> left["level_db"], left["speed_rad_s"], left["speed_rad_s_source"], left["p_creak"]
    (60.0, None, 'missing', None)
    """
    left = row | dict.fromkeys(_OF_LABEL)
    for name in CONDITIONS:
        if row.get(f"{name}_source") == "inferred":
            left |= dict.fromkeys(f"{name}{part}" for part in _PARTS)
            left[f"{name}_source"] = "missing"
    left["note"] = _without(row.get("note"), ASSUMED)
    return left


def row_of_piece(at: tuple[str, float, float], before: Sequence[Row]) -> Row:
    """Return what is known of a new segment before it is measured.

    Parameters
    ----------
    at : tuple of (str, float, float)
        Its track, start and end [s].
    before : sequence of dict
        The recording's rows until now.

    Returns
    -------
    dict
        What was logged, and columns that are not of a label table, of the row that most of it was
        in; all else is None.

    Examples
    --------
    >>> row = {"channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "creak", "level_db": 60.0}
    >>> row |= {"interference_mm": 0.2, "interference_mm_source": "logged", "remark": "left door"}
    >>> piece = row_of_piece(("all", 0.0, 0.5), [row])
    >>> piece["interference_mm"], piece["remark"], piece["level_db"]
    (0.2, 'left door', None)
    """
    kin = [row for row in before if row["label"] is not None]
    if not kin:
        sources = (*(f"{name}_source" for name in CONDITIONS), "material_source")
        return dict.fromkeys(COLUMNS) | dict.fromkeys(sources, "missing")
    nearest = max(kin, key=lambda row: (track(row) == at[0], common_time(place(row), at)))
    left = without_opinion(nearest)
    kept = {*_OF_RECORDING, *(f"{name}{part}" for name in CONDITIONS for part in _PARTS)}
    piece = {name: None if name in COLUMNS and name not in kept else left[name] for name in left}
    note = _without(piece.get("note"), NOT_MEASURED)
    if any(nearest.get(name) is not None for name in _LEVELS):
        note = "; ".join(filter(None, (note, NOT_MEASURED)))
    return piece | {"note": note}


def with_measured(row: Row, measured: Row) -> Row:
    """Return a row with what was measured of it; what the table alone knows of it stays.

    Examples
    --------
    >>> known = {"speed_rad_s": 5.0, "speed_rad_s_source": "logged", "level_db": None}
    >>> found = {"speed_rad_s": None, "speed_rad_s_source": "missing", "level_db": 61.2}
    >>> with_measured(known, found)
    {'speed_rad_s': 5.0, 'speed_rad_s_source': 'logged', 'level_db': 61.2, 'note': None}
    """
    new = {
        name: value
        for name, value in measured.items()
        if value not in (None, "missing") or name in _MAY_END
    }
    for name in CONDITIONS:
        source = f"{name}_source"
        if row.get(source) == "logged" and new.get(source) != "logged":
            for part in _PARTS:
                new.pop(f"{name}{part}", None)
    if measured and "note" not in new:
        new["note"] = _without(row.get("note"), NOT_MEASURED)
    return row | new


def _without(note: object, ending: str) -> str | None:
    """Return a note without the remarks that end so; None where nothing is left."""
    remarks = str(note or "").split("; ")
    return "; ".join(one for one in remarks if not one.endswith(ending)) or None
