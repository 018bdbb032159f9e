r"""Contact with memory: an elastic contact whose strength depends on its age and speed.

.. math::
    \dot z &= v - K |v| z / g(\varphi, v), \qquad T = K z + \sigma \dot z \\
    \dot\varphi &= 1 - |v| \varphi / D, \qquad D = D_0 + D_1 T_{kin} \\
    g &= T_{kin} + (T_{crit} - T_{kin}) \frac{\varphi}{\varphi + \tau}
         + \beta T_{kin} e^{-(|v| / v_w)^n}

z is the shear of the contact [rad], phi its age [s]: in stick it grows with time, in sliding it
settles at D/|v|. So the contact yields gradually during stick, regains strength with time, and its
torque falls with sliding speed, without which no vibration sustains itself. The law combines the
bristle contact of Canudas de Wit et al. (1995), the rate-and-state laws of Dieterich and Ruina
(1983), whose ageing here saturates, and the falling torque of Bo and Pavelescu (1982) with
exponents n up to 2, where it falls steepest at 0.7 of v_w. Stiffness and damping of the contact are
proportional to the real area of contact, hence to T_kin; the renewal angle D may grow with it too,
as spots of contact grow and join under load.

Limits: steady sliding at speed v gives T = g(D/|v|, v); with D_0 = 0 a larger torque ages like a
smaller one at a lower speed; tau -> infinity and beta = 0 give a constant T_kin; after a long rest
T may rise to T_crit + beta T_kin.
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS

_LONG_REST = 1.0
"""Age of the contact at the start [s]."""

_LEAST_RENEWAL = 1e-6
"""Lower limit of D [rad]."""

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "contact_stiffness_per_torque": Parameter(
        1700.0, "1/rad", 1.0, 5e3, "K / T_kin: shear stiffness of the contact"
    ),
    "renewal_angle": Parameter(
        4e-4, "rad", 0.0, 1.0, "D_0: sliding distance over which the contact is renewed"
    ),
    "ageing_time": Parameter(4e-4, "s", 1e-7, 1e3, "tau: time in which strength is regained"),
    "weakening_share": Parameter(
        0.0, "", 0.0, 10.0, "beta: torque that falls with speed, over T_kin"
    ),
    "weakening_speed": Parameter(20.0, "rad/s", 1e-3, 1e4, "v_w: speed scale of that fall"),
    "weakening_exponent": Parameter(1.0, "", 1.0, 4.0, "n: 1 for an exponential, 2 for a Gaussian"),
    "renewal_angle_per_torque": Parameter(
        0.0, "rad/Nm", 0.0, 1e-2, "D_1: increase of the distance per Nm of T_kin"
    ),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    critical, kinetic, z, age = contact[CRITICAL], contact[KINETIC], state[0], state[1]
    stiffness, damping = c[0] * kinetic, c[1] * kinetic
    speed = abs(v)
    inverse = 1.0 / c[5]  # computed while the speed is still being loaded
    power = speed * inverse
    if c[6] == 2.0:  # a general power takes as long as all the rest
        power *= power
    elif c[6] != 1.0:
        power **= c[6]
    strength = (
        kinetic + (critical - kinetic) * age / (age + c[3]) + c[4] * kinetic * math.exp(-power)
    )
    shearing = v - stiffness * speed * z / strength
    state_rates[0] = shearing
    state_rates[1] = 1.0 - speed * age / max(c[2] + c[7] * kinetic, _LEAST_RENEWAL)
    return stiffness * z + damping * shearing


LAW = FrictionLaw(
    name="contact_with_memory",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0, _LONG_REST),
    tolerance=5e-7,
)
