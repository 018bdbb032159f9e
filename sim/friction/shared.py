r"""Elastic contact shared by the friction laws without true stick.

.. math::
    \dot z = w - K |w| z / g, \qquad T = K z + \sigma \dot z, \qquad
    w = v / \sqrt{1 + (K v / (\lambda g))^2}

z is the shear of the contact [rad], g its strength [Nm]: the model of Dahl (1968) with the variable
strength of Canudas de Wit et al. (1995), in which w is the sliding speed v itself. There the shear
settles within g / (K |v|), which can be too short for any step. Here it settles within 1 / lambda
at the fastest: steady sliding, where T = g, does not change, and w differs from v only where the
contact follows its strength at once anyway.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from numba import njit

from sim.contact import CRITICAL, KINETIC
from sim.parameters import Parameter

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


FASTEST = 4e5
"""Highest rate lambda at which a contact follows its strength [1/s], for steps of 8 us."""

BRISTLE_PARAMETERS = {
    "contact_stiffness_per_torque": Parameter(
        1700.0, "1/rad", 1.0, 1e4, "K / T_kin: shear stiffness of the contact"
    ),
    "contact_damping_per_torque": Parameter(
        9e-5, "s/rad", 0.0, 1e-2, "sigma / T_kin: damping of the contact's shear"
    ),
}
"""First two parameters of each such law."""


def _shear_speed(v: float, slip_shear: float) -> float:
    """Return w [rad/s] at the sliding speed v; `slip_shear` is g / K [rad]."""
    ratio = v / (FASTEST * slip_shear)
    return v / math.sqrt(1.0 + ratio * ratio)


shear_speed = njit(cache=True, error_model="numpy")(_shear_speed)


STRIBECK_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "first_speed": Parameter(1.0, "rad/s", 1e-2, 1e4, "v_1: speed scale of the falling torque"),
    "second_share": Parameter(0.0, "", 0.0, 1.0, "s: share of T_crit - T_kin that falls over v_2"),
    "second_speed": Parameter(15.6, "rad/s", 1e-2, 1e4, "v_2: speed scale of that share"),
}
"""Parameters of each Stribeck law, in the order in which its compiled function reads them."""


def _stribeck_torque(
    v: float,
    first: float,
    second: float,
    c: NDArray[np.float64],
    contact: NDArray[np.float64],
    state: NDArray[np.float64],
    state_rates: NDArray[np.float64],
) -> float:
    """Return the torque [Nm] at sliding speed v; f is `first` at v / v_1, `second` at v / v_2."""
    kinetic = contact[KINETIC]
    stiffness, damping = c[0] * kinetic, c[1] * kinetic
    drop = contact[CRITICAL] - kinetic
    strength = kinetic + drop * ((1.0 - c[3]) * first + c[3] * second)
    w = shear_speed(v, strength / stiffness)
    state_rates[0] = w - stiffness * abs(w) * state[0] / strength
    return float(stiffness * state[0] + damping * state_rates[0])


stribeck_torque = njit(cache=True, error_model="numpy")(_stribeck_torque)
