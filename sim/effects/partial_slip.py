r"""Partial slip: the contact creeps while it sticks, faster the nearer it is to slip.

.. math::
    \dot\theta_1 = \omega_s [1 - s f(r)], \quad r = |T| / T_{crit}, \qquad
    f = r^n, \quad \frac{e^{n r} - 1}{e^n - 1}, \quad 1 - (1 - r)^{1/3}

Forms power, exponential and mindlin. On the rig the torque rises ever more slowly during stick
(5.1.1). The third form is that of a round contact, whose tangential stiffness is k_0 (1 - r)^(1/3)
(Cattaneo 1938, Mindlin 1949): in series with an elastomer of stiffness k_0, its extra compliance is
the share f of the shaft's motion. Unloading is stick (Mindlin and Deresiewicz 1953): f = 0 where
the shaft turns against the torque. T is the torque of the elastomer without the inertia of the
bushing's surface; the two differ only while the shaft accelerates.

In the third form r stops at 0.999, since its slope would become infinite.

A stick breaks into a slip that starts at the speed of its creep, and a slip ends where it has
slowed to that speed, so the speed of the surface is continuous. The creep relieves the elastomer's
damper.

The effect acts on true stick only: laws with an inner state release gradually by themselves.
Limits: s = 0 is true stick; s -> 1 never breaks, but changes into sliding at T_crit.
"""

import math

from sim.contact import CREEP, CRITICAL, SHAFT_SPEED, TORQUE, contact_hook
from sim.effects.effect import Effect, Parameter, Stage

_MOST = 0.999
"""Largest r, so that the integration can follow the slope of the creep."""


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
            "s: share of the shaft's speed at which the contact creeps just before slip",
        ),
        "exponent": Parameter(4.0, "", 1.0, 20.0, "n: larger for a later creep; not mindlin"),
    },
    strength="share",
    contact=_contact,
    of_true_stick=True,
)
"""Gradual release of the contact during stick."""
