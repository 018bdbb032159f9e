"""Maps of a screen as a page shows them: what noise each design makes at which condition.

One map is of one design in one environment, at one temperature, on one support: speed across and
interference up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from noise.pictures.titles import support_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.screening.outcome import Screening

__all__ = ["ScreenMap", "ScreenPoint", "SharedPoint", "screen_maps", "shared_points"]


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
        L_Aeq [dB re 20 uPa] and N5 [sone].
    frequency : float or None
        At which the shaft swings [Hz]; None where it turns.
    note : str
        What is not the design's own there.
    """

    speed: float
    interference: float
    label: str
    regime: str = ""
    level: float | None = None
    loudness: float | None = None
    how: str = ""
    frequency: float | None = None
    note: str = ""

    @property
    def words(self) -> str:
        """What is there, in words."""
        told = [f"{self.speed:.3g} rad/s, {self.interference:.3g} mm: {self.label}"]
        told += [self.regime.replace("_", " ")] if self.regime else []
        told += [f"{self.level:.0f} dB(A)"] if self.level is not None else []
        told += [f"N5 {self.loudness:.3g} sone"] if self.loudness is not None else []
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
        return ", ".join([self.design, *filter(None, [self.where])])

    @property
    def where(self) -> str:
        """What it has in common with the maps of other designs."""
        told = [self.environment] if self.environment else []
        told += [self.motion] if self.motion not in ("", "steady") else []
        told += [f"{self.temperature:g} °C"] if self.temperature is not None else []
        told += [] if self.support_stiffness is None else [support_words(self.support_stiffness)]
        return ", ".join(told)


class SharedPoint(NamedTuple):
    """One condition, and what happens there with each of several designs.

    Parameters
    ----------
    speed, interference : float
        [rad/s], [mm]
    points : tuple of (ScreenPoint or None)
        By design; None where it was not screened there.
    """

    speed: float
    interference: float
    points: tuple[ScreenPoint | None, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """Of each design; empty where it was not screened."""
        return tuple("" if point is None else point.label for point in self.points)


def shared_points(maps: Sequence[ScreenMap]) -> list[SharedPoint]:
    """Lay the points of designs at one place side by side.

    Examples
    --------
    >>> old = ScreenMap("old", "dry", "steady", 23.0, 2214.0, (ScreenPoint(5.0, 0.3, "creak"),))
    >>> new = ScreenMap("new", "dry", "steady", 23.0, 2214.0, (ScreenPoint(5.0, 0.3, "none"),))
    >>> [one.labels for one in shared_points([old, new])]
    [('creak', 'none')]
    """
    found = [{(p.speed, p.interference): p for p in one.points} for one in maps]
    return [
        SharedPoint(*at, tuple(of.get(at) for of in found))
        for at in dict.fromkeys(at for of in found for at in of)
    ]


def screen_maps(found: Screening) -> list[ScreenMap]:
    """Cut the maps of a screening by temperature and support.

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0, math.inf)))
    >>> [one.title for one in screen_maps(found)]
    ['PDMS, dry, 23 °C, 2214 Nm/rad', 'PDMS, dry, 23 °C, clamp fixed']
    """
    maps = []
    for one in found.maps:
        grid = one.grid
        for t, k in np.ndindex(one.label.shape[:2]):
            points = tuple(
                ScreenPoint(
                    speed=grid.speed[column],
                    interference=round(1e3 * grid.interference[row], 9),
                    label=str(one.label[t, k, row, column]),
                    regime=str(one.regime[t, k, row, column]),
                    level=_known(float(one.level[t, k, row, column])),
                    loudness=_known(float(one.loudness[t, k, row, column])),
                    how=str(one.how[t, k, row, column]),
                    frequency=grid.frequency[column] if grid.frequency else None,
                    note=str(one.note[t, k, row, column]),
                )
                for row, column in np.ndindex(one.label.shape[2:])
            )
            maps.append(
                ScreenMap(
                    one.design, one.environment, one.motion,
                    grid.temperature[t], grid.support_stiffness[k], points,
                )
            )  # fmt: skip
    return maps


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
