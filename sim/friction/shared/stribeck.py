r"""The common part of the Stribeck laws: two scales of weakening on an elastic contact.

.. math::
    g = T_{kin} + (T_{crit} - T_{kin}) [(1 - s) f(v / v_1) + s f(v / v_2)], \qquad f(0) = 1

The laws differ in f alone; the contact is that of `sim.friction.shared.bristle`. The two drops, dT1
= (1 - s) dT and dT2 = s dT, share what the fit gives as the difference of its torques, so that
T_crit remains the torque at rest whatever s is, and s = 0 leaves one scale.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from numba import njit

from sim.contact import CRITICAL, KINETIC
from sim.friction.shared.bristle import BRISTLE_PARAMETERS, shear_speed
from sim.parameters import Parameter

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["STRIBECK_PARAMETERS", "stribeck_torque"]

STRIBECK_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "first_speed": Parameter(1.0, "rad/s", 1e-2, 1e4, "v_1: speed over which the torque falls"),
    "second_share": Parameter(0.0, "", 0.0, 1.0, "s: part of T_crit - T_kin that falls over v_2"),
    "second_speed": Parameter(15.6, "rad/s", 1e-2, 1e4, "v_2: speed over which that part falls"),
}
"""Of each Stribeck law, in the order in which its compiled function reads them."""


def _stribeck_torque(
    v: float,
    first: float,
    second: float,
    c: NDArray[np.float64],
    contact: NDArray[np.float64],
    state: NDArray[np.float64],
    state_rates: NDArray[np.float64],
) -> float:
    """Torque [Nm] at the sliding speed v, where f is `first` at v / v_1 and `second` at v / v_2."""
    kinetic = contact[KINETIC]
    stiffness, damping = c[0] * kinetic, c[1] * kinetic
    drop = contact[CRITICAL] - kinetic
    strength = kinetic + drop * ((1.0 - c[3]) * first + c[3] * second)
    w = shear_speed(v, strength / stiffness)
    state_rates[0] = w - stiffness * abs(w) * state[0] / strength
    return float(stiffness * state[0] + damping * state_rates[0])


stribeck_torque = njit(cache=True, error_model="numpy")(_stribeck_torque)
