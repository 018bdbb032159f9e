r"""Scatter of the critical torque: no two sticks break at the same torque.

.. math::
    T_{crit} = T_{kin} + (T_{crit,0} - T_{kin}) \max(0, 1 + s z_i)

z has mean 0 and variance 1: of stick number i, drawn as normal, uniform, or correlated,
z_i = rho z_(i-1) + sqrt(1 - rho^2) times a normal draw. The critical torque "varies slightly
throughout the experiment", as the area of contact changes (Section 6.3). The scatter is a share
of the drop, on which alone the vibration depends.

Where a law has an inner state no sticks can be counted. There z follows the sliding: it passes
from one draw to the next within `patch_angle` of sliding, as over a surface that is not even; in
between the variance is somewhat smaller. Draws repeat after 4096.
Limits: s = 0 is the plain model, and so is a contact with T_crit = T_kin.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from sim.contact import CRITICAL, HOOK_SIGNATURE, KINETIC, SLIDING_SPEED, STICKS, slipless
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.effects.effect import Values

__all__ = ["EFFECT"]

_FORMS = ("normal", "uniform", "correlated")
_N_DRAWS = 4096
_HEADER = 1


def _pack(form: str, values: Values, rng: np.random.Generator) -> NDArray[np.float64]:
    if form == "uniform":
        z = rng.uniform(-math.sqrt(3.0), math.sqrt(3.0), _N_DRAWS)
    else:
        z = rng.standard_normal(_N_DRAWS)
    if form == "correlated":
        rho = values["correlation"]
        fresh = math.sqrt(1.0 - rho * rho)
        for i in range(1, _N_DRAWS):
            z[i] = rho * z[i - 1] + fresh * z[i]
    share = np.maximum(0.0, 1.0 + values["scatter"] * z)
    return np.concatenate([[values["patch_angle"]], share])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def _contact(context, values, state, state_rates, contact):
    sticks, patches = context[STICKS], state[0] / values[0]
    speed = abs(context[SLIDING_SPEED])
    unslipped = slipless(context)
    state_rates[0] = speed if unslipped else 0.0
    place = patches if unslipped else sticks
    i = int(place)
    x = place - i
    x = x * x * (3.0 - 2.0 * x)
    share = (1.0 - x) * values[_HEADER + i % _N_DRAWS] + x * values[_HEADER + (i + 1) % _N_DRAWS]
    contact[CRITICAL] = contact[KINETIC] + share * (contact[CRITICAL] - contact[KINETIC])


EFFECT = Effect(
    name="critical_torque_scatter",
    stage=Stage.FRICTION,
    forms=_FORMS,
    parameters={
        "scatter": Parameter(
            0.1, "", 0.0, 1.0, "s: standard deviation of T_crit - T_kin over its mean"
        ),
        "correlation": Parameter(
            0.7, "", 0.0, 0.999, "rho: of one stick with the next; of correlated alone"
        ),
        "patch_angle": Parameter(
            5e-3, "rad", 1e-4, 10.0, "sliding from one draw to the next, for laws with inner state"
        ),
    },
    strength="scatter",
    contact=_contact,
    pack=_pack,
    n_states=1,
)
"""Critical torque that differs from stick to stick."""
