r"""Friction with static ageing: strength that grows exponentially with the time of contact.

.. math::
    \dot z &= w [1 - \alpha(x) x], \qquad x = K z \operatorname{sgn}(v) / g,
        \qquad T = K z + \sigma \dot z \\
    \dot\varphi &= 1 - |v| \alpha(x) x \varphi / D, \qquad
    g = T_{kin} + (T_{crit} - T_{kin}) (1 - e^{-\varphi / \tau})

The growth is that of the strengthening laws reviewed by Baumberger and Caroli (2006), in the form
that saturates. z is the shear of the contact, phi its age [s]; w is that of `sim.friction.shared`,
whose bound also limits the rate of renewal. The contact is that of Dupont et al. (2002): alpha is
zero up to x = 0.7 and rises smoothly to one at x = 1, so below 70 % of its strength the contact
truly sticks and ages with time, and only slip renews it. Bristles that creep at any load would lose
their age before they break.

Limits: steady sliding gives T = g at phi = D/|v|, hence T_kin where D << |v| tau; after a rest of
t, a contact much stiffer than T_crit / D breaks at T_kin + (T_crit - T_kin) (1 - exp(-t / tau));
equal torques, or tau -> infinity, give a constant friction.
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, FASTEST, shear_speed

_LONG_REST = 1.0
"""Age of the contact at the start [s]."""

_YIELD = 0.7
"""Share of the strength below which the contact does not slip."""

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "contact_stiffness_per_torque": Parameter(
        3000.0, "1/rad", 1.0, 1e4, "K / T_kin: shear stiffness of the contact"
    ),
    "renewal_angle": Parameter(
        2e-4, "rad", 1e-5, 1.0, "D: slip distance over which the contact is renewed"
    ),
    "ageing_time": Parameter(1e-3, "s", 1e-5, 1e6, "tau: time in which strength is regained"),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness = c[0] * kinetic
    z, age = state[0], max(state[1], 0.0)
    strength = kinetic + (contact[CRITICAL] - kinetic) * (1.0 - math.exp(-age / c[3]))
    load = math.copysign(stiffness * z, z * v) / strength
    rise = min(max((load - _YIELD) / (1.0 - _YIELD), 0.0), 1.0)
    w = shear_speed(v, strength / stiffness)
    slipping = rise * rise * (3.0 - 2.0 * rise) * load
    state_rates[0] = w * (1.0 - slipping)
    state_rates[1] = 1.0 - min(abs(v) * slipping / c[2], FASTEST) * age
    return stiffness * z + c[1] * kinetic * state_rates[0]


LAW = FrictionLaw(
    name="ageing",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0, _LONG_REST),
    tolerance=1e-6,
)
