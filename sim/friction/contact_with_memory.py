r"""Elastic contact that remembers how long it has touched.

.. math::
    \dot z &= v - K |v| z / g(\varphi, v), \qquad T = K z + \sigma \dot z \\
    \dot\varphi &= 1 - |v| \varphi / D \\
    g &= T_{kin} + (T_{crit} - T_{kin}) \frac{\varphi}{\varphi + \tau}
         + \beta T_{kin} e^{-|v| / v_w}

z is the shear of the contact [rad], phi its age [s]: in stick it grows with time, in sliding it
settles at D/|v|. So the contact gives way gradually during stick, regains strength with time, and
its torque falls with sliding speed; without the last, nothing sustains itself. After the bristle
contact of Canudas de Wit et al. (1995) and the rate-and-state laws of Dieterich and Ruina (1983),
whose ageing here saturates. Stiffness and damping of the contact go with the real area of
contact, hence with T_kin.

Limits: steady sliding at speed v gives T = g(D/|v|, v); tau -> infinity and beta = 0 give a
constant T_kin; at rest for long, T may rise to T_crit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from sim.friction.law import RATES_SIGNATURE, FrictionLaw
from sim.parameters import Parameter

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.rig import Fit

__all__ = ["LAW"]

_LONG_REST = 1.0
"""Age of the contact at the start [s], long against any tau."""

_PARAMETERS = {
    "contact_stiffness_per_torque": Parameter(
        1700.0, "1/rad", 1.0, 1e5, "K / T_kin: shear stiffness of the contact"
    ),
    "contact_damping_per_torque": Parameter(
        9e-5, "s/rad", 0.0, 1e-2, "sigma / T_kin: damping of the contact's shear"
    ),
    "renewal_angle": Parameter(
        4e-4, "rad", 1e-7, 1.0, "D: sliding distance over which the contact is renewed"
    ),
    "ageing_time": Parameter(4e-4, "s", 1e-7, 1e3, "tau: time in which strength is regained"),
    "weakening_share": Parameter(
        0.0, "", 0.0, 10.0, "beta: torque that fades with speed, over T_kin"
    ),
    "weakening_speed": Parameter(20.0, "rad/s", 1e-3, 1e4, "v_w: speed over which it fades"),
}


def _coefficients(fit: Fit, values: Mapping[str, float]) -> NDArray[np.float64]:
    t_kin = fit.kinetic_torque
    return np.array(
        [
            values["contact_stiffness_per_torque"] * t_kin,
            values["contact_damping_per_torque"] * t_kin,
            values["renewal_angle"],
            values["ageing_time"],
            t_kin,
            fit.critical_torque - t_kin,
            values["weakening_share"] * t_kin,
            values["weakening_speed"],
        ]
    )


def _initial_state(coefficients: NDArray[np.float64]) -> NDArray[np.float64]:  # noqa: ARG001
    return np.array([0.0, _LONG_REST])


@njit(RATES_SIGNATURE, cache=True, error_model="numpy")
def _rates(v, state, c, state_rates):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    stiffness, damping, renewal_angle, ageing_time = c[0], c[1], c[2], c[3]
    z, age = state[0], state[1]
    speed = abs(v)
    strength = c[4] + c[5] * age / (age + ageing_time) + c[6] * math.exp(-speed / c[7])
    state_rates[0] = v - stiffness * speed * z / strength
    state_rates[1] = 1.0 - speed * age / renewal_angle
    return stiffness * z + damping * state_rates[0]


LAW = FrictionLaw(
    name="contact_with_memory",
    parameters=_PARAMETERS,
    coefficients=_coefficients,
    initial_state=_initial_state,
    rates=_rates,
)
