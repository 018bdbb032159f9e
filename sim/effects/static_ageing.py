r"""Static ageing: the critical torque grows with the time of stick.

.. math::
    T_{crit}(t) &= T_{kin} + (T_{crit} - T_{kin}) \, [1 - s + s f(x)], \quad
    x = t_{stick} / \tau \\
    f &= 1 - e^{-x}, \quad \min\left(\frac{\ln(1 + x)}{\ln 11}, 1\right), \quad
    1 - (1 + x)^{-1/2}

Forms exponential, logarithmic (Dieterich 1979), complete at 10 tau, and power. Rabinowicz and
Brockley consider ageing necessary for stick-slip (Section 2): the faster the shaft, the shorter the
stick and the smaller the drop, so that stick-slip ends at a lower speed.

In a law with an inner state, stick has no sharp beginning. There an age replaces t_stick: it grows
with time and shrinks as sliding renews the contact, d(age)/dt = 1 - |v| age / D (Ruina 1983). From
rest and in true stick the two are equal.

Limits: s = 0 is the plain model; with s = 1 the contact breaks at T_kin at once and at T_crit after
a long stick.
"""

import math

from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED, STICK_TIME, contact_hook, slipless
from sim.effects.effect import Effect, Parameter, Stage


@contact_hook
def _contact(context, values, state, state_rates, contact):
    stick_time, state_age = max(context[STICK_TIME], 0.0), max(state[0], 0.0)
    unslipped = slipless(context)
    age = state_age if unslipped else stick_time
    renewal = 1.0 - abs(context[SLIDING_SPEED]) * state_age / values[2]
    state_rates[0] = renewal if unslipped else 0.0
    x = age / values[1]
    if values[3] == 0.0:
        f = -math.expm1(-x)
    elif values[3] == 1.0:
        f = min(math.log1p(x) / math.log(11.0), 1.0)
    else:
        f = 1.0 - 1.0 / math.sqrt(1.0 + x)
    contact[CRITICAL] -= values[0] * (1.0 - f) * (contact[CRITICAL] - contact[KINETIC])


EFFECT = Effect(
    name="static_ageing",
    stage=Stage.FRICTION,
    forms=("exponential", "logarithmic", "power"),
    parameters={
        "share": Parameter(1.0, "", 0.0, 1.0, "s: share of T_crit - T_kin regained in each stick"),
        "ageing_time": Parameter(
            1e-3, "s", 1e-6, 10.0, "tau: time of stick in which it is regained"
        ),
        "renewal_angle": Parameter(
            4e-4, "rad", 1e-4, 1.0, "D: sliding that renews the contact, for laws with inner state"
        ),
    },
    strength="share",
    contact=_contact,
    n_states=1,
)
"""Critical torque that grows with the time of stick."""
