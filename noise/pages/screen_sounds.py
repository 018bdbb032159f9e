"""Maps of a screen, and simulated sounds at selected points.

One map is of one design in one environment, at one temperature, on one support: speed across and
interference up. A screen knows thousands of conditions, and nobody listens to them all. So a few
are chosen, and each is heard of every design: where each noise of each design is loudest, where the
designs differ most, and the middles of the regions in which they differ in the same way; a click
anywhere else plays the nearest of these.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from features.kernels.level_meter import a_weighted_level
from models.errors import BushingNoiseError
from models.rig import Rig
from noise.audio.sound import audible
from noise.audio.spectrogram import recorded_levels
from noise.base.labels import LABELS, PERSISTS
from noise.base.progress import track
from noise.batch.work import one_thread
from noise.pages.clips import RATE, Entry
from noise.pictures.figure import support_words
from noise.screening.point import swing
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from noise.screening.screen import Screening


class ScreenPoint(NamedTuple):
    """Condition of a screen and its result.

    Parameters
    ----------
    speed, interference : float
        [rad/s], the largest where the shaft swings; [mm]
    label : str
    regime, how : str
        Of friction; how it is known.
    level : float or None
        L_Aeq [dB re 20 uPa].
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
    how: str = ""
    frequency: float | None = None
    note: str = ""

    @property
    def words(self) -> str:
        """Result in words."""
        parts = [f"{self.speed:.3g} rad/s, {self.interference:.3g} mm: {self.label}"]
        parts += [self.regime.replace("_", " ")] if self.regime else []
        parts += [f"{self.level:.0f} dB(A)"] if self.level is not None else []
        return ", ".join(parts)


@dataclass(frozen=True)
class ScreenMap:
    """Map of one design in one environment, temperature and support.

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
        """Title of the map."""
        return ", ".join([self.design, *filter(None, [self.where])])

    @property
    def where(self) -> str:
        """Environment, motion, temperature and support, shared with other designs."""
        parts = [self.environment] if self.environment else []
        parts += [self.motion] if self.motion not in ("", "steady") else []
        parts += [f"{self.temperature:g} °C"] if self.temperature is not None else []
        parts += [] if self.support_stiffness is None else [support_words(self.support_stiffness)]
        return ", ".join(parts)


class SharedPoint(NamedTuple):
    """Condition and the results of several designs.

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
        """Labels of the designs; empty for those not screened."""
        return tuple("" if point is None else point.label for point in self.points)


def shared_points(maps: Sequence[ScreenMap]) -> list[SharedPoint]:
    """Return the common points of maps.

    Examples
    --------
    >>> old = ScreenMap("old", "dry", "steady", 23.0, 2214.0, (ScreenPoint(5.0, 0.3, "creak"),))
    >>> new = ScreenMap("new", "dry", "steady", 23.0, 2214.0, (ScreenPoint(5.0, 0.3, "none"),))
    >>> [one.labels for one in shared_points([old, new])]
    [('creak', 'none')]
    """
    by_place = [{(p.speed, p.interference): p for p in one.points} for one in maps]
    return [
        SharedPoint(*at, tuple(of.get(at) for of in by_place))
        for at in dict.fromkeys(at for of in by_place for at in of)
    ]


def screen_maps(screening: Screening) -> list[ScreenMap]:
    """Return the maps of a screening by temperature and support.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0, math.inf)))
    >>> [one.title for one in screen_maps(found)]
    ['PDMS, dry, 23 °C, 2214 Nm/rad', 'PDMS, dry, 23 °C, clamp fixed']
    """
    maps = []
    for one in screening.maps:
        grid = one.grid
        for t, k in np.ndindex(one.label.shape[:2]):
            points = tuple(
                ScreenPoint(
                    speed=grid.speed[column],
                    interference=round(1e3 * grid.interference[row], 9),
                    label=str(one.label[t, k, row, column]),
                    regime=str(one.regime[t, k, row, column]),
                    level=_known(float(one.level[t, k, row, column])),
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


SECONDS = 2.0
"""Of a simulated sound."""

MOST_SILENT = 2
"""Of the sounds of a map that are ``none`` of every design."""

_NOISES = tuple(label for label in LABELS if label not in ("none", "unknown"))

_SILENCE = 40.0
"""What a design without a noise counts as, where levels are compared [dB(A)]."""

_FAR = 10.0
"""More than any distance, as a share of the axes."""

_NEAR = 0.05
"""Points of the same labels no farther apart than that sound alike, as a share of the axes."""

INTERPOLATED = "refined"
"""How a point is known that lies between simulated ones."""


_SUPPORT, _TEMPERATURE = 2214.0, 23.0
"""Of a screen that tells none [Nm/rad], [degree Celsius]."""


def chosen_points(points: Sequence[SharedPoint], most: int) -> list[SharedPoint]:
    """Return the conditions with sounds.

    Parameters
    ----------
    points : sequence of SharedPoint
    most : int
        How many at most.

    Returns
    -------
    list of SharedPoint
        First the loudest of each noise, and where levels differ most; then of each combination of
        labels at least one, if there is room, the others by how many points it has, but no more
        than `MOST_SILENT` that are ``none`` throughout; those of one combination in its middle,
        then as far from one another as can be.

    Examples
    --------
    >>> from noise.pages.screen_sounds import ScreenPoint, SharedPoint
    >>> labels = ["creak"] * 7 + ["none"] * 3
    >>> line = [SharedPoint(v, 0.3, (ScreenPoint(v, 0.3, label),))
    ...         for v, label in enumerate(labels)]
    >>> [(point.speed, point.labels) for point in chosen_points(line, 2)]
    [(3, ('creak',)), (8, ('none',))]
    """
    at = np.array([(point.speed, point.interference) for point in points])
    span = np.ptp(at, axis=0)
    at = at / np.where(span > 0.0, span, 1.0)
    labels = [point.labels for point in points]
    counts = Counter(labels)
    limits = {of: MOST_SILENT if set(of) <= {"none", ""} else n for of, n in counts.items()}
    certain = np.array([_is_certain(point) for point in points])
    chosen: list[int] = []

    def apart(of: tuple[str, ...], among: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return distances to chosen points of the same labels, else to their middle."""
        same = [i for i in chosen if labels[i] == of]
        if not same:
            middle = at[among].mean(axis=0)
            return np.asarray(_FAR - np.linalg.norm(at[among] - middle, axis=1))
        return np.asarray(np.linalg.norm(at[among][:, None] - at[same], axis=2).min(axis=1))

    for one in _telling(points):
        if len(chosen) < most and apart(labels[one], np.array([one]))[0] > _NEAR:
            chosen.append(one)
    while len(chosen) < most and any(limits.values()):
        shares = Counter(labels[one] for one in chosen)
        # The labels of which each sound stands for the most points; first those without any.
        of = max(
            (of for of in counts if limits[of]),
            key=lambda of: (not shares[of], counts[of] / (shares[of] or 1), of),
        )
        own = np.array([i for i, label in enumerate(labels) if label == of])
        own = own[certain[own]] if certain[own].any() else own
        distance = apart(of, own)
        if shares[of] >= limits[of] or distance.max() <= _NEAR:
            limits[of] = 0
        else:
            chosen.append(int(own[distance.argmax()]))
    return sorted((points[i] for i in chosen), key=lambda point: (point.speed, point.interference))


def _telling(points: Sequence[SharedPoint]) -> list[int]:
    """Return the indices of the loudest points and of the largest level differences."""
    loudest = []
    for own in zip(*(shared.points for shared in points), strict=True):
        for label in _NOISES:
            levels = [
                (point.level, number)
                for number, point in enumerate(own)
                if point is not None and point.label == label and point.level is not None
            ]
            loudest += [(*max(levels), label)] if levels else []
    loudest.sort(reverse=True)
    of_label: dict[str, int] = {}
    for _, number, label in loudest:
        of_label.setdefault(label, number)
    levels_of = np.array([[_level(point) for point in shared.points] for shared in points])
    apart = np.nanmax(levels_of, axis=1) - np.nanmin(levels_of, axis=1)
    certain = np.array([_is_certain(shared) for shared in points])
    apart = np.where(certain, apart, 0.0) if certain.any() else apart
    differing = [int(apart.argmax())] if apart.max() > 0.0 else []
    return list(dict.fromkeys([*of_label.values(), *differing, *(one for _, one, _ in loudest)]))


def _is_certain(shared: SharedPoint) -> bool:
    """Whether label and level of all designs are simulated at a point."""
    return all(point is None or point.how != INTERPOLATED for point in shared.points)


def _level(point: ScreenPoint | None) -> float:
    if point is None:
        return np.nan
    return _SILENCE if point.label == "none" or point.level is None else point.level


def simulated_entries(
    jobs: Sequence[tuple[ScreenMap, Rig, ScreenPoint]], *, seed: int, workers: int = 1
) -> list[Entry | str]:
    """Simulate the sounds of points with a common seed.

    Parameters
    ----------
    jobs : sequence of (ScreenMap, Rig, ScreenPoint)
    seed : int
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    list of (Entry or str)
        Of each; why it cannot be heard where it cannot.
    """

    def entry(job: tuple[ScreenMap, Rig, ScreenPoint]) -> Entry | str:
        try:
            return simulated_entry(*job, seed=seed)
        except BushingNoiseError as error:
            return str(error)

    if not jobs:
        return []
    with one_thread():
        work = Parallel(n_jobs=workers, prefer="threads", return_as="generator")
        done = work(delayed(entry)(job) for job in jobs)
        return list(track(done, "simulating sounds", unit="sound", total=len(jobs)))


def simulated_entry(screened: ScreenMap, rig: Rig, point: ScreenPoint, *, seed: int) -> Entry:
    """Simulate the sound of a point of a screen.

    Raises
    ------
    ParameterError
        The condition cannot be simulated.
    """
    support = screened.support_stiffness
    run = simulate(
        rig,
        point.speed if point.frequency is None else swing(point.speed, point.frequency),
        interference=1e-3 * point.interference,
        seconds=SECONDS,
        acquisition=Acquisition(rate=RATE),
        rng=np.random.default_rng(seed),
        support_stiffness=_SUPPORT if support is None else support,
        temperature=_TEMPERATURE if screened.temperature is None else screened.temperature,
    )
    sound = audible(run.recording, RATE).astype(np.float32)
    note = f"simulated, {a_weighted_level(run.recording['pressure'], RATE):.0f} dB(A)"
    if point.label == PERSISTS:
        note += " from rest; a vibration that runs already goes on"
    if point.how == INTERPOLATED:
        level = "" if point.level is None else f", {point.level:.0f} dB(A)"
        note += f"; the screen interpolates {point.label}{level}"
    return Entry(
        title=f"{screened.design}: {point.speed:.3g} rad/s, {point.interference:.3g} mm, "
        f"{screened.where}",
        rows=({"label": "none" if point.label == PERSISTS else point.label},),
        condition=replace(run.recording.condition, material=screened.design),
        duration=SECONDS,
        sound=sound,
        note=note,
        fast_levels=recorded_levels(run.recording),
    )
