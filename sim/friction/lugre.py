r"""LuGre friction: bristles that bend, a Stribeck curve, and a viscous torque.

.. math::
    \dot z = v - K |v| z / g(v), \qquad T = K z + \sigma_1 \dot z + \sigma_2 v, \qquad
    g = T_{kin} + (T_{crit} - T_{kin}) e^{-(v / v_s)^2}

Canudas de Wit, Olsson, Astrom and Lischinsky (1995). Steady sliding gives T = g(v) + sigma_2 v;
with T_crit = T_kin and sigma_2 > 0 the torque rises with speed and sliding is stable at any speed,
like PDMS on the rig (5.1.2).
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter

_PARAMETERS = {
    "contact_stiffness_per_torque": Parameter(
        1700.0, "1/rad", 1.0, 1e5, "K / T_kin: stiffness of the bristles"
    ),
    "contact_damping_per_torque": Parameter(
        9e-5, "s/rad", 0.0, 1e-2, "sigma_1 / T_kin: damping of the bristles"
    ),
    "stribeck_speed": Parameter(1.0, "rad/s", 1e-4, 1e3, "v_s: speed scale of the falling torque"),
    "viscous_share_per_speed": Parameter(
        0.0, "s/rad", 0.0, 10.0, "sigma_2 / T_kin: rise of the torque with speed"
    ),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness = c[0] * kinetic
    strength = kinetic + (contact[CRITICAL] - kinetic) * math.exp(-((v / c[2]) ** 2))
    state_rates[0] = v - stiffness * abs(v) * state[0] / strength
    return stiffness * state[0] + c[1] * kinetic * state_rates[0] + c[3] * kinetic * v


LAW = FrictionLaw(
    name="lugre",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
    tolerance=5e-8,
)
