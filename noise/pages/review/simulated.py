"""Sounds of a screen, simulated for the page where a listener will want them.

A screen knows thousands of conditions, and nobody listens to them all. So a few are chosen that
lie far from one another, every label heard at least once, more of those that cover more; a click
anywhere else plays the nearest of the same label.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.audio.sound import audible
from noise.pages.engine.entry import RATE, Entry
from noise.screening.map.point import shaft_motion
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from noise.pages.review.screens import ScreenMap, ScreenPoint

__all__ = ["MOST_SILENT", "SECONDS", "chosen_points", "simulated_entry"]

SECONDS = 2.0
"""Of a simulated sound."""

MOST_SILENT = 2
"""Of the sounds of a map that are ``none``."""

_ITERATIONS = 8

_SUPPORT, _TEMPERATURE = 2214.0, 23.0
"""Of a screen that tells none [Nm/rad], [degree Celsius]."""


def chosen_points(points: Sequence[ScreenPoint], most: int) -> list[ScreenPoint]:
    """Choose conditions to be heard.

    Parameters
    ----------
    points : sequence of ScreenPoint
    most : int
        How many at most.

    Returns
    -------
    list of ScreenPoint
        Of each label at least one, if there is room, the others by how many points it has, but no
        more than `MOST_SILENT` that are ``none``; those of one label in the middles of the parts
        into which they divide its region.

    Examples
    --------
    >>> from noise.pages.review.screens import ScreenPoint
    >>> line = [ScreenPoint(float(v), 0.3, "creak" if v < 7 else "none")
    ...         for v in range(10)]
    >>> [(point.speed, point.label) for point in chosen_points(line, 2)]
    [(3.0, 'creak'), (8.0, 'none')]
    """
    counts = Counter(point.label for point in points)
    limits = counts | {"none": min(MOST_SILENT, counts["none"])}
    shares = dict.fromkeys([label for label, _ in counts.most_common(most)], 1)
    for _ in range(most - len(shares)):
        open_ones = [label for label in shares if shares[label] < limits[label]]
        if not open_ones:
            break
        # The one of which each sound stands for the most points.
        neediest = max(open_ones, key=lambda label: (counts[label] / shares[label], label))
        shares[neediest] += 1
    at = np.array([(point.speed, point.interference) for point in points])
    span = np.ptp(at, axis=0)
    at = at / np.where(span > 0.0, span, 1.0)
    chosen: list[int] = []
    for label, number in shares.items():
        own = np.array([i for i, point in enumerate(points) if point.label == label])
        chosen += own[_spread(at[own], number)].tolist()
    return sorted((points[i] for i in chosen), key=lambda point: (point.speed, point.interference))


def _spread(at: NDArray[np.float64], number: int) -> list[int]:
    """Divide points into so many parts, and return the point in the middle of each.

    Lloyd's iteration from points that lie as far apart as can be.
    """
    picked = [int(np.linalg.norm(at - at.mean(axis=0), axis=1).argmin())]
    distance = np.linalg.norm(at - at[picked[0]], axis=1)
    while len(picked) < number:
        picked.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(at - at[picked[-1]], axis=1))
    middles = at[picked]
    for _ in range(_ITERATIONS):
        nearest = np.linalg.norm(at[:, None] - middles, axis=2).argmin(axis=1)
        middles = np.array([at[nearest == part].mean(axis=0) for part in np.unique(nearest)])
    found = np.linalg.norm(at[:, None] - middles, axis=2).argmin(axis=0)
    return list(dict.fromkeys(found.tolist()))


def simulated_entry(screened: ScreenMap, rig: Rig, point: ScreenPoint, *, seed: int) -> Entry:
    """Simulate what is heard at a point of a screen.

    Raises
    ------
    ParameterError
        The condition cannot be simulated.
    """
    support = screened.support_stiffness
    run = simulate(
        rig,
        shaft_motion(point.speed, point.frequency),
        interference=1e-3 * point.interference,
        seconds=SECONDS,
        acquisition=Acquisition(rate=RATE),
        rng=np.random.default_rng(seed),
        support_stiffness=_SUPPORT if support is None else support,
        temperature=_TEMPERATURE if screened.temperature is None else screened.temperature,
    )
    row: dict[str, object] = {"label": point.label, "level_db": point.level}
    return Entry(
        title=f"{point.speed:.3g} rad/s, {point.interference:.3g} mm, {screened.title}",
        rows=(row,),
        condition=replace(run.recording.condition, material=screened.design),
        duration=SECONDS,
        sound=audible(run.recording, RATE).astype(np.float32),
        note="simulated for this page; label and level are the screen's",
    )
