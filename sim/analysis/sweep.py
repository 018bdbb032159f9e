"""Sweep of simulated motions over operating conditions: a table of features, and a plot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from models.condition import CONDITION, KnownCondition
from models.drawing import CURVES, axes_or_new
from models.errors import ParameterError
from models.rig import Rig
from models.show import data_frame, short_repr
from sim.analysis.regime import motion_slips
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

FEATURES = {
    "slip_count": "Slips",
    "slip_frequency": "Slip frequency [Hz]",
    "stick_fraction": "Share of the time in stick [-]",
    "torque_mean": "Mean torque [Nm]",
    "torque_rms": "Torque about its mean, rms [Nm]",
    "torque_min": "Least torque [Nm]",
    "torque_max": "Largest torque [Nm]",
    "clamp_speed_rms": "Speed of the clamp, rms [rad/s]",
}
"""Features of a motion, with axis labels. Slips are those of `sim.analysis.regime`, their frequency
is NaN for fewer than two, and stick is that of `sim.motion.Motion.stuck`."""


_RATE = 30e3
"""Rate of the motions [Hz]."""


@short_repr
@dataclass(frozen=True, eq=False)
class Sweep:
    """Features of motions at many operating conditions.

    Parameters
    ----------
    conditions : tuple of KnownCondition
    features : dict of str to ndarray, shape (n_conditions,)
        By the names of `FEATURES`, in their units.

    Examples
    --------
    >>> at = KnownCondition(speed=5.0)
    >>> Sweep((at,), {name: np.zeros(1) for name in FEATURES}).conditions[0].speed
    5.0
    """

    conditions: tuple[KnownCondition, ...]
    features: dict[str, NDArray[np.float64]]

    def to_pandas(self) -> DataFrame:
        """Return a pandas data frame with one row per run: its condition and features."""
        rows: list[dict[str, Any]] = [
            {
                "material": at.material,
                "speed_rad_s": at.speed,
                "interference_mm": round(1e3 * at.interference, 6),
                "support_stiffness_Nm_rad": CONDITION["support_stiffness"].write(
                    at.support_stiffness
                ),
                **{name: float(values[i]) for name, values in self.features.items()},
            }
            for i, at in enumerate(self.conditions)
        ]
        return data_frame([*rows[0]], rows)

    def plot(self, feature: str = "slip_frequency", ax: Axes | None = None) -> Axes:
        """Plot a feature over the speed, with one curve for each of the other conditions.

        Parameters
        ----------
        feature : str
            One of `FEATURES`.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes
        """
        curves: dict[str, list[tuple[float, float]]] = {}
        for at, value in zip(self.conditions, self.features[feature].tolist(), strict=True):
            curves.setdefault(", ".join(at.words[:-1]), []).append((at.speed, value))
        with axes_or_new(ax) as axes:
            for number, (name, points) in enumerate(curves.items()):
                colour = CURVES[number % len(CURVES)]
                axes.plot(*zip(*sorted(points), strict=True), ".-", color=colour, label=name)
            axes.set_xlabel("Speed of the shaft [rad/s]")
            axes.set_ylabel(FEATURES[feature])
            axes.legend(loc="best")
        return axes


def sweep(
    rig: Rig | Sequence[Rig],
    speed: ArrayLike,
    interference: ArrayLike = 0.279e-3,
    support_stiffness: ArrayLike = 2214.0,
    *,
    seconds: float = 1.0,
) -> Sweep:
    """Simulate the motion of one or several rigs from rest at many constant speeds.

    Parameters
    ----------
    rig : Rig or sequence of Rig
    speed, interference, support_stiffness : array_like
        [rad/s], [m] and [Nm/rad]. They and `rig` are broadcast against each other.
    seconds : float
        Length of each run [s].

    Returns
    -------
    Sweep

    Raises
    ------
    ParameterError
        A condition cannot be used, or shapes do not fit together.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> result = sweep(rig, [1.0, 12.0], support_stiffness=[[2214.0], [3745.0]], seconds=0.2)
    >>> result.features["slip_frequency"].round()
    array([153.,  nan, 150.,  nan])
    """
    numbers = [np.asarray(x, np.float64) for x in (speed, interference, support_stiffness)]
    rigs = np.array(rig if isinstance(rig, Rig) else [*rig], dtype=object)
    try:
        columns = np.broadcast_arrays(rigs, *numbers)
    except ValueError as error:
        raise ParameterError(f"sweep: the conditions do not fit together: {error}") from None
    if not np.isfinite(numbers[0]).all():
        raise ParameterError("sweep: speeds must be finite numbers [rad/s]")
    runs = [*zip(*(x.ravel().tolist() for x in columns), strict=True)]
    rows = Parallel(n_jobs=-1, prefer="threads")(delayed(_features)(*run, seconds) for run in runs)
    return Sweep(
        tuple(KnownCondition(v, fit, support, one.material) for one, v, fit, support in runs),
        dict(zip(FEATURES, np.array(rows).reshape(-1, len(FEATURES)).T, strict=True)),
    )


def _features(
    rig: Rig, speed: float, interference: float, support_stiffness: float, seconds: float
) -> list[float]:
    """Return the values of `FEATURES` at one condition."""
    motion = simulate_motion(
        rig, ConstantSpeed(speed), interference=interference,
        support_stiffness=support_stiffness, seconds=seconds, rate=_RATE,
    )  # fmt: skip
    slips, torque = motion_slips(motion), motion.torque
    return [
        slips.times.size, slips.rate, np.mean(motion.stuck), np.mean(torque), np.std(torque),
        np.min(torque), np.max(torque), np.sqrt(np.mean(motion.clamp_speed**2)),
    ]  # fmt: skip
