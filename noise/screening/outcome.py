"""Result of a screening, which draws its maps."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.show import short_repr
from noise.screening.design.environments import DRY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

    from noise.screening.design.design import Design
    from noise.screening.map.grid import Grid
    from noise.screening.map.mapping import DesignMap
    from noise.screening.parts.statistics import Statistics
    from noise.screening.ranking.margins import CriticalPoint
    from noise.screening.ranking.ranking import Standing


@short_repr
@dataclass(frozen=True)
class Screening:
    """What a screen found.

    Parameters
    ----------
    designs : tuple of Design
        Those that were screened, as they were: named, and changed where a change was given.
    maps : tuple of DesignMap
        One for each design, environment and motion; all designs have the same grids.
    critical : tuple of CriticalPoint
        Critical speeds and margins, by simulation and by stability.
    statistics : tuple of Statistics
        Risk and, where it was asked for, robustness; one for each design and environment.
    standings : tuple of Standing
        The designs ranked, the quietest first, with what each does in plain words, a hint what to
        change and what to know of its numbers; one for each map.
    refused : tuple of (str, str)
        Designs that could not be screened, and why.
    files : tuple of (str, Path)
        Files that designs were read from, by the names that the screen calls them.
    seconds, statistics_seconds : float
        How long the maps took, and risk and robustness [s].

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> found.refused, found.standings[0].shares["none"], found.statistics_of("PDMS").risk
    ((), 1.0, 1)
    """

    designs: tuple[Design, ...]
    maps: tuple[DesignMap, ...]
    critical: tuple[CriticalPoint, ...]
    statistics: tuple[Statistics, ...]
    standings: tuple[Standing, ...]
    refused: tuple[tuple[str, str], ...]
    files: tuple[tuple[str, Path], ...]
    seconds: float
    statistics_seconds: float

    def count(self, how: str) -> int:
        """How many points of all maps are known in a way: `DesignMap.how`."""
        return sum(found.count(how) for found in self.maps)

    @property
    def points(self) -> int:
        """How many points the maps have."""
        return sum(found.label.size for found in self.maps)

    @property
    def conditions(self) -> tuple[Grid, ...]:
        """Conditions that all designs are compared over, one for each environment and motion."""
        first = self.maps[0].design
        return tuple(found.grid for found in self.maps if found.design == first)

    @property
    def substituted(self) -> dict[str, int]:
        """How many points of each design rest on data interpolated or held, by the design's name.

        What stands in is said by `noise.screening.map.provenance.RULE`, and of each point by the
        map's `note`.
        """
        counts = {found.design: 0 for found in self.maps}
        for found in self.maps:
            counts[found.design] += int(np.sum(found.substituted))
        return {name: count for name, count in counts.items() if count}

    @property
    def failed(self) -> tuple[tuple[str, str], ...]:
        """Designs of which something could not be told, and what and why."""
        return tuple((one.design, why) for one in self.statistics for why in one.failed)

    def statistics_of(self, design: str, environment: str = DRY) -> Statistics:
        """Risk and robustness of a design in an environment.

        Raises
        ------
        ParameterError
            There is no such design, or not in this environment.
        """
        for one in self.statistics:
            if (one.design, one.environment) == (design, environment):
                return one
        raise ParameterError(f"there is no design {design!r} in environment {environment!r}")

    def plot(
        self,
        ax: Axes | None = None,
        *,
        number: int = 0,
        support: int = 0,
        temperature: int = 0,
    ) -> Axes:
        """Draw which noise a design makes where, with one support.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.
        number : int
            Of the map among `maps`, from 0.
        support, temperature : int
            Which of the map's, from 0.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is no such map, support or temperature.

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from noise.screening.design.design import Use
        >>> from noise.screening.screen import screen
        >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
        >>> found.plot(Figure().subplots()).get_ylabel()
        'Interference [mm]'
        """
        from noise.pictures.maps import plot_map

        _check_index("map", number, len(self.maps))
        found = self.maps[number]
        _check_index("support", support, len(found.grid.support_stiffness))
        _check_index("temperature", temperature, len(found.grid.temperature))
        return plot_map(found, ax, support=support, temperature=temperature)

    def to_pandas(self, table: str = "designs") -> DataFrame:
        """Return one of the tables that ``bushing-noise screen --out`` writes, as a data frame.

        Parameters
        ----------
        table : str
            ``designs``, ``map``, ``critical_speeds``; ``sensitivities`` and ``advice`` where
            tolerances were looked at.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        ParameterError
            There is no such table, or pandas is not installed.
        """
        from models.show import data_frame
        from noise.screening.tables.tables import screening_tables

        tables = screening_tables(self)
        if f"{table}.csv" not in tables:
            there = ", ".join(name.removesuffix(".csv") for name in tables)
            raise ParameterError(f"there is no table {table!r}; there are {there}")
        return data_frame(*tables[f"{table}.csv"])


def _check_index(what: str, index: int, there: int) -> None:
    if not 0 <= index < there:
        raise ParameterError(f"there is no {what} {index}; there are 0 to {there - 1}")
