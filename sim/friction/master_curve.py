r"""Master curve of rubber friction: a bell curve over the logarithm of speed.

.. math::
    g = p_0 T_{kin} + (p_1 T_{crit} - p_0 T_{kin})
         \exp\left[-\tfrac12 (\log_{10}(|v| / v_p) / w)^2\right]

Grosch (1963) found rubber friction at all temperatures on one bell over log(a_T v); Persson (2001)
derives the bell from the losses in the rubber. v_p is the speed of highest friction at the
material's reference temperature; at another temperature `sim.temperature` shifts it to v_p / a_T.
The peak is p_1 T_crit, the floor on both sides p_0 T_kin; the contact is that of
`sim.friction.shared`, with a stiffness proportional to the floor. Below v_p friction rises with
speed and sliding is stable; above, it falls. A low glass temperature moves the peak beyond the
rig's speeds, which is why silicone is silent there.

Limits: steady sliding gives T = g(v); at the peak's speed that is p_1 T_crit; equal torques and
shares, or w -> infinity with the peak in place of T_kin, give a constant friction.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sim.contact import CRITICAL, KINETIC, law_torque
from sim.friction.law import FrictionLaw, Parameter
from sim.friction.shared import BRISTLE_PARAMETERS, shear_speed

_LEAST_SPEED = 1e-30
"""Speed whose logarithm replaces that of rest [rad/s]."""

_PARAMETERS = {
    **BRISTLE_PARAMETERS,
    "peak_speed": Parameter(0.02, "rad/s", 1e-12, 1e12, "v_p: speed of highest friction"),
    "width": Parameter(1.5, "", 0.2, 20.0, "w: decades from the peak to 0.61 of its height"),
    "peak_share": Parameter(1.0, "", 1.0, 10.0, "p_1: torque at the peak over T_crit"),
    "floor_share": Parameter(1.0, "", 0.1, 1.0, "p_0: torque far from the peak over T_kin"),
}


def _pack(values: Mapping[str, float]) -> NDArray[np.float64]:
    return np.array(
        [
            values["contact_stiffness_per_torque"],
            values["contact_damping_per_torque"],
            math.log10(values["peak_speed"]),
            values["width"],
            values["peak_share"],
            values["floor_share"],
        ]
    )


@law_torque
def _torque(v, c, contact, state, state_rates):
    peak, floor = c[4] * contact[CRITICAL], c[5] * contact[KINETIC]
    stiffness = c[0] * floor
    speed = abs(v)
    decades = (math.log10(max(speed, _LEAST_SPEED)) - c[2]) / c[3]
    strength = floor + (peak - floor) * math.exp(-0.5 * decades * decades)
    w = shear_speed(v, strength / stiffness)
    state_rates[0] = w - stiffness * abs(w) * state[0] / strength
    return stiffness * state[0] + c[1] * floor * state_rates[0]


LAW = FrictionLaw(
    name="master_curve",
    parameters=_PARAMETERS,
    torque=_torque,
    pack=_pack,
    rest=(0.0,),
    tolerance=3e-8,
    master_speeds=("peak_speed",),
)
