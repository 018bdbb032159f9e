r"""Bond population: friction by bonds that form, stretch and break.

.. math::
    \dot n &= (1 - n) / t_r - r n, \qquad
    r = \frac{1}{t_r} \exp\frac{K |u| - T_{crit}}{K u_0} \\
    \dot m &= n v - r m, \qquad m = n u \\
    \dot z &= w - K |w| z / T_{kin}, \qquad T = K m + (1 - n) K z T_r / T_{kin} + \eta v

Schallamach (1963); Braun and Peyrard (2008). n is the bonded share of the contact, u the mean
stretch of its bonds [rad], t_r the time in which bonds form; the rest rubs with a torque T_r,
through the bristles of `sim.friction.shared` (z, w). New bonds are unstretched, so that
u' = v - u (1 - n) / (n t_r); the state is the stretch of all bonds together, m, which avoids a
division by n. The time of spontaneous rupture, t_s = t_r exp(T_crit / (K u_0)), follows from
T_crit: the torque of a fully bonded contact at which bonds break as fast as they form. K, T_r and
eta are proportional to T_kin, which is their scale and not the torque of sliding.

Limits: steady sliding gives u = v / r, n = 1 / (1 + r t_r); at rest nearly the whole contact is
bonded and the torque relaxes; at high speed no part is, and T = T_r + eta v.
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import FASTEST, shear_speed

_FEWEST_BONDS = 1e-9

_PARAMETERS = {
    "bond_stiffness_per_torque": Parameter(
        1700.0, "1/rad", 100.0, 5e3, "K / T_kin: stiffness of all bonds together"
    ),
    "bonding_time": Parameter(2e-3, "s", 1e-4, 1.0, "t_r: time in which bonds form"),
    "rupture_stretch": Parameter(
        2.6e-4, "rad", 1e-4, 2e-3, "u_0: stretch that raises the rupture rate e times"
    ),
    "rubbing_share": Parameter(0.3, "", 0.0, 2.0, "T_r / T_kin: torque of the unbonded part"),
    "viscous_share_per_speed": Parameter(
        0.0125, "s/rad", 0.0, 0.2, "eta / T_kin: rise of the torque with speed"
    ),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness = c[0] * kinetic
    bonded, stretch, shear = state[0], state[1], state[2]
    mean_stretch = abs(stretch) / max(bonded, _FEWEST_BONDS)
    beyond = (mean_stretch - contact[CRITICAL] / stiffness) / c[2]
    fastest = math.log(FASTEST * c[1])
    rupture = math.exp(min(beyond, fastest)) / c[1]
    state_rates[0] = (1.0 - bonded) / c[1] - rupture * bonded
    state_rates[1] = bonded * v - rupture * stretch
    w = shear_speed(v, 1.0 / c[0])
    state_rates[2] = w - c[0] * abs(w) * shear
    return stiffness * (stretch + (1.0 - bonded) * c[3] * shear) + c[4] * kinetic * v


LAW = FrictionLaw(
    name="bond_population",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(1.0, 0.0, 0.0),
    tolerance=1e-6,
)
