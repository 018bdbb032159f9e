r"""Coulomb and viscous friction on an elastic contact: the torque rises linearly with speed.

.. math::
    T = K z + \sigma \dot z + T_{kin} v / v_0, \qquad g = T_{kin}

The textbook's sum of Coulomb and viscous friction. The elastic contact of Dahl (1968), with the
shear z of `sim.friction.shared`, smooths its jump at rest. The strength is T_kin: T_crit does not
enter.

Limits: steady sliding gives T = T_kin (1 + v / v_0) along v; v_0 -> infinity gives constant
friction; the torque never falls with speed, so sliding is stable at any speed.
"""

from sim.contact import KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, shear_speed

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "doubling_speed": Parameter(
        8.3, "rad/s", 5.0, 1e9, "v_0: speed at which the torque is twice T_kin"
    ),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    w = shear_speed(v, 1.0 / c[0])
    state_rates[0] = w - c[0] * abs(w) * state[0]
    return kinetic * (c[0] * state[0] + c[1] * state_rates[0] + v / c[2])


LAW = FrictionLaw(
    name="viscous",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
    reads_critical=False,
    tolerance=1e-6,
)
