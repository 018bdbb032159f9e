r"""Stribeck friction that falls with speed as a Lorentzian, over one or two scales.

.. math::
    g = T_{kin} + (T_{crit} - T_{kin}) [(1 - s) f(v / v_1) + s f(v / v_2)], \qquad
        f(x) = 1 / (1 + x^2)

Hess and Soom (1990): flat at rest, with a tail that still weakens at many times its speed. The
elastic contact is that of `sim.friction.shared`.

Limits: steady sliding gives T = g(v), which is T_crit at rest and falls to T_kin as 1/v^2; equal
torques give a constant friction; s = 0 is one scale, and so is v_1 = v_2 with any s.
"""

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, shear_speed

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "first_speed": Parameter(1.0, "rad/s", 1e-2, 1e4, "v_1: speed scale of the falling torque"),
    "second_share": Parameter(0.0, "", 0.0, 1.0, "s: share of T_crit - T_kin that falls over v_2"),
    "second_speed": Parameter(15.6, "rad/s", 1e-2, 1e4, "v_2: speed scale of that share"),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    first = 1.0 / (1.0 + (v / c[2]) ** 2)
    second = 1.0 / (1.0 + (v / c[4]) ** 2)
    kinetic = contact[KINETIC]
    stiffness, damping = c[0] * kinetic, c[1] * kinetic
    drop = contact[CRITICAL] - kinetic
    strength = kinetic + drop * ((1.0 - c[3]) * first + c[3] * second)
    w = shear_speed(v, strength / stiffness)
    state_rates[0] = w - stiffness * abs(w) * state[0] / strength
    return stiffness * state[0] + damping * state_rates[0]


LAW = FrictionLaw(
    name="stribeck_lorentzian",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0,),
)
