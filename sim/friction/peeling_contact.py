r"""Elastic contact whose bonds peel off, at a torque that grows with the speed of peeling.

.. math::
    \dot z &= v - K |v| z / g(\varphi, v), \qquad T = K z + \sigma \dot z \\
    \dot\varphi &= 1 - |v| \varphi / D \\
    g &= T_{kin} + (T_{crit} - T_{kin}) \frac{\varphi}{\varphi + \tau} \sqrt{\frac{|v|}{|v| + v_p}}
         + \beta T_{kin} e^{-(|v| / v_w)^n}

The contact of `sim.friction.contact_with_memory`, with two changes. What a contact that has aged
bears beyond T_kin takes work to peel off, which in rubber grows with the speed of peeling by a
power of about a half (Gent and Schultz 1972; Maugis and Barquins 1978: 0.6) until its losses
saturate (Persson and Brener 2005). During stick the contact creeps, the faster the faster the shaft
loads it: so it lets go at a higher torque, and the rate of slips follows the speed less. And the
distance D in which the contact is renewed goes with T_kin, as K and sigma do.

Limits: steady sliding at speed v gives T = g(D/|v|, v); v_p -> 0 is `contact_with_memory`; loaded
ever more slowly the contact slips at T_kin (1 + beta), whatever its age.
"""

from __future__ import annotations

import math

from numba import njit

from sim.contact import CRITICAL, KINETIC, LAW_SIGNATURE
from sim.friction.contact_with_memory import LAW as MEMORY
from sim.friction.law import FrictionLaw
from sim.parameters import Parameter

__all__ = ["LAW"]

_PARAMETERS = {
    **{key: value for key, value in MEMORY.parameters.items() if key != "renewal_angle"},
    "renewal_angle_per_torque": Parameter(
        4e-5, "rad/Nm", 1e-6, 1e-2, "D / T_kin: sliding distance over which the contact is renewed"
    ),
    "peeling_speed": Parameter(
        0.6, "rad/s", 1e-6, 1e3, "v_p: creep at which peeling takes 0.7 of what it can"
    ),
}


@njit(LAW_SIGNATURE, cache=True, error_model="numpy")
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness, damping = c[0] * kinetic, c[1] * kinetic
    z, age = state[0], state[1]
    speed = abs(v)
    power = speed / c[4]
    if c[5] == 2.0:  # a general power takes as long as all the rest
        power *= power
    elif c[5] != 1.0:
        power **= c[5]
    peeling = math.sqrt(speed / (speed + c[7]))
    strength = (
        kinetic
        + (contact[CRITICAL] - kinetic) * peeling * age / (age + c[2])
        + c[3] * kinetic * math.exp(-power)
    )
    state_rates[0] = v - stiffness * speed * z / strength
    state_rates[1] = 1.0 - speed * age / (c[6] * kinetic)
    return stiffness * z + damping * state_rates[0]


LAW = FrictionLaw(
    name="peeling_contact",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=MEMORY.rest,
    tolerance=MEMORY.tolerance,
)
