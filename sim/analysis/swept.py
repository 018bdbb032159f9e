"""Result of a sweep: features by name, with the conditions that they belong to.

It is the dictionary of arrays that programs take, and knows beside it what a table or a picture of
them needs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from models.condition import Condition
from models.drawing import CURVES, axes_or_new
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray
    from pandas import DataFrame

__all__ = ["FEATURE_WORDS", "SweptFeatures"]

FEATURE_WORDS = {
    "slip_count": "Number of slips",
    "slip_frequency": "Slips a second [Hz]",
    "stick_fraction": "Share of the time in stick",
    "torque_mean": "Mean torque [Nm]",
    "torque_rms": "Torque about its mean, rms [Nm]",
    "torque_min": "Lowest torque [Nm]",
    "torque_max": "Highest torque [Nm]",
    "clamp_speed_rms": "Speed of the clamp, rms [rad/s]",
}
"""What features are called on an axis."""

_MOST_NAMED = 12
"""Curves that a legend tells apart."""


class SweptFeatures(dict[str, "NDArray[np.float64]"]):
    """Features of all runs of a sweep, by name; arrays have the shape of the sweep.

    Parameters
    ----------
    features : mapping of str to ndarray, shape (...)
        By `sim.analysis.sweep.FEATURES`.
    conditions : mapping of str to ndarray
        Of the same shape: ``rig``, ``speed`` [rad/s] or how the shaft turned, ``interference`` [m]
        and ``support_stiffness`` [Nm/rad].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.analysis.sweep import Sweep
    >>> found = Sweep(load_material_rig("fluorocarbon-thesis"), [1.0, 5.0], seconds=0.3).features()
    >>> found["slip_frequency"].round(), list(found)[:2]
    (array([153., 640.]), ['slip_count', 'slip_frequency'])
    """

    def __init__(
        self,
        features: Mapping[str, NDArray[np.float64]],
        conditions: Mapping[str, NDArray[np.object_]],
    ) -> None:
        super().__init__(features)
        self.conditions = conditions

    def plot(self, feature: str = "slip_frequency", ax: Axes | None = None) -> Axes:
        """Draw a feature over the speed, one curve for each bushing, fit and support.

        Parameters
        ----------
        feature : str
            One of `sim.analysis.sweep.FEATURES`.
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is no such feature, or the speeds are no numbers.

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from models.rig_file import load_material_rig
        >>> from sim.analysis.sweep import Sweep
        >>> found = Sweep(load_material_rig("PDMS"), [1.0, 5.0], seconds=0.01).features()
        >>> found.plot("torque_mean", Figure().subplots()).get_ylabel()
        'Mean torque [Nm]'
        """
        if feature not in self:
            raise ParameterError(f"feature {feature!r} is not known; use one of {', '.join(self)}")
        speed = self.conditions["speed"].ravel()
        if not all(isinstance(one, float) for one in speed):
            raise ParameterError("speeds that change in a run are no axis; draw constant ones")
        names = [tuple(_condition(run).words[:-1]) for run in _runs(self.conditions)]
        shared = set.intersection(*(set(name) for name in names)) if names else set()
        values = self[feature].ravel()
        with axes_or_new(ax) as axes:
            curves = list(dict.fromkeys(names))
            for number, name in enumerate(curves):
                of_it = np.array([index for index, other in enumerate(names) if other == name])
                of_it = of_it[np.argsort(speed[of_it].astype(np.float64), kind="stable")]
                axes.plot(
                    speed[of_it].astype(np.float64), values[of_it], ".-",
                    color=CURVES[number % len(CURVES)],
                    label=", ".join(word for word in name if word not in shared),
                )  # fmt: skip
            axes.set_xlabel("Speed of the shaft [rad/s]")
            axes.set_ylabel(FEATURE_WORDS.get(feature, feature))
            title = ", ".join(word for word in curves[0] if word in shared) if curves else ""
            axes.set_title(title, loc="left")
            if 1 < len(curves) <= _MOST_NAMED:
                axes.legend(loc="best")
        return axes

    def to_pandas(self) -> DataFrame:
        """Return one row a run as a data frame of pandas: its conditions, then its features.

        Returns
        -------
        pandas.DataFrame
            ``material``, ``speed_rad_s`` (or how the shaft turned, in words), ``interference_mm``,
            ``support_stiffness_Nm_rad`` (``fixed`` for the bolted clamp), and the features by name.

        Raises
        ------
        ParameterError
            pandas is not installed.

        Examples
        --------
        >>> from importlib.util import find_spec
        >>> from models.rig_file import load_material_rig
        >>> from sim.analysis.sweep import Sweep
        >>> found = Sweep(load_material_rig("PDMS"), [1.0, 5.0], seconds=0.01).features()
        >>> if find_spec("pandas"):
        ...     assert found.to_pandas()["speed_rad_s"].tolist() == [1.0, 5.0]
        """
        from models.show import data_frame

        rows = [
            {
                "material": run["rig"].material,
                "speed_rad_s": run["speed"] if isinstance(run["speed"], float) else _words(run)[-1],
                "interference_mm": round(1e3 * run["interference"], 6),
                "support_stiffness_Nm_rad": (
                    support if math.isfinite(support := run["support_stiffness"]) else "fixed"
                ),
                **{name: float(self[name].ravel()[index]) for name in self},
            }
            for index, run in enumerate(_runs(self.conditions))
        ]
        return data_frame([*rows[0]] if rows else [*self], rows)

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.conditions["rig"].shape)) or "one"
        return f"SweptFeatures({', '.join(self)}; {shape} runs)"


def _runs(conditions: Mapping[str, NDArray[np.object_]]) -> list[dict[str, Any]]:
    flat = {name: values.ravel() for name, values in conditions.items()}
    size = next(iter(flat.values())).size
    return [{name: values[index] for name, values in flat.items()} for index in range(size)]


def _condition(run: Mapping[str, Any]) -> Condition:
    return Condition(
        speed=run["speed"] if isinstance(run["speed"], float) else None,
        interference=run["interference"],
        support_stiffness=run["support_stiffness"],
        material=run["rig"].material,
    )


def _words(run: Mapping[str, Any]) -> list[str]:
    words = _condition(run).words
    return words if isinstance(run["speed"], float) else [*words, str(run["speed"])]
