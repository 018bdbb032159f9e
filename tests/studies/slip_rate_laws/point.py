"""A point of the search: what a law leaves open, and the constants of a condition that follow.

What the thesis prints is kept: inertias, k_E, the torque of 8 Nm at 0.279 mm and 5 rad/s. Torques
at 0.178 mm are half those at 0.279 mm (5.2.1). Stiffness, damping and renewal of the contact go
with T_kin, and so does W from fit to fit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from scipy.optimize import brentq

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["START", "UNKNOWNS", "constants", "unknowns"]

_J_E, _J_C = 1.0 / 65000.0, 1.0 / 1200.0
_K_E = {0.178: 430.0, 0.279: 665.0, 0.381: 1011.0}
_LONG, _SHORT = 2214.0, 3745.0
_TORQUE, _AT = 8.0, 5.0

START = {
    "K": 1379.0, "S": 7.535e-5, "D": 1.389e-4, "tau": 2.76e-4, "dT": 4.358, "W": 0.1875,
    "vw": 18.79, "share": 0.3648, "cl": 0.07212, "c37": 0.04957, "cf": 0.0699, "ct": 0.7206,
    "ctf": 0.8287, "Tk3": 34.0, "dT3": 9.7, "c3": 0.28, "c3s": 0.15, "c3f": 0.04095,
}  # fmt: skip
"""The shipped material: K and S over T_kin, D at 0.279 mm; dT and W there, Tk3 and dT3 at 0.381 mm
[Nm]; cl, c37, cf at 0.279 mm, ct and ctf times those at 0.178 mm, c3, c3s, c3f [Nm s/rad]."""

UNKNOWNS = {
    "shipped": {},
    "brush": {"s": 0.0, "a": 0.0, "v0": 5.0, "mu": 0.0, "lam": 0.0, "chi": 0.0, "tm": 2e-3},
    "front": {"eps": 0.0, "ks": 100.0, "kap": 0.3},
    "normal": {"gam": 0.0, "om": 880.0, "zeta": 0.08},
    "stiffness": {"s1": 0.0, "s2": 0.0},
}
"""What a law adds, in the order of `laws.simulate`, at its limit: the shipped law."""


def unknowns(law: str, point: Mapping[str, float]) -> list[float]:
    """Numbers that a law adds, of a point or of its limit."""
    return [point.get(name, limit) for name, limit in UNKNOWNS[law].items()]


def constants(
    law: str, point: Mapping[str, float], millimetres: float, support: float
) -> list[float]:
    """Constants of a condition, in the order of `laws`."""
    thin = _kinetic(law, point)
    kinetic = {0.178: 0.5 * thin, 0.279: thin, 0.381: point["Tk3"]}[millimetres]
    drop = {0.178: 0.5 * point["dT"], 0.279: point["dT"], 0.381: point["dT3"]}[millimetres]
    grown = kinetic / thin
    fixed = math.isinf(support)
    damping, share = _damping(point, millimetres, support), point["share"]
    return [
        _K_E[millimetres], 0.0 if fixed else support, share * damping, (1.0 - share) * damping,
        1.0 / _J_E, 0.0 if fixed else 1.0 / _J_C, point["K"] * kinetic, point["S"] * kinetic,
        kinetic, drop, point["D"] * grown, point["tau"], point["W"] * grown, point["vw"],
    ]  # fmt: skip


def _kinetic(law: str, point: Mapping[str, float]) -> float:
    """T_kin at 0.279 mm, with which steady sliding takes 8 Nm at 5 rad/s."""
    age = point["D"] / _AT
    rise = 1.0
    if law == "brush":
        _, a, v0, *_ = unknowns(law, point)
        rise += a * _AT / (_AT + v0)
    more = rise * point["dT"] * age / (age + point["tau"])
    more += point["W"] * math.exp(-((_AT / point["vw"]) ** 2))
    if law != "normal":
        return _TORQUE - more
    gam = unknowns(law, point)[0]

    def excess(kinetic: float) -> float:
        pressure = (1.0 - gam) / max(1.0 - gam * (kinetic + more) / kinetic, 1e-3)
        return pressure * (kinetic + more) - _TORQUE

    return brentq(excess, 0.1, 12.0)


def _damping(point: Mapping[str, float], millimetres: float, support: float) -> float:
    names = {_LONG: ("cl", "c3"), _SHORT: ("c37", "c3s")}.get(support, ("cf", "c3f"))
    if millimetres == 0.381:
        return point[names[1]]
    thinner = 1.0 if millimetres == 0.279 else point["ctf" if math.isinf(support) else "ct"]
    return thinner * point[names[0]]
