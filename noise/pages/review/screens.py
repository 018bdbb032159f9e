"""The map of a screen read back: what noise each design makes at which condition.

A screen is a folder with ``map.csv``; one map is drawn for each design, environment, temperature
and support, speed across and interference up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from models.errors import RecordingError
from noise.base.label_names import LABELS
from noise.base.tables import read_table
from noise.labels.table import cell_number
from noise.pictures.titles import support_words

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["ScreenMap", "ScreenPoint", "read_screen"]

_NEEDED = ("design", "speed_rad_s", "interference_mm", "label")
_SUPPORT = "support_stiffness_Nm_rad"


class ScreenPoint(NamedTuple):
    """One condition of a screen, and what happens there.

    Parameters
    ----------
    speed, interference : float
        [rad/s], the largest where the shaft swings; [mm]
    label : str
    regime, how : str
        Of friction; how it is known.
    level, loudness : float or None
        L_AFmax [dB re 20 uPa] and N10 [sone].
    frequency : float or None
        At which the shaft swings [Hz]; None where it turns.
    """

    speed: float
    interference: float
    label: str
    regime: str = ""
    level: float | None = None
    loudness: float | None = None
    how: str = ""
    frequency: float | None = None

    @property
    def words(self) -> str:
        """What is there, in words."""
        told = [f"{self.speed:.3g} rad/s, {self.interference:.3g} mm: {self.label}"]
        told += [self.regime.replace("_", " ")] if self.regime else []
        told += [f"{self.level:.0f} dB(A)"] if self.level is not None else []
        told += [f"{self.loudness:.3g} sone"] if self.loudness is not None else []
        return ", ".join(told)


@dataclass(frozen=True)
class ScreenMap:
    """Points of one design in one environment, at one temperature, on one support.

    Parameters
    ----------
    design, environment, motion : str
    temperature : float or None
        [degree Celsius]
    support_stiffness : float or None
        [Nm/rad]
    points : tuple of ScreenPoint
    """

    design: str
    environment: str
    motion: str
    temperature: float | None
    support_stiffness: float | None
    points: tuple[ScreenPoint, ...]

    @property
    def title(self) -> str:
        """Name it."""
        told = [self.design]
        told += [self.environment] if self.environment else []
        told += [self.motion] if self.motion not in ("", "steady") else []
        told += [f"{self.temperature:g} °C"] if self.temperature is not None else []
        told += [] if self.support_stiffness is None else [support_words(self.support_stiffness)]
        return ", ".join(told)


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
                number("loudness"),
                str(row.get("how") or ""),
                number("frequency_hz") or None,
            )
        )  # fmt: skip
    return [ScreenMap(*key, tuple(points)) for key, points in maps.items()]


def _support(row: dict[str, object], where: str) -> float | None:
    if _SUPPORT not in row:
        return None
    if row[_SUPPORT] in (None, "", "fixed"):
        return math.inf
    return cell_number(row, _SUPPORT, where)
