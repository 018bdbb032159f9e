r"""Film of rubber on the shaft, which raises the torque, reduces its drop and adds random friction.

.. math::
    \chi &= \chi_0 + (1 - \chi_0) f(x), \quad x = \int |v| \, dt / \varphi_f, \qquad
    f = 1 - e^{-x}, \quad \min(x, 1), \quad
    \frac{L(6 x - 6) - L(-6)}{1 - L(-6)} \\
    T_{kin} &\to T_{kin} [1 + s\chi (a - 1)] (1 + s \chi \epsilon n(t)), \qquad
    T_{crit} - T_{kin} \to (T_{crit} - T_{kin}) [1 - s\chi (1 - d)]

Forms exponential, linear and logistic, with L(y) = 1 / (1 + e^-y): the film chi grows with the
sliding angle, since rubber is transferred only by rubbing. A film of natural rubber raised the mean
torque three to four times, a = 3.5, and left random friction of very small amplitude from 250 to
1500 Hz at any speed (5.1.3, 5.2.2): n(t) is noise in that band with unit variance, which repeats
after 1.4 s. `formed` is the film chi_0 at the start.

Limits: s = 0, a shaft without film, is the plain model; with d = 0 a complete film leaves no drop
and so no stick-slip.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED, TIME, contact_hook
from sim.effects.effect import Effect, Parameter, Stage, Values

_FORMS = ("exponential", "linear", "logistic")

_BAND = 250.0, 1500.0
"""Band of the random friction [Hz]."""

_NOISE_RATE = 24e3
"""Rate of the noise table [Hz]: 16 points per shortest period make the cubic exact to 0.1 %."""

_N_NOISE = 2**15

_HEADER = 7


def _noise(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return periodic noise in the band, of unit variance."""
    frequency = np.fft.rfftfreq(_N_NOISE, 1.0 / _NOISE_RATE)
    inside = (frequency >= _BAND[0]) & (frequency <= _BAND[1])
    phase = rng.uniform(0.0, 2.0 * np.pi, frequency.size)
    noise = np.fft.irfft(inside * np.exp(1j * phase), _N_NOISE)
    return np.asarray(noise / noise.std())


def _pack(form: str, values: Values, rng: np.random.Generator) -> NDArray[np.float64]:
    return np.concatenate([[_FORMS.index(form), *values.values()], _noise(rng)])


@njit(cache=True, error_model="numpy")
def _cubic(table, place, first, n):
    """Interpolate a periodic table by Catmull and Rom's cubic."""
    i = int(place)
    x = place - i
    a = table[first + (i - 1) % n]
    b = table[first + i % n]
    c = table[first + (i + 1) % n]
    d = table[first + (i + 2) % n]
    return b + 0.5 * x * (
        c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a))
    )


@contact_hook
def _contact(context, values, state, state_rates, contact):
    state_rates[0] = abs(context[SLIDING_SPEED])
    x = state[0] / values[5]
    if values[0] == 0.0:
        grown = -math.expm1(-x)
    elif values[0] == 1.0:
        grown = min(x, 1.0)
    else:
        least = 1.0 / (1.0 + math.exp(6.0))
        grown = (1.0 / (1.0 + math.exp(6.0 - 6.0 * x)) - least) / (1.0 - least)
    film = values[1] * (values[6] + (1.0 - values[6]) * grown)
    drop = (contact[CRITICAL] - contact[KINETIC]) * (1.0 - film * (1.0 - values[3]))
    contact[KINETIC] *= 1.0 + film * (values[2] - 1.0)
    noise = _cubic(values, context[TIME] * _NOISE_RATE, _HEADER, _N_NOISE)
    contact[KINETIC] *= 1.0 + film * values[4] * noise
    contact[CRITICAL] = contact[KINETIC] + drop


EFFECT = Effect(
    name="transfer_film",
    stage=Stage.FRICTION,
    forms=_FORMS,
    parameters={
        "coverage": Parameter(1.0, "", 0.0, 1.0, "s: share of the shaft that the film covers"),
        "torque_ratio": Parameter(
            3.5, "", 1.0, 6.0, "a: kinetic torque with film over that without"
        ),
        "drop_left": Parameter(0.1, "", 0.0, 1.0, "d: share of T_crit - T_kin left on the film"),
        "roughness": Parameter(
            0.01, "", 0.0, 0.1, "epsilon: random friction on the film, rms over kinetic torque"
        ),
        "growth_angle": Parameter(
            1.0, "rad", 1e-3, 1e5, "phi_f: sliding angle in which the film forms"
        ),
        "formed": Parameter(0.0, "", 0.0, 1.0, "chi_0: share of the film at the start"),
    },
    strength="coverage",
    contact=_contact,
    pack=_pack,
    n_states=1,
)
"""Film of rubber that forms on the shaft."""
