r"""Stribeck friction that falls with speed as a Lorentzian, over one or two scales.

.. math::
    g = T_{kin} + (T_{crit} - T_{kin}) [(1 - s) f(v / v_1) + s f(v / v_2)], \qquad
        f(x) = 1 / (1 + x^2)

Hess and Soom (1990): flat at rest, with a tail that still weakens at many times its speed. The
elastic contact and the sum of the scales are those of `sim.friction.shared`.

Limits: steady sliding gives T = g(v), which is T_crit at rest and falls to T_kin as 1/v^2; equal
torques give a constant friction; s = 0 is one scale, and so is v_1 = v_2 with any s.
"""

from sim.contact import law_torque
from sim.friction.law import FrictionLaw
from sim.friction.shared import STRIBECK_PARAMETERS, stribeck_torque


@law_torque
def _torque(v, c, contact, state, state_rates):
    first = 1.0 / (1.0 + (v / c[2]) ** 2)
    second = 1.0 / (1.0 + (v / c[4]) ** 2)
    return stribeck_torque(v, first, second, c, contact, state, state_rates)


LAW = FrictionLaw(
    name="stribeck_lorentzian",
    parameters=STRIBECK_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
)
