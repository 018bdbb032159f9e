r"""Viscoelastic elastomer: its stiffness and damping depend on frequency.

.. math::
    T_E = k_E \theta + c\dot\theta + \sum_i k_i (\theta - z_i), \qquad
    \tau_i \dot z_i = \theta - z_i, \qquad \sum_i k_i = s k_E

Maxwell branches beside the spring (Wiechert's model; Ferry, *Viscoelastic Properties of Polymers*).
Forms one_branch (Zener's solid, tau); two_branches of equal stiffness, a factor `spread` apart
about tau; fractional, four branches a factor `spread` apart whose stiffness goes as tau_i^-alpha,
so that over their range the stiffness rises as frequency^alpha and the loss factor is nearly
constant, as for rubber in its transition. theta is the twist, z_i that of a branch's dashpot.

Limits: s = 0 is the plain model; at low frequency the elastomer is a spring k_E, far above
1 / (2 pi tau) a spring k_E (1 + s). A branch never releases more energy than it has stored.
Relaxation times below 20 us, the resolution of the integration, are raised to 20 us.
"""

import numpy as np
from numpy.typing import NDArray

from sim.contact import ELASTOMER_TORQUE, STIFFNESS, TWIST, contact_hook
from sim.effects.effect import Effect, Parameter, Stage, Values

_BRANCHES = {"one_branch": 1, "two_branches": 2, "fractional": 4}
_MOST_BRANCHES = max(_BRANCHES.values())
_SHORTEST = 20e-6
"""Shortest relaxation time [s]."""


def _pack(form: str, values: Values, _rng: np.random.Generator) -> NDArray[np.float64]:
    n = _BRANCHES[form]
    times = values["relaxation_time"] * values["spread"] ** (np.arange(n) - 0.5 * (n - 1))
    shares = times ** -values["exponent"] if form == "fractional" else np.ones(n)
    shares *= values["stiffening"] / shares.sum()
    return np.concatenate([[n], shares, 1.0 / np.maximum(times, _SHORTEST)])


@contact_hook
def _contact(context, values, state, state_rates, contact):
    n = int(values[0])
    share = 0.0
    for i in range(n):
        stretch = context[TWIST] - state[i]
        share += values[1 + i] * stretch
        state_rates[i] = stretch * values[1 + n + i]
    contact[ELASTOMER_TORQUE] += contact[STIFFNESS] * share


EFFECT = Effect(
    name="viscoelastic_stiffness",
    stage=Stage.FRICTION,
    forms=tuple(_BRANCHES),
    parameters={
        "stiffening": Parameter(
            0.3, "", 0.0, 5.0, "s: increase of stiffness at high frequency, over the static one"
        ),
        "relaxation_time": Parameter(
            5e-4, "s", 2e-5, 1.0, "tau: mean relaxation time of the branches"
        ),
        "spread": Parameter(4.0, "", 1.0, 10.0, "ratio of successive relaxation times"),
        "exponent": Parameter(0.3, "", 0.0, 1.0, "alpha: exponent of frequency; fractional only"),
    },
    strength="stiffening",
    contact=_contact,
    pack=_pack,
    n_states=_MOST_BRANCHES,
)
"""Stiffness and damping of the elastomer that rise with frequency."""
