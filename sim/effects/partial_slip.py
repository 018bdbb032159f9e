r"""The contact lets go gradually: it creeps while it sticks, the more the nearer it is to slip.

.. math::
    \dot\theta_1 = \omega_s [1 - s f(r)], \quad r = |T| / T_{crit}, \qquad
    f = r^n, \quad \frac{e^{n r} - 1}{e^n - 1}, \quad 1 - (1 - r)^{1/3}

Forms power, exponential and mindlin. On the rig torque rises ever more slowly during stick
(5.1.1). The third is a round contact's: its tangential stiffness is k_0 (1 - r)^(1/3) (Cattaneo
1938, Mindlin 1949). What it yields beyond an unloaded contact, in series with an elastomer of
stiffness k_0, is just the share f of the shaft's motion. Unloading is stick (Mindlin and
Deresiewicz 1953): f = 0 where the shaft turns against the torque. T is the elastomer's torque
without the inertia of the bushing's surface, of which it differs only while the shaft accelerates.

In the third form r stops at 0.999, where its slope would become infinite.

A stick breaks into a slip that starts at the speed of its creep, and a slip is caught where it has
slowed to that: the surface's speed is continuous. The damper of the elastomer feels the creep.

It acts on true stick alone: laws with an inner state release gradually themselves.
Limits: s = 0 is true stick; s -> 1 never breaks, but passes into sliding at T_crit.
"""

import math

from sim.contact import CREEP, CRITICAL, SHAFT_SPEED, TORQUE, contact_hook
from sim.effects.effect import Effect, Parameter, Stage

_MOST = 0.999
"""Of r, so that the creep rises with a slope that the integration can follow."""


@contact_hook
def _contact(context, values, state, state_rates, contact):  # noqa: ARG001
    if context[TORQUE] * context[SHAFT_SPEED] <= 0.0:
        return
    r = min(abs(context[TORQUE]) / contact[CRITICAL], 1.0)
    if values[2] == 0.0:
        f = r ** values[1]
    elif values[2] == 1.0:
        f = math.expm1(values[1] * r) / math.expm1(values[1])
    else:
        f = 1.0 - (1.0 - _MOST * r) ** (1.0 / 3.0)
    contact[CREEP] += values[0] * f * (1.0 - contact[CREEP])


EFFECT = Effect(
    name="partial_slip",
    stage=Stage.FRICTION,
    forms=("power", "exponential", "mindlin"),
    parameters={
        "share": Parameter(
            0.5,
            "",
            0.0,
            0.95,
            "s: of the shaft's speed at which the contact creeps just before it slips",
        ),
        "exponent": Parameter(4.0, "", 1.0, 20.0, "n: how late the creep sets in; not of mindlin"),
    },
    strength="share",
    contact=_contact,
    changes_only=CREEP,
)
"""Gradual release of the contact during stick."""
