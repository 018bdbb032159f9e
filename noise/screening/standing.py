"""Critical speeds and margins of each map, standing of each design, and its rank among all.

V_crit1 is the last speed of the map at which it sticks and slips, V_crit2 the last at which it
vibrates (`sim.analysis.critical_speeds`), be it that the vibration only persists there. A map
knows them to a step: the true one lies between that speed and the next of the map. Margins are to
the safe side, from the next speed: the distance of the use from the speeds that vibrate, positive
where no speed of use does, negative where some do, and by how much the use would have to move.
Stability gives the last speed at which steady sliding cannot last; a vibration may outlive it, and
of a constant kinetic torque it says nothing.

Designs are ranked by one number, the mean loudness of their use: a condition counts 2 to the power
of (L_AFmax - 40 dB) / 10, Stevens' rule that ten decibels are twice as loud, and nothing where
there is no noise; a vibration that only persists counts as what is heard of it. The worst of a
design's environments and motions counts, and the larger margin decides between equals.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.show import short_repr
from noise.base.labels import PERSISTS
from noise.screening.advice import Offer
from noise.screening.grid import Grid
from noise.screening.mapping import DesignMap
from noise.screening.parts import NoisyParts
from noise.screening.vibration import Condition
from sim.analysis.regime import Regime

SHARED = ("creak", "squawk", "squeal", "none", PERSISTS)
"""Labels of a map whose shares are reported."""


def critical_speeds_of(mapped: DesignMap) -> dict[str, NDArray[np.float64]]:
    """Return critical speeds and margins by temperature, support and fit; none for a swing.

    Parameters
    ----------
    mapped : DesignMap

    Returns
    -------
    dict of str to ndarray, shape (n_temperatures, n_supports, n_fits)
        ``v_crit1`` and ``v_crit2`` by simulation, and ``v_crit2_stability``, each the last speed of
        the map at which it sticks, vibrates or slides unstably; 0 if there is none, ``inf`` beyond
        the map. ``..._high`` is the next speed. Margins of the use to stick-slip, to what vibrates
        and to unstable sliding are positive where no speed of use does [rad/s].
    """
    if mapped.motion != "steady":
        return {}
    speed = np.array(mapped.grid.speed)
    happens = {
        ("v_crit1", "margin_v_crit1"): mapped.regime == Regime.STICK_SLIP.value,
        ("v_crit2", "margin_v_crit2"): mapped.regime != Regime.STEADY_SLIDING.value,
        ("v_crit2_stability", "margin_stability"): mapped.growth > 0.0,
    }
    shape = mapped.grid.shape[:3]
    critical: dict[str, NDArray[np.float64]] = {}
    for (name, margin), there in happens.items():
        columns = name, f"{name}_high", margin
        critical |= {column: np.empty(shape) for column in columns}
        for at in np.ndindex(shape):
            last, span = safe_range(speed, there[at])
            values = last, span[1], margin_of(span, mapped.grid.use)
            for column, value in zip(columns, values, strict=True):
                critical[column][at] = value
    return critical


def safe_range(
    speed: NDArray[np.float64], happens: NDArray[np.bool_]
) -> tuple[float, tuple[float, float]]:
    """Return the last speed at which something happens, and the speeds between which it may.

    Parameters
    ----------
    speed : ndarray, shape (n,)
        Rising [rad/s].
    happens : ndarray of bool, shape (n,)

    Returns
    -------
    last : float
        [rad/s]; 0 if it never happens, ``inf`` if at the fastest.
    span : (float, float)
        Neighbours of the first and the last at which it does not [rad/s]; 0 and ``inf`` beyond the
        ends, ``inf`` and 0 where it never happens.

    Examples
    --------
    >>> safe_range(np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, True, False]))
    (3.0, (1.0, 4.0))
    """
    where = np.flatnonzero(happens)
    if where.size == 0:
        return 0.0, (math.inf, 0.0)
    first, last = int(where[0]), int(where[-1])
    low = float(speed[first - 1]) if first else 0.0
    if last == speed.size - 1:
        return math.inf, (low, math.inf)
    return float(speed[last]), (low, float(speed[last + 1]))


def margin_of(span: tuple[float, float], use: tuple[float, float]) -> float:
    """Return the distance of a use from a range of speeds [rad/s], negative where they overlap.

    Examples
    --------
    >>> margin_of((0.0, 4.0), (5.0, 13.0)), margin_of((0.0, 8.0), (5.0, 13.0))
    (1.0, -3.0)
    >>> margin_of((math.inf, 0.0), (5.0, 13.0))
    inf
    """
    if span[0] > span[1]:
        return math.inf
    return max(use[0] - span[1], span[0] - use[1])


@short_repr
@dataclass(frozen=True)
class Standing:
    """Result of a design in one environment and motion.

    Parameters
    ----------
    mapped : DesignMap
    critical : dict of str to ndarray, shape (n_temperatures, n_supports, n_fits)
        Critical speeds and margins of `critical_speeds_of` [rad/s].
    mean_loudness : float
        Of the use [sone].
    shares : dict of str to float
        Of the points of use, by label [-].
    loudest : Condition, optional
        Loudest condition of use; None where all are silent.
    loudest_label : str
        Its noise, ``none`` if there is none.
    loudest_level, loudest_level_max : float
        Its L_Aeq and L_AFmax [dB re 20 uPa]; NaN if there is none.
    rank : int
        Of the design among all, 1 being quietest.
    offers : tuple of Offer
        Changes that end the loudest noise of use, and those that do not.
    parts : NoisyParts, optional
        Of its parts within tolerances, where they were looked at.
    notes : tuple of str
        Remarks on its data.
    """

    mapped: DesignMap
    critical: dict[str, NDArray[np.float64]]
    mean_loudness: float
    shares: dict[str, float]
    loudest: Condition | None
    loudest_label: str
    loudest_level: float
    loudest_level_max: float
    rank: int = 0
    offers: tuple[Offer, ...] = ()
    parts: NoisyParts | None = None
    notes: tuple[str, ...] = ()

    @property
    def design(self) -> str:
        """Name of the design."""
        return self.mapped.design

    @property
    def place(self) -> str:
        """Environment, and motion where the shaft swings."""
        one = self.mapped
        return one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}"

    def worst(self, name: str) -> float:
        """Return a critical speed or margin at its worst fit, support and temperature [rad/s].

        Parameters
        ----------
        name : str
            Of `critical`; of speeds the largest is the worst, of margins the smallest.

        Returns
        -------
        float
            [rad/s]; NaN where the shaft swings.
        """
        if name not in self.critical:
            return math.nan
        values = self.critical[name]
        return float(values.min() if name.startswith("margin") else values.max())


def standing_of(mapped: DesignMap) -> Standing:
    """Return the standing of a mapped design, without rank.

    Parameters
    ----------
    mapped : DesignMap

    Returns
    -------
    Standing
    """
    used = mapped.grid.used
    label, sound, level, level_max = (
        each[..., used] for each in (mapped.label, mapped.sound, mapped.level, mapped.level_max)
    )
    noisy = (sound != "none") & np.isfinite(level)
    loudest = np.unravel_index(np.argmax(np.where(noisy, level, -np.inf)), level.shape)
    any_noise = bool(noisy.any())
    sone = 2.0 ** ((level_max[noisy] - 40.0) / 10.0)
    return Standing(
        mapped=mapped,
        critical=critical_speeds_of(mapped),
        mean_loudness=float(np.sum(sone) / label.size),
        shares={name: float(np.mean(label == name)) for name in SHARED},
        loudest=condition_at(mapped.grid, loudest) if any_noise else None,
        loudest_label=str(sound[loudest]) if any_noise else "none",
        loudest_level=float(level[loudest]) if any_noise else math.nan,
        loudest_level_max=float(level_max[loudest]) if any_noise else math.nan,
    )


def condition_at(grid: Grid, at: Sequence[int | np.integer]) -> Condition:
    """Return the condition at a point of use, by its indices among the speeds of use."""
    t, k, i, v = (int(n) for n in at)
    columns = np.flatnonzero(grid.used)
    return Condition(
        grid.speed[columns[v]],
        grid.interference[i],
        grid.support_stiffness[k],
        grid.temperature[t],
        grid.frequency[columns[v]] if grid.frequency else None,
    )


def ranked(standings: Sequence[Standing]) -> tuple[Standing, ...]:
    """Rank designs by mean loudness and then by margin, the quietest first.

    Parameters
    ----------
    standings : sequence of Standing
        Of designs in environments and motions; the worst of each design counts.

    Returns
    -------
    tuple of Standing
        Equals share a rank.
    """
    keys: dict[str, tuple[float, float]] = {}
    for one in standings:
        margin = one.worst("margin_v_crit2")
        key = round(one.mean_loudness, 6), math.inf if math.isnan(margin) else -margin
        keys[one.design] = max(keys.get(one.design, key), key)
    order = sorted(keys.values())
    standings = [replace(one, rank=1 + order.index(keys[one.design])) for one in standings]
    return tuple(sorted(standings, key=lambda one: (one.rank, one.design)))
