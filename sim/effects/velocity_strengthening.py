r"""Kinetic torque that rises with sliding speed, which keeps silicone silent.

.. math::
    T_{kin}(v) = T_{kin} \, [1 + s f(x)], \quad x = |v| / v_r, \qquad
    f = x, \quad \frac{1 - e^{-x}}{1 - e^{-1}}, \quad \frac{\ln(1 + 10 x)}{\ln 11}

Forms linear (viscous), saturating and logarithmic (thermally activated, as in rate-and-state laws;
Ruina 1983), all with the same gain s at the speed v_r. PDMS triples its torque from 0.25 to
17 rad/s and never vibrates (5.1.2): s = 2 at v_r = 17 rad/s. T_crit rises by the same torque, so
laws with memory retain the part that comes with age.

Limits: s = 0 is the plain model; at rest nothing changes; a linear gain acts as a viscous damping
s T_kin / v_r [Nm s/rad] between shaft and bushing. Where dT/dv exceeds some 300 Nm s/rad, the
solver would need too many steps to follow the surface, and the run is refused.
"""

import math

from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED, contact_hook
from sim.effects.effect import Effect, Parameter, Stage


@contact_hook
def _contact(context, values, state, state_rates, contact):  # noqa: ARG001
    x = abs(context[SLIDING_SPEED]) / values[1]
    if values[2] == 0.0:
        f = x
    elif values[2] == 1.0:
        f = math.expm1(-x) / math.expm1(-1.0)
    else:
        f = math.log1p(10.0 * x) / math.log(11.0)
    gained = values[0] * f * contact[KINETIC]
    contact[KINETIC] += gained
    contact[CRITICAL] += gained


EFFECT = Effect(
    name="velocity_strengthening",
    stage=Stage.FRICTION,
    forms=("linear", "saturating", "logarithmic"),
    parameters={
        "gain": Parameter(0.1, "", 0.0, 5.0, "s: relative gain of the kinetic torque at `speed`"),
        "speed": Parameter(10.0, "rad/s", 1e-2, 1e3, "v_r: speed of that gain"),
    },
    strength="gain",
    contact=_contact,
)
"""Kinetic torque that rises with sliding speed."""
