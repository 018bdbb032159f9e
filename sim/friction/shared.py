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

from numba import njit

from sim.parameters import Parameter

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


@njit(cache=True, error_model="numpy")
def shear_speed(v: float, slip_shear: float) -> float:
    """Return w [rad/s] at the sliding speed v; `slip_shear` is g / K [rad]."""
    ratio = v / (FASTEST * slip_shear)
    return v / math.sqrt(1.0 + ratio * ratio)
