"""The map of a screen read back: what noise each design makes at which condition.

A screen is a folder with ``map.csv``; one map is drawn for each design, environment, temperature
and support, speed across and interference up.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from models.errors import RecordingError
from models.foreign_file import refusing
from noise.base.label_names import LABELS
from noise.base.tables import read_table
from noise.labels.table import cell_number, check_name
from noise.pages.screening.screen_maps import ScreenMap, ScreenPoint

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["read_screen"]

_NEEDED = ("design", "speed_rad_s", "interference_mm", "label")
_SUPPORT = "support_stiffness_Nm_rad"


def read_screen(path: Path) -> list[ScreenMap]:
    r"""Read the map of a screen.

    Parameters
    ----------
    path : Path
        CSV, JSON Lines or Parquet with at least the columns design, speed_rad_s, interference_mm
        and label; a support stiffness that is empty or ``fixed`` is the bolted clamp.

    Returns
    -------
    list of ScreenMap
        In the order of the table.

    Raises
    ------
    RecordingError
        It cannot be read, or a value is none.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> text = "design,speed_rad_s,interference_mm,label\nold,5,0.279,squawk\nnew,5,0.279,none\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.csv"
    ...     _ = path.write_text(text)
    ...     [(one.title, one.points[0].words) for one in read_screen(path)]
    [('old', '5 rad/s, 0.279 mm: squawk'), ('new', '5 rad/s, 0.279 mm: none')]
    """
    _, rows = read_table(path)
    with refusing(str(path), "map of a screen", RecordingError):
        return _maps(path, rows)


def _maps(path: Path, rows: Sequence[dict[str, object]]) -> list[ScreenMap]:
    if not rows:
        raise RecordingError(f"{path}: has no rows, so is no map of a screen")
    maps: dict[tuple[str, str, str, float | None, float | None], list[ScreenPoint]] = {}
    for n, row in enumerate(rows, 1):
        where = f"{path}: row {n}"
        named = row if isinstance(row, dict) else {}  # a line of JSON may be anything
        missing = [column for column in _NEEDED if named.get(column) in (None, "")]
        if missing:
            raise RecordingError(f"{where} has no {missing[0]}")
        label = str(row["label"])
        if label not in LABELS:
            raise RecordingError(f"{where} has label {label!r}, expected {', '.join(LABELS)}")
        check_name(row["design"], "design", where)
        number = partial(cell_number, row, where=where)
        key = (
            str(row["design"]),
            str(row.get("environment") or ""),
            str(row.get("motion") or ""),
            number("temperature_C"),
            _support(row, where),
        )
        speed, fit = number("speed_rad_s"), number("interference_mm")
        if speed is None or fit is None:
            raise RecordingError(f"{where}: speed and interference are numbers")
        maps.setdefault(key, []).append(
            ScreenPoint(
                speed, fit, label,
                str(row.get("regime") or ""),
                number("level_dba"),
                number("loudness_n5_sone"),
                str(row.get("how") or ""),
                number("frequency_hz") or None,
                str(row.get("note") or ""),
            )
        )  # fmt: skip
    return [ScreenMap(*key, tuple(points)) for key, points in maps.items()]


def _support(row: dict[str, object], where: str) -> float | None:
    if _SUPPORT not in row:
        return None
    if row[_SUPPORT] in (None, "", "fixed", math.inf):
        return math.inf
    return cell_number(row, _SUPPORT, where)
