"""Loudness of a map's noises: N5 of one point a region, scaled to the rest by level.

The procedure of ISO 532-1 for time-varying sounds takes as long as twenty runs, so it is computed
at one point of each region of one label, the loudest. From there loudness goes with level by
Stevens' rule, twice as loud every ten decibels, which holds while the spectrum stays what it is, as
it nearly does within a label's region. Small regions borrow from the nearest in level.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage
from scipy.signal import resample_poly

from features.sound_quality import SHORTEST, loudness_n5
from models.rig import Rig
from noise.screening.point import point_sound
from noise.screening.standing import loudness_weight
from noise.screening.vibration import Condition

if TYPE_CHECKING:
    from noise.screening.mapping import DesignMap


_MOST_REGIONS = 6
"""Number of the largest regions of a map whose loudest points are evaluated."""


def with_loudness(mapped: DesignMap, rig: Rig) -> DesignMap:
    """Return the map with the loudness N5 of its noises.

    Parameters
    ----------
    mapped : DesignMap
    rig : Rig
        In the map's environment.

    Returns
    -------
    DesignMap

    Raises
    ------
    ParameterError
        The extra ``sound-quality`` is not installed.
    """
    grid = mapped.grid
    references: dict[str, list[tuple[float, float]]] = {}  # level and loudness by label
    for where, label in _regions(mapped):
        t, k, i, v = where
        frequency = grid.frequency[v] if grid.frequency else None
        at = Condition(
            grid.speed[v], grid.interference[i], grid.support_stiffness[k], grid.temperature[t],
            frequency,
        )  # fmt: skip
        rate, pressure = point_sound(rig, at)
        pressure, rate = resample_poly(pressure, 8, 5), 1.6 * rate  # what the procedure is for
        cycles = int(np.ceil(SHORTEST * rate / pressure.size))  # of a fast swing
        n5 = loudness_n5(np.tile(pressure, cycles), rate)
        references.setdefault(label, []).append((float(mapped.level_max[where]), n5))
    loudness = np.full(mapped.level_max.shape, np.nan)
    for label, points in references.items():
        levels, sones = np.array(points).T
        cells = (mapped.sound == label) & np.isfinite(mapped.level_max)
        level = mapped.level_max[cells]
        nearest = np.abs(level[:, None] - levels).argmin(axis=1)
        loudness[cells] = sones[nearest] * loudness_weight(40.0 + level - levels[nearest])
    return replace(mapped, loudness=loudness)


def _regions(mapped: DesignMap) -> list[tuple[tuple[int, ...], str]]:
    """Return the loudest points of the largest regions, at least one of each label, with labels."""
    regions: list[tuple[int, tuple[int, ...], str]] = []
    for label in np.unique(mapped.sound[mapped.sound != "none"]):
        numbers, _ = ndimage.label(mapped.sound == label)
        counts = np.bincount(numbers.ravel())[1:]
        for rank, number in enumerate(np.argsort(counts)[::-1][:_MOST_REGIONS]):
            level = np.where(numbers == number + 1, mapped.level_max, -np.inf)
            where = tuple(int(n) for n in np.unravel_index(np.nanargmax(level), level.shape))
            if np.isfinite(level[where]):
                first = 10 * mapped.label.size if rank == 0 else 0
                regions.append((int(counts[number]) + first, where, str(label)))
    regions.sort(reverse=True)
    return [(where, label) for _, where, label in regions[:_MOST_REGIONS]]
