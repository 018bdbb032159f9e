"""What a page shows of designs compared: names, maps and legends, and the data of its script."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.base.label_looks import LABEL_LOOKS
from noise.base.label_names import LABELS
from noise.pages.screening.looks import (
    DIFFERENCES,
    LEVEL_STEPS,
    LEVELS,
    SAID,
    SUBSTITUTED,
    WAYS,
    way_look,
)

if TYPE_CHECKING:
    from noise.base.label_looks import Look
    from noise.pages.engine.maps import ConditionMap

__all__ = ["Compared", "Comparison"]

_MOST_OPEN = 4
"""Comparisons that are unfolded when the page opens."""

_MAP_BYTES, _AREA_BYTES = 12_000.0, 120.0
"""What a map and an area of it take up on a page at most [byte]."""


@dataclass(frozen=True)
class Comparison:
    """Maps of designs at one place: environment, motion, temperature and support.

    Parameters
    ----------
    title : str
    maps : tuple of ConditionMap
        One a design.
    difference : ConditionMap or None
        An empty one of the same axes, for a script to draw on; None where there is one design.
    cells : dict
        For the script: where the cells end, and of each design label, level and how it is known.
    ways : tuple of str
        How points are known.
    note : str
    """

    title: str
    maps: tuple[ConditionMap, ...]
    difference: ConditionMap | None
    cells: dict[str, object]
    ways: tuple[str, ...]
    note: str


@dataclass(frozen=True)
class Compared:
    """All that is compared.

    Parameters
    ----------
    names : tuple of str
        Of the designs, as they were named.
    comparisons : tuple of Comparison
        One an environment, motion, temperature and support.
    pair : tuple of int
        Numbers of the designs that are compared until others are chosen.
    """

    names: tuple[str, ...]
    comparisons: tuple[Comparison, ...]
    pair: tuple[int, int]

    @property
    def n_maps(self) -> int:
        """How many maps there are."""
        return sum(len(one.maps) for one in self.comparisons)

    @property
    def weight(self) -> float:
        """What the maps take up on a page at most [byte]."""
        n_areas = sum(len(of.areas) for one in self.comparisons for of in one.maps)
        return _MAP_BYTES * self.n_maps + _AREA_BYTES * n_areas + len(json.dumps(self.data))

    @property
    def open(self) -> int:
        """How many comparisons are unfolded."""
        return _MOST_OPEN

    @property
    def looks(self) -> dict[str, Look]:
        """Of all that is drawn."""
        ways = {f"how-{n}": way_look(how) for n, how in enumerate(self._ways)}
        return LABEL_LOOKS | LEVELS | DIFFERENCES | ways | {"substituted": SUBSTITUTED}

    @property
    def keys(self) -> list[tuple[str, str, list[tuple[str, str]]]]:
        """Legends: name, what it is of, and each look with its words."""
        ways = [(f"how-{n}", way_look(how).mark) for n, how in enumerate(self._ways)]
        ways.append(("substituted", SUBSTITUTED.mark))
        levels = [(key, look.mark) for key, look in LEVELS.items()]
        keys = [("level", "L_Aeq in dB(A):", levels), ("how", "How a point is known:", ways)]
        if len(self.names) > 1:
            differences = [(key, look.mark) for key, look in DIFFERENCES.items()]
            keys.append(("difference", "Difference, B against A:", differences))
        return keys

    @property
    def data(self) -> dict[str, object]:
        """For the script."""
        return {
            "names": self.names,
            "labels": LABELS,
            "marks": [LABEL_LOOKS[label].mark for label in LABELS],
            "steps": LEVEL_STEPS,
            "ways": self._ways,
            "said": [SAID.get(how, how) for how in self._ways],
            "pair": self.pair,
            "comparisons": [one.cells for one in self.comparisons],
        }

    @property
    def _ways(self) -> list[str]:
        """How points are known, in one order."""
        found = {how for one in self.comparisons for how in one.ways}
        return sorted(found, key=lambda how: (list(WAYS).index(how) if how in WAYS else 9, how))
