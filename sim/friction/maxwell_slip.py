r"""Maxwell-slip (Iwan) friction: sixteen elastic-plastic elements in parallel.

.. math::
    \dot z_i &= w [1 - \alpha(x_i) x_i], \qquad x_i = K z_i \operatorname{sgn}(v) / (s_i g(v)) \\
    T &= \frac{1}{16} \sum_i (K z_i + \sigma \dot z_i), \qquad
    g = T_{kin} + (T_{crit} - T_{kin}) e^{-|v| / v_s}

Iwan (1966); with a strength that falls with speed, Al-Bender, Lampaert and Swevers (2004). The
thresholds s_i g / 16 are spread evenly between 1 - spread and 1 + spread about their mean, so the
contact yields element by element under load, and remembers its reversals. alpha rises smoothly from
zero at x = 0.5 to one at x = 1, because an element that yields at once would cost the solver its
order. The elements are not coupled. w is that of `sim.friction.shared`.

Limits: steady sliding gives T = g(v); slow loading from rest is nearly the sum of ideal elements,
linear at first and settling at T_crit beyond (1 + spread) T_crit / K; a small loop during loading
closes to about 1 %, the creep of the smooth yield; equal torques give a constant friction.
"""

import math

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, shear_speed

N_ELEMENTS = 16

_YIELD = 0.5
"""Share of the threshold below which an element does not slip."""

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "spread": Parameter(0.5, "", 0.0, 0.8, "relative spread of the elements' thresholds"),
    "stribeck_speed": Parameter(1.0, "rad/s", 1e-2, 1e4, "v_s: speed scale of the falling torque"),
}


@law_torque
def _torque(v, c, contact, state, state_rates):
    kinetic = contact[KINETIC]
    stiffness = c[0] * kinetic
    strength = kinetic + (contact[CRITICAL] - kinetic) * math.exp(-abs(v) / c[3])
    total, total_rate = 0.0, 0.0
    forward = math.copysign(stiffness / strength, v)
    weakest = 1.0 - c[2] * (1.0 - 1.0 / N_ELEMENTS)
    w = shear_speed(v, weakest * strength / stiffness)
    for i in range(N_ELEMENTS):
        threshold = 1.0 + c[2] * ((2 * i + 1) / N_ELEMENTS - 1.0)
        load = forward * state[i] / threshold
        rise = min(max((load - _YIELD) / (1.0 - _YIELD), 0.0), 1.0)
        state_rates[i] = w * (1.0 - rise * rise * (3.0 - 2.0 * rise) * load)
        total += state[i]
        total_rate += state_rates[i]
    return (stiffness * total + c[1] * kinetic * total_rate) / N_ELEMENTS


LAW = FrictionLaw(
    name="maxwell_slip",
    parameters=_PARAMETERS,
    torque=_torque,
    rest=(0.0,) * N_ELEMENTS,
    tolerance=2e-7,
)
