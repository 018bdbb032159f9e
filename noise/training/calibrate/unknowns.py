"""Unknowns of the fluorocarbon, which no source gives, and the rig that they make.

The contact has memory (`sim.friction.contact_with_memory`). Its torque at 0.279 mm and 5 rad/s is
held at the 8 Nm of Appendix F, so the level is no unknown. Torques at 0.178 mm are half those at
0.279 mm, as the mean torques are (5.2.1); those at 0.381 mm are unknown, where the drop follows
from one figure. Stiffness, damping and renewal of the contact go with its torques. Damping of the
bushing is unknown too: with that printed for 0.279 mm there is no squawk at 2214 Nm/rad and
7.5 rad/s, nor does the thesis's own simulation stick there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.condition import FIXED
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig
from noise.thesis.runs import LONG, SHORT

MEAN_TORQUE = 8.0
"""At 0.279 mm and 5 rad/s [Nm], Appendix F."""

_THIN = 0.5
"""Torques at 0.178 mm over those at 0.279 mm."""

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
    "contact_stiffness": Unknown(10240.0, 1e4, 1e3, 6e4, "Nm/rad", "K at 0.279 mm"),
    "contact_damping": Unknown(0.0005596, 8e-4, 1e-5, 1e-2, "Nm s/rad", "sigma at 0.279 mm"),
    "renewal_angle": Unknown(0.0001389, 2e-4, 2e-5, 1e-2, "rad", "D at 0.279 mm"),
    "ageing_time": Unknown(0.000276, 5e-4, 2e-5, 1e-1, "s", "tau"),
    "torque_drop": Unknown(4.358, 4.0, 0.1, 40.0, "Nm", "T_crit - T_kin at 0.279 mm"),
    "weakening": Unknown(0.1875, 0.2, 1e-3, 6.0, "Nm", "torque that fades with speed"),
    "weakening_speed": Unknown(18.79, 20.0, 2.0, 200.0, "rad/s", "v_w"),
    "elastomer_damping_share": Unknown(0.3648, 0.3, 0.02, 0.9, "1", "of c_E"),
    "long_damping": Unknown(0.07212, 0.08, 0.06, 0.105, "Nm s/rad", "c_E at 0.279 mm, 2214"),
    "short_damping": Unknown(0.04957, 0.06, 0.04, 0.1, "Nm s/rad", "c_E at 0.279 mm, 3745"),
    "fixed_damping": Unknown(0.0699, 0.08, 0.02, 0.3, "Nm s/rad", "c_E with the clamp fixed"),
    "thin_damping_ratio": Unknown(0.7314, 0.7, 0.4, 1.6, "1", "c_E at 0.178 mm over 0.279 mm"),
    "thin_fixed_ratio": Unknown(0.8287, 0.8, 0.4, 3.0, "1", "the same with the clamp fixed"),
    "tight_kinetic": Unknown(34.0, 30.0, 15.0, 36.0, "Nm", "T_kin at 0.381 mm"),
    "tight_drop": Unknown(9.7, 9.0, 2.0, 60.0, "Nm", "T_crit - T_kin at 0.381 mm"),
    "tight_damping": Unknown(0.28, 0.25, 0.05, 0.4, "Nm s/rad", "c_E at 0.381 mm, 2214"),
    "tight_short_damping": Unknown(0.15, 0.12, 0.05, 0.3, "Nm s/rad", "c_E at 0.381 mm, 3745"),
    "tight_fixed_damping": Unknown(0.04095, 0.06, 0.02, 0.3, "Nm s/rad", "the same, clamp fixed"),
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
    4.0
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
    7.52
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
    long, short, fixed = (values[f"{of}_damping"] for of in ("long", "short", "fixed"))
    thin = values["thin_damping_ratio"]
    made = {
        0.178e-3: (
            _THIN * kinetic, _THIN * values["torque_drop"],
            (thin * long, thin * short, values["thin_fixed_ratio"] * fixed),
        ),
        0.279e-3: (kinetic, values["torque_drop"], (long, short, fixed)),
        0.381e-3: (
            values["tight_kinetic"], values["tight_drop"],
            (values["tight_damping"], values["tight_short_damping"], values["tight_fixed_damping"]),
        ),
    }  # fmt: skip

    def fitted(fit: Fit) -> Fit:
        torque, drop, damping = made[round(fit.interference, 6)]
        return replace(
            fit, kinetic_torque=torque, critical_torque=torque + drop,
            damping=dict(zip((LONG, SHORT, FIXED), damping, strict=True)),
        )  # fmt: skip

    return replace(
        base,
        fits=tuple(fitted(fit) for fit in base.fits),
        friction=LawSpec(
            "contact_with_memory",
            {
                "contact_stiffness_per_torque": values["contact_stiffness"] / kinetic,
                "contact_damping_per_torque": values["contact_damping"] / kinetic,
                "renewal_angle": 0.0,
                "ageing_time": values["ageing_time"],
                "weakening_share": values["weakening"] / kinetic,
                "weakening_speed": values["weakening_speed"],
                "weakening_exponent": _EXPONENT,
                "renewal_angle_per_torque": values["renewal_angle"] / kinetic,
            },
        ),
        elastomer_damping_share=values["elastomer_damping_share"],
        effects=(),
    )
