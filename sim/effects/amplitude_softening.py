r"""Stiffness of the elastomer that falls with the amplitude of its deformation (Payne effect).

.. math::
    T_E &= k_E [\bar\theta + (\theta - \bar\theta) (1 - s g(x))] + c\dot\theta, \qquad
    x = |\theta - \bar\theta| / \theta_r, \quad
    t_m \dot{\bar\theta} = \theta - \bar\theta \\
    g &= \frac{x}{1 + x}, \quad 1 - e^{-x}, \quad \frac{x^2}{1 + x^2}

theta is the twist, and with a bar its slow mean. Forms rational and quadratic are those of Kraus
(1984), with m = 1/2 and 1; exponential falls off sooner. A filled rubber's network breaks down
with the amplitude of the deformation and recovers at small amplitude, whatever its static load: so
the deviation from a slow mean softens, and the mean torque does not. The instantaneous deviation
stands for the amplitude; unlike an amplitude constant over the cycle it also causes odd harmonics.

Limits: s = 0 is the plain model, and so are small vibrations; large ones feel k_E (1 - s). The
torque rises with the deviation everywhere, since s <= 0.8.
"""

import math

from sim.contact import ELASTOMER_TORQUE, STIFFNESS, TWIST, contact_hook
from sim.effects.effect import Effect, Parameter, Stage


@contact_hook
def _contact(context, values, state, state_rates, contact):
    mean = state[0]
    deviation = context[TWIST] - mean
    state_rates[0] = deviation / values[2]
    x = abs(deviation) / values[1]
    if values[3] == 0.0:
        g = x / (1.0 + x)
    elif values[3] == 1.0:
        g = -math.expm1(-x)
    else:
        g = x * x / (1.0 + x * x)
    lost = values[0] * g * contact[STIFFNESS]
    contact[STIFFNESS] -= lost
    contact[ELASTOMER_TORQUE] += lost * mean


EFFECT = Effect(
    name="amplitude_softening",
    stage=Stage.FRICTION,
    forms=("rational", "exponential", "quadratic"),
    parameters={
        "share": Parameter(0.3, "", 0.0, 0.8, "s: share of the stiffness lost at large amplitude"),
        "twist": Parameter(4e-3, "rad", 1e-5, 1.0, "theta_r: amplitude scale of that loss"),
        "averaging_time": Parameter(0.05, "s", 1e-3, 10.0, "t_m: averaging time of the slow mean"),
    },
    strength="share",
    contact=_contact,
    n_states=1,
)
"""Stiffness of the elastomer that falls with the amplitude of its twist."""
