r"""Frictional heating: a warmer contact carries less torque.

.. math::
    T_{kin}, T_{crit} \to h(\Delta) \, T_{kin}, T_{crit}, \qquad
    \Delta(t) = \int_0^t P(t') \, G(t - t') \, dt', \qquad P = T_{kin} |v|

with h = exp(-b Delta), where b is free since the thesis has no figure for it. The kernel G of each
form is a sum of exponentials with one state each:

- half_space: G = 1 / (A e sqrt(pi t)), the two half-spaces of Appendix G with the effusivities
  k / sqrt(alpha) of steel and rubber together, e = 8116 W s^(1/2) / (m2 K). Eight exponentials,
  fitted to the step response, match it within 1 % from 2 ms to a minute; later they saturate.
- lumped: G = (R / tau) exp(-t / tau), one heat capacity.
- two_layer: half_space in series with the paint of the shaft, which the appendix leaves out: it
  adds d / (k A) for the steel's share of the heat, within 4 d2 / (pi2 alpha), its slowest mode.
- linear_with_floor: half_space with h = max(1 - b Delta, h0).

300 W on A = 7.7e-4 m2, a fifth of the apparent area, for 0.23 s give the 26 K of the appendix.
Limits: b = 0 is the plain model, as is a contact that never slides.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED, contact_hook
from sim.effects.effect import Effect, Parameter, Stage, Values

_FORMS = ("half_space", "lumped", "two_layer", "linear_with_floor")

_STEEL_EFFUSIVITY = 14.9 / math.sqrt(3.95e-6)
_RUBBER_EFFUSIVITY = 0.16 / math.sqrt(6.69e-8)
"""Thermal effusivities of Table G1 [W s^(1/2) / (m2 K)]."""

_RATES = 2000.0 * 6.0 ** -np.arange(8)
"""Decay rates of the half-space's exponentials [1/s]."""

_PAINT_CONDUCTIVITY = 0.25
"""Thermal conductivity of epoxy paint [W/(m K)]."""
_PAINT_DIFFUSIVITY = 1.2e-7
"""Thermal diffusivity of epoxy paint [m2/s]."""

_HEADER = 4


def _half_space(area: float) -> NDArray[np.float64]:
    """Return the temperature rise per energy of each exponential [K/J], by least squares."""
    time = np.geomspace(1e-3, 60.0, 100)[:, None]
    step = -np.expm1(-_RATES * time) / _RATES
    weights, *_ = np.linalg.lstsq(step / (2.0 * np.sqrt(time / np.pi)), np.ones(100), rcond=None)
    return np.asarray(weights / (area * (_STEEL_EFFUSIVITY + _RUBBER_EFFUSIVITY)))


def _pack(form: str, values: Values, _rng: np.random.Generator) -> NDArray[np.float64]:
    area = values["area"]
    if form == "lumped":
        rates = np.array([1.0 / values["time_constant"]])
        weights = values["resistance"] * rates
    else:
        weights, rates = _half_space(area), _RATES
    if form == "two_layer":
        thickness = values["paint_thickness"]
        share = _STEEL_EFFUSIVITY / (_STEEL_EFFUSIVITY + _RUBBER_EFFUSIVITY)
        rate = 0.25 * math.pi**2 * _PAINT_DIFFUSIVITY / thickness**2
        rates = np.append(rates, rate)
        weights = np.append(weights, rate * share * thickness / (_PAINT_CONDUCTIVITY * area))
    linear = form == "linear_with_floor"
    header = [values["softening"], linear, values["floor"], rates.size]
    return np.concatenate([header, weights, rates])


@contact_hook
def _contact(context, values, state, state_rates, contact):
    n = int(values[3])
    rise = 0.0
    for i in range(n):
        rise += state[i]
    if values[1] != 0.0:
        factor = max(1.0 - values[0] * rise, values[2])
    else:
        factor = math.exp(-values[0] * rise)
    contact[KINETIC] *= factor
    contact[CRITICAL] *= factor
    power = contact[KINETIC] * abs(context[SLIDING_SPEED])
    for i in range(n):
        state_rates[i] = values[_HEADER + i] * power - values[_HEADER + n + i] * state[i]


EFFECT = Effect(
    name="frictional_heating",
    stage=Stage.FRICTION,
    forms=_FORMS,
    parameters={
        "softening": Parameter(0.01, "1/K", 0.0, 0.1, "b: share of the torque lost per kelvin"),
        "area": Parameter(7.7e-4, "m2", 1e-6, 1e-2, "A: real area of contact"),
        "resistance": Parameter(
            0.28, "K/W", 1e-3, 100.0, "R: steady temperature rise per power; lumped only"
        ),
        "time_constant": Parameter(1.0, "s", 1e-3, 1e4, "tau: time constant; lumped only"),
        "paint_thickness": Parameter(
            50e-6, "m", 5e-6, 1e-3, "d: thickness of the paint; two_layer only"
        ),
        "floor": Parameter(
            0.4, "", 0.0, 1.0, "h0: least share of the torque; linear_with_floor only"
        ),
    },
    strength="softening",
    contact=_contact,
    pack=_pack,
    n_states=_RATES.size + 1,
)
"""Torque that falls as friction heats the surface."""
