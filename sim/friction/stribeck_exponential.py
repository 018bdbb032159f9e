r"""Stribeck friction that falls exponentially with speed, over one or two scales.

.. math::
    g = T_{kin} + (T_{crit} - T_{kin}) [(1 - s) f(v / v_1) + s f(v / v_2)], \qquad
        f(x) = e^{-|x|}

Bo and Pavelescu (1982), exponent one: it falls steepest at rest. The elastic contact and the sum
of the scales are those of `sim.friction.shared`.

Limits: steady sliding gives T = g(v), which is T_crit at rest and T_kin at high speed; equal
torques give a constant friction; s = 0 is one scale, and so is v_1 = v_2 with any s.
"""

import math

from sim.contact import law_torque
from sim.friction.law import FrictionLaw
from sim.friction.shared import STRIBECK_PARAMETERS, stribeck_torque


@law_torque
def _torque(v, c, contact, state, state_rates):
    first = math.exp(-abs(v) / c[2])
    second = math.exp(-abs(v) / c[4])
    return stribeck_torque(v, first, second, c, contact, state, state_rates)


LAW = FrictionLaw(
    name="stribeck_exponential",
    parameters=STRIBECK_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
)
