r"""Scatter of the critical torque from stick to stick.

.. math::
    T_{crit} = T_{kin} + (T_{crit,0} - T_{kin}) \max(0, 1 + s g z)

z has mean 0 and variance 1; for stick number i it is drawn as normal, uniform, or correlated,
z_i = rho z_(i-1) + sqrt(1 - rho^2) times a normal draw. "The contact area must change since T_crit
varies slightly throughout the experiment" (6.3). The scatter is a share of the drop, the only part
of the torque that the vibration depends on.

For a law that counts its sticks, g = 1. A law with an inner state has no sticks to count. There, a
contact that slips in a burst forms anew elsewhere, and a contact that slides evenly is renewed
gradually, which averages the scatter. A burst is sliding faster than twice the shaft's speed, which
an oscillation about that speed never reaches without a stop. With p the number of patches of
`patch_angle` lambda that the bursts have passed, between whose draws z is interpolated smoothly,
and g the share of the contact that has formed at once,

.. math::
    \lambda \dot p = \max(v - 2 \Omega, 0), \qquad
    \lambda \dot g = (1 - g) \max(v - 2 \Omega, 0) - g \min(v, 2 \Omega) / 15

so that the critical torque is constant through a stick and its creep, differs after a slip, and
scatters neither in steady sliding nor in harmonic vibration. The 15 patches of even sliding that
erase the effect of a slip are assumed; with 40 the scatter ends vibrations near the critical
speeds, with 1 it is erased by the creep before the next slip. Draws repeat after 4096.
Limits: s = 0 is the plain model, and so is a contact with T_crit = T_kin.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.contact import (
    CRITICAL,
    KINETIC,
    SHAFT_SPEED,
    SLIDING_SPEED,
    STICKS,
    contact_hook,
    slipless,
)
from sim.effects.effect import Effect, Parameter, Stage, Values

_FORMS = ("normal", "uniform", "correlated")
_N_DRAWS = 4096
_HEADER = 1
_FADING_PATCHES = 15.0
"""Patches of even sliding that erase the effect of a slip."""


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
    return np.concatenate([[values["patch_angle"]], values["scatter"] * z])


@njit(cache=True, error_model="numpy")
def _draw(place, values):
    """Return s z, interpolated between the draws."""
    i = int(place)
    x = place - i
    x = x * x * (3.0 - 2.0 * x)
    return (1.0 - x) * values[_HEADER + i % _N_DRAWS] + x * values[_HEADER + (i + 1) % _N_DRAWS]


@contact_hook
def _contact(context, values, state, state_rates, contact):
    if slipless(context):
        sliding, even = abs(context[SLIDING_SPEED]), 2.0 * abs(context[SHAFT_SPEED])
        burst = max(sliding - even, 0.0) / values[0]
        fading = min(sliding, even) / (_FADING_PATCHES * values[0])
        share = max(0.0, 1.0 + state[1] * _draw(state[0], values))
        state_rates[0] = burst
        state_rates[1] = burst * (1.0 - state[1]) - fading * state[1]
    else:
        state_rates[0] = state_rates[1] = 0.0
        share = max(0.0, 1.0 + _draw(context[STICKS], values))
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
            0.7, "", 0.0, 0.999, "rho: correlation of successive sticks; correlated only"
        ),
        "patch_angle": Parameter(
            0.01, "rad", 1e-4, 10.0, "slip angle between draws, for laws with inner state"
        ),
    },
    strength="scatter",
    contact=_contact,
    pack=_pack,
    n_states=2,
    irregular=True,
)
"""Critical torque that differs from stick to stick."""
