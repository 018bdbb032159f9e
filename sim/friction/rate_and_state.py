r"""Rate-and-state friction: strength that depends on the contact's age and on speed.

.. math::
    \dot z &= w - K |w| z / g, \qquad T = K z + \sigma \dot z \\
    \dot\varphi &= 1 - |s| \varphi / D, \qquad s = K |v| z / g \\
    g &= T_{kin} [1 + a \ln(1 + |v| / v_0)] + (T_{crit} - T_{kin}) \frac{\varphi}{\varphi + \tau}

After Dieterich (1979) and Ruina (1983), with Dieterich's law of ageing; their logarithm of the age,
which has no bound, is replaced by a share that saturates at T_crit. phi is the age of the contact
[s], s its slip speed, a the direct effect; w is that of `sim.friction.shared`, whose bound also
limits the rate |s|/D. Only slip renews the contact, not its elastic shear, as in the original,
whose speed is the slip speed; `contact_with_memory` counts both and has no direct effect.

Limits: steady sliding gives T = g at phi = D/|v|; it weakens with speed while the direct effect
is small, and strengthens beyond the speed where that overtakes; equal torques and a = 0, or
tau -> infinity and a = 0, give a constant friction.
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, FASTEST, shear_speed

_LONG_REST = 1.0
"""Age of the contact at the start [s], long against the ageing time of a rubber."""

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "renewal_angle": Parameter(
        4e-4, "rad", 1e-5, 1.0, "D: slip distance over which the contact is renewed"
    ),
    "ageing_time": Parameter(4e-4, "s", 1e-5, 1e6, "tau: time in which strength is regained"),
    "direct_effect": Parameter(
        0.0, "", 0.0, 1.0, "a: rise of the torque with the logarithm of speed"
    ),
    "direct_speed": Parameter(1e-2, "rad/s", 1e-4, 1e3, "v_0: speed above which the torque rises"),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness = c[0] * kinetic
    z, age = state[0], max(state[1], 0.0)
    speed = abs(v)
    strength = kinetic * (1.0 + c[4] * math.log1p(speed / c[5]))
    strength += (contact[CRITICAL] - kinetic) * age / (age + c[3])
    w = shear_speed(v, strength / stiffness)
    load = stiffness * z / strength
    state_rates[0] = w - abs(w) * load
    state_rates[1] = 1.0 - min(speed * abs(load) / c[2], FASTEST) * age
    return stiffness * z + c[1] * kinetic * state_rates[0]


LAW = FrictionLaw(
    name="rate_and_state",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0, _LONG_REST),
    tolerance=3e-7,
)
