"""Unknowns of the fluorocarbon, which no source gives, and the rig that they make.

The contact has memory (`sim.friction.contact_with_memory`). Its torque at 5 rad/s is held at the
8 Nm of Appendix F, so the level is no unknown. Torque, stiffness and damping of the contact at
0.178 and 0.381 mm are those at 0.279 mm times a half and three, as the mean torques are (5.2.1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED
from models.rig import LawSpec
from models.rig_files.rig_file import load_material_rig

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from models.rig import Fit, Rig

__all__ = ["UNKNOWNS", "Unknown", "rig_of", "start", "values_at"]

MEAN_TORQUE = 8.0
"""At 0.279 mm and 5 rad/s [Nm], Appendix F."""

_TORQUE_RATIOS = {0.178e-3: 0.5, 0.279e-3: 1.0, 0.381e-3: 3.0}
_THIN_DAMPING_RATIO = 0.87
"""Of c_E at 0.178 mm, not measured, to that at 0.279 mm; chosen by hand for V_crit2 there."""

_SPEED = 5.0

_EXPONENT = 2.0
"""Of the weakening. With 1 the best searches left V_crit2 at 3745 Nm/rad 15 % low."""


@dataclass(frozen=True)
class Unknown:
    """A number to be searched, on a logarithmic scale.

    Parameters
    ----------
    start, round_start, low, high : float
        Where the search begins, where it does with a cell left out, which must not know what
        searches on all cells found, and what it may not leave [in `unit`].
    unit, description : str
    """

    start: float
    round_start: float
    low: float
    high: float
    unit: str
    description: str


UNKNOWNS: Mapping[str, Unknown] = {
    "contact_stiffness": Unknown(8390.0, 1e4, 1e3, 6e4, "Nm/rad", "K"),
    "contact_damping": Unknown(4.9e-4, 1e-3, 1e-5, 1e-2, "Nm s/rad", "sigma"),
    "renewal_angle": Unknown(2.82e-4, 3e-4, 2e-5, 1e-2, "rad", "D"),
    "ageing_time": Unknown(6.84e-4, 5e-4, 2e-5, 1e-1, "s", "tau"),
    "torque_drop": Unknown(5.87, 3.0, 0.1, 40.0, "Nm", "T_crit - T_kin"),
    "weakening": Unknown(0.168, 0.3, 1e-3, 6.0, "Nm", "torque that fades with speed"),
    "weakening_speed": Unknown(20.3, 20.0, 2.0, 200.0, "rad/s", "v_w"),
    "elastomer_damping_share": Unknown(0.198, 0.2, 0.02, 0.9, "1", "of c_E"),
    "fixed_damping": Unknown(0.1146, 0.1, 0.02, 0.3, "Nm s/rad", "c_E with the clamp fixed"),
}
"""They begin where rougher searches of the same kind ended; those knew all cells."""


def start(*, rounded: bool = False) -> NDArray[np.float64]:
    """Logarithms of where a search begins, or begins with a cell left out, shape (n_unknowns,)."""
    return np.log([u.round_start if rounded else u.start for u in UNKNOWNS.values()])


def values_at(point: ArrayLike) -> dict[str, float]:
    """Values of the unknowns at a point of the search.

    Parameters
    ----------
    point : array_like, shape (n_unknowns,)
        Logarithms; beyond the limits the nearest limit counts.

    Examples
    --------
    >>> round(values_at(start(rounded=True))["torque_drop"], 2)
    3.0
    """
    return {
        name: min(max(math.exp(logarithm), unknown.low), unknown.high)
        for (name, unknown), logarithm in zip(
            UNKNOWNS.items(), np.asarray(point, dtype=np.float64).tolist(), strict=True
        )
    }


def rig_of(values: Mapping[str, float]) -> Rig | None:
    """Return the rig that the values make; None where they leave no kinetic torque.

    Examples
    --------
    >>> round(rig_of(values_at(start(rounded=True))).fit(0.279e-3).kinetic_torque, 2)
    7.4
    """
    base = load_material_rig("fluorocarbon")
    age = values["renewal_angle"] / _SPEED
    kinetic = (
        MEAN_TORQUE
        - values["torque_drop"] * age / (age + values["ageing_time"])
        - values["weakening"] * math.exp(-((_SPEED / values["weakening_speed"]) ** _EXPONENT))
    )
    if kinetic <= 0.1 * MEAN_TORQUE:
        return None

    damping = {**base.fit(0.279e-3).damping, FIXED: values["fixed_damping"]}

    def fitted(fit: Fit) -> Fit:
        ratio = _TORQUE_RATIOS[round(fit.interference, 6)]
        return replace(
            fit,
            kinetic_torque=ratio * kinetic,
            critical_torque=ratio * (kinetic + values["torque_drop"]),
            damping=_thinned(damping) if ratio < 1.0 else {**fit.damping, FIXED: damping[FIXED]},
        )

    return replace(
        base,
        fits=tuple(fitted(fit) for fit in base.fits),
        friction=LawSpec(
            "contact_with_memory",
            {
                "contact_stiffness_per_torque": values["contact_stiffness"] / kinetic,
                "contact_damping_per_torque": values["contact_damping"] / kinetic,
                "renewal_angle": values["renewal_angle"],
                "ageing_time": values["ageing_time"],
                "weakening_share": values["weakening"] / kinetic,
                "weakening_speed": values["weakening_speed"],
                "weakening_exponent": _EXPONENT,
            },
        ),
        elastomer_damping_share=values["elastomer_damping_share"],
        effects=(),
    )


def _thinned(damping: Mapping[float, float]) -> dict[float, float]:
    return {support: _THIN_DAMPING_RATIO * value for support, value in damping.items()}
