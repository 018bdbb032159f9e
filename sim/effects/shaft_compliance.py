r"""Compliance of the shaft: its end turns on a torsional spring.

.. math::
    J \ddot\lambda = J \dot\omega_s + T - T_s(\lambda, \dot\lambda), \qquad
    T_s = \frac{\lambda}{\kappa} + c \dot\lambda, \quad
    \frac{\lambda}{\kappa} \left[1 + \left(\frac{\lambda}{\kappa T_r}\right)^2\right]
    + c \dot\lambda, \quad \frac{\lambda}{\kappa} + c_2 |\dot\lambda| \dot\lambda

lambda is the angle by which the end lags, T the friction torque, kappa the compliance. Forms
linear, stiffening, and quadratic_damping, whose c_2 dissipates as much as c in a vibration at the
shaft's natural frequency with a torque amplitude of T_r.

Defaults: a half-inch schedule 80 pipe of stainless steel (3.1.1; outer diameter 21.3 mm, inner
13.9 mm) whose free-free mode at 8131 Hz (Table 3.1) makes it 0.19 m long: 6750 Nm/rad. The inertia
reproduces the fixed-free mode at 1568 Hz: that of the end piece, J_o of (A15), and a third of the
pipe's. So the rig is nearly rigid, whereas a vehicle's stabilizer bar is not.

Limits: kappa = 0 is the rigid drive. Where the end alone would vibrate above 8 kHz, its inertia is
raised to give 8 kHz, which the integration can resolve; its motion is then quasi-static anyway.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.contact import SHAFT_INERTIA, SHAFT_LAG, SHAFT_LAG_RATE, SHAFT_TORQUE, contact_hook
from sim.effects.effect import Effect, Parameter, Stage, Values

_FORMS = ("linear", "stiffening", "quadratic_damping")

_HIGHEST = 2.0 * math.pi * 8e3
"""Highest natural frequency of the shaft's end [rad/s]."""


def _pack(form: str, values: Values, _rng: np.random.Generator) -> NDArray[np.float64]:
    stiffness = 1.0 / values["compliance"]
    inertia = max(values["inertia"], stiffness / _HIGHEST**2)
    damping = 2.0 * values["damping_ratio"] * math.sqrt(stiffness * inertia)
    cubic = quadratic = 0.0
    reference = values["reference_torque"] / stiffness  # lag [rad]
    if form == "stiffening":
        cubic = stiffness / reference**2
    elif form == "quadratic_damping":
        swing = reference * math.sqrt(stiffness / inertia)  # rate of the lag [rad/s]
        quadratic = 3.0 * math.pi / 8.0 * damping / swing
        damping = 0.0
    return np.array([inertia, stiffness, cubic, damping, quadratic])


@contact_hook
def _contact(context, values, state, state_rates, contact):  # noqa: ARG001
    lag, rate = context[SHAFT_LAG], context[SHAFT_LAG_RATE]
    contact[SHAFT_INERTIA] = values[0]
    contact[SHAFT_TORQUE] = (values[1] + values[2] * lag * lag) * lag + (
        values[3] + values[4] * abs(rate)
    ) * rate


EFFECT = Effect(
    name="shaft_compliance",
    stage=Stage.DRIVE,
    forms=_FORMS,
    parameters={
        "compliance": Parameter(
            1.48e-4, "rad/Nm", 0.0, 0.1, "kappa: torsional compliance of the shaft"
        ),
        "inertia": Parameter(6.96e-5, "kg m2", 1e-6, 1e-1, "J: inertia of the shaft's end"),
        "damping_ratio": Parameter(0.02, "", 0.0, 2.0, "damping ratio of the shaft's end alone"),
        "reference_torque": Parameter(
            20.0, "Nm", 0.1, 1e3, "T_r: reference torque of the non-linear forms"
        ),
    },
    strength="compliance",
    contact=_contact,
    pack=_pack,
)
"""Shaft's end on a torsional spring."""
