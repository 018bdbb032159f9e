r"""Kinetic torque that falls with sliding speed, which sustains squawk and squeal.

.. math::
    T_{kin}(v) = T_{kin} \, [1 - s f(x)], \quad x = |v| / v_w, \qquad
    f = 1 - e^{-x}, \quad \frac{x}{1 + x}, \quad 1 - e^{-x^2}

Forms exponential, rational and gaussian: the falling branch of the Stribeck curve (Bo and
Pavelescu 1982; Armstrong-Helouvry, Dupont and Canudas de Wit 1994), with shorter or longer tails.
Steady sliding is unstable where dT/dv is below minus the damping of the modes, so without weakening
there is no quasi-harmonic regime. T_crit falls by the same torque: true stick breaks at rest, where
neither has fallen, and laws with memory retain the part of their torque that comes with age.

Limits: s = 0 is the plain model; at rest nothing changes; at high speed the share s is lost.
"""

import math

from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED, contact_hook
from sim.effects.effect import Effect, Parameter, Stage


@contact_hook
def _contact(context, values, state, state_rates, contact):  # noqa: ARG001
    x = abs(context[SLIDING_SPEED]) / values[1]
    if values[2] == 0.0:
        f = -math.expm1(-x)
    elif values[2] == 1.0:
        f = x / (1.0 + x)
    else:
        f = -math.expm1(-x * x)
    lost = values[0] * f * contact[KINETIC]
    contact[KINETIC] -= lost
    contact[CRITICAL] -= lost


EFFECT = Effect(
    name="velocity_weakening",
    stage=Stage.FRICTION,
    forms=("exponential", "rational", "gaussian"),
    parameters={
        "share": Parameter(0.1, "", 0.0, 0.9, "s: share of the kinetic torque lost at high speed"),
        "speed": Parameter(10.0, "rad/s", 1e-2, 1e3, "v_w: speed scale of that loss"),
    },
    strength="share",
    contact=_contact,
)
"""Kinetic torque that falls with sliding speed."""
