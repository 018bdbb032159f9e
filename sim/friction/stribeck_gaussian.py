r"""Stribeck friction that falls with speed as a Gaussian, over one or two scales.

.. math::
    g = T_{kin} + (T_{crit} - T_{kin}) [(1 - s) f(v / v_1) + s f(v / v_2)], \qquad
        f(x) = e^{-x^2}

Bo and Pavelescu (1982), exponent two: flat at rest, steepest at 0.7 of its speed, and complete soon
after. The elastic contact and the sum of the scales are those of `sim.friction.shared`.

Limits: steady sliding gives T = g(v), which is T_crit at rest and T_kin at high speed; equal
torques give a constant friction; s = 0 is one scale, LuGre without its viscous part, and so is
v_1 = v_2 with any s.
"""

import math

from sim.contact import law_torque
from sim.friction.law import FrictionLaw
from sim.friction.shared import STRIBECK_PARAMETERS, stribeck_torque


@law_torque
def _torque(v, c, contact, state, state_rates):
    first = math.exp(-((v / c[2]) ** 2))
    second = math.exp(-((v / c[4]) ** 2))
    return stribeck_torque(v, first, second, c, contact, state, state_rates)


LAW = FrictionLaw(
    name="stribeck_gaussian",
    parameters=STRIBECK_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
    tolerance=5e-8,
)
