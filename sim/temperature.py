# mypy: allow-untyped-defs, allow-untyped-decorators, allow-untyped-calls
# ruff: noqa: ANN001, ANN202
"""Temperature dependence of a rig's stiffness, damping and friction, by `models.bushing`.

A simulated condition calls `at_temperature` once. Friction changes through an effect on the
contact, so it works with any law.
"""

import math
from dataclasses import replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.rig import Fit, LawSpec, Rig
from sim.contact import CRITICAL, KINETIC, SLIDING_SPEED
from sim.effects.effect import Effect, Stage, Values
from sim.friction.shared import FASTEST
from sim.parameters import Parameter

_SLOWEST = 0.25
"""Speed below which the bell's factor is constant [rad/s]: the slowest of the measurements (5.1.2).
It also applies to a contact at rest, for whose creep no bell was measured."""

_MEMORY = 3e-4
"""Sliding angle over which the factor follows the speed, 4.5 um on the shaft [rad]: one value for
all fits, within the range over which the fluorocarbon's contact is renewed (0.7e-4 rad at 0.178 mm,
1.4e-4 at 0.279 mm, 6.4e-4 at 0.381 mm). Steady sliding does not depend on it."""


def _pack(_form: str, values: Values, _rng: np.random.Generator) -> NDArray[np.float64]:
    peak = math.log10(values["peak"])
    packed = np.array([peak, peak - values["log_shift"], values["width"], values["floor"], 0.0])
    packed[4] = _log_factor(0.0, packed)
    return packed


@njit(cache=True, error_model="numpy")
def _log_factor(v, values):
    """Return the logarithm of the bell's height over that at the reference temperature."""
    speed = 0.5 * math.log10(v * v + _SLOWEST * _SLOWEST)
    before = (speed - values[0]) / values[2]
    now = (speed - values[1]) / values[2]
    floor, bell = values[3], 1.0 - values[3]
    return math.log(
        (floor + bell * math.exp(-0.5 * now * now))
        / (floor + bell * math.exp(-0.5 * before * before))
    )


@njit(cache=True, error_model="numpy")  # by `HOOK_SIGNATURE`, when a temperature acts
def _contact(context, values, state, state_rates, contact):
    v = context[SLIDING_SPEED]
    factor = math.exp(values[4] + state[0])
    contact[KINETIC] *= factor
    contact[CRITICAL] *= factor
    renewal = min(abs(v) / _MEMORY, FASTEST)
    state_rates[0] = renewal * (_log_factor(v, values) - values[4] - state[0])


FRICTION_SHIFT = Effect(
    name="friction_at_temperature",
    stage=Stage.FRICTION,
    forms=("bell",),
    parameters={
        "log_shift": Parameter(0.0, "", -30.0, 30.0, "log10 a_T from the reference temperature"),
        "peak": Parameter(1.0, "rad/s", 1e-12, 1e12, "v_p: of highest friction at the reference"),
        "width": Parameter(2.24, "", 1e-3, 20.0, "w: decades from the peak to 0.61 of its height"),
        "floor": Parameter(0.3, "", 0.0, 1.0, "p_0: share of friction far from the peak"),
    },
    strength="log_shift",
    contact=_contact,
    pack=_pack,
    n_states=1,
)
"""Effect of the ambient temperature on the torques; not one of `sim.effects`, which rigs list."""


def at_temperature(rig: Rig, temperature: float | None) -> Rig:
    """Return a rig with the properties that it has at an ambient temperature.

    Parameters
    ----------
    rig : Rig
    temperature : float, optional
        [degree Celsius]; by default the reference temperature.

    Returns
    -------
    Rig
        The same rig if its material states no dependence, or at the reference temperature;
        otherwise a rig without a temperature dependence.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> at_temperature(rig, 23.0) is rig
    True
    >>> cold = at_temperature(rig, 5.0)
    >>> cold.fit(0.279e-3).elastomer_stiffness > rig.fit(0.279e-3).elastomer_stiffness
    True
    """
    depends = rig.temperature
    if depends is None or temperature is None or temperature == depends.reference:
        return rig
    share, softer = rig.elastomer_damping_share, depends.damping_factor(temperature)
    damping = share * softer + 1.0 - share
    stiffness = depends.stiffness_factor(temperature)
    shift, effects = depends.log_shift(temperature), rig.effects
    if depends.friction_peak is not None and shift != 0.0:
        values = {
            "log_shift": shift,
            "peak": depends.friction_peak,
            "width": depends.friction_width,
            "floor": depends.friction_floor,
        }
        effects = (*effects, LawSpec(FRICTION_SHIFT.name, values))
    return replace(
        rig,
        fits=tuple(_scaled(fit, stiffness, damping) for fit in rig.fits),
        elastomer_damping_share=share * softer / damping,
        effects=effects,
        temperature=None,
    )


def _scaled(fit: Fit, stiffness: float, damping: float) -> Fit:
    return replace(
        fit,
        elastomer_stiffness=stiffness * fit.elastomer_stiffness,
        damping={support: damping * value for support, value in fit.damping.items()},
    )
