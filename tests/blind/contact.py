"""Contacts that creep instead of sticking: bristles whose strength depends on speed and age.

The shear of the bristles follows its equation exactly over a step in which sliding speed and
strength stand still, which is stable at any stiffness; the age of the contact likewise. Three laws
have formulas of this rig's own, for rigs to be identified; four are as a rig file states them.
"""

from __future__ import annotations

import math

from numba import njit

PART = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
"""Of functions that only compiled functions call."""

TRUE_STICK, BRISTLE, RATE_AND_STATE, MEMORY = range(4)
LORENTZIAN, LUGRE, STATED_RATE_AND_STATE, STATED_MEMORY = BRISTLE, 4, 5, 6

# Numbers of a contact; stiffness and dampers are per kinetic torque
(STIFFNESS, DAMPER, DROP, SPEED, RENEWAL, TIME, DIRECT, WEAKENING, EXPONENT, VISCOUS) = range(10)
N_CONTACT = 10

# Its state
SHEAR, AGE, REST = range(3)
START = (0.0, 1.0, 1.0)

LONGEST = 0.02
"""After which a contact gains no more strength by the logarithm of its age [s]."""

RENEWAL_OF_REST = 4e-4
"""Sliding that renews what an effect of ageing has regained [rad]."""


@njit(**PART)
def strength(law, c, kinetic, drop, speed, age):
    """Torque that a contact of this age bears at this sliding speed."""
    drop = c[DROP] * drop
    if law == BRISTLE:
        x = speed / c[SPEED]
        return kinetic + drop / (1.0 + x * x)
    if law == LUGRE:
        x = speed / c[SPEED]
        return kinetic + drop * math.exp(-x * x)
    if law == RATE_AND_STATE:
        aged = math.log1p(min(age, LONGEST) / c[TIME]) / math.log1p(LONGEST / c[TIME])
        return kinetic * (1.0 + c[DIRECT] * math.log1p(speed / 0.05)) + drop * aged
    if law == MEMORY:
        aged = 1.0 - math.exp(-math.sqrt(age / c[TIME]))
        return kinetic * (1.0 + c[WEAKENING] / (1.0 + speed / c[SPEED])) + drop * aged
    aged = age / (age + c[TIME])
    if law == STATED_RATE_AND_STATE:
        return kinetic * (1.0 + c[DIRECT] * math.log1p(speed / c[SPEED])) + drop * aged
    fading = c[WEAKENING] * math.exp(-((speed / c[SPEED]) ** c[EXPONENT]))
    return kinetic * (1.0 + fading) + drop * aged


@njit(**PART)
def _renewed(age, rate, h):
    """Age after a step in which sliding takes it away at a rate."""
    if rate > 1e-9:
        return 1.0 / rate + (age - 1.0 / rate) * math.exp(-h * rate)
    return age + h


@njit(**PART)
def drag_of(law, c, stiff, kinetic, drop, v, h, b):
    """Advance the contact's state `b` by `h`; return its torque at the sliding speed `v`.

    `stiff` is the kinetic torque that stiffness and dampers go with.
    """
    speed = abs(v)
    stiffness = c[STIFFNESS] * stiff
    settled = strength(law, c, kinetic, drop, speed, b[AGE]) / stiffness
    if v < 0.0:
        settled = -settled
    before = b[SHEAR]
    if speed * h > 1e-9 * abs(settled):
        b[SHEAR] = settled + (before - settled) * math.exp(-h * speed / abs(settled))
    else:
        b[SHEAR] += h * v
    slip = speed
    if law in (RATE_AND_STATE, STATED_RATE_AND_STATE):  # slip alone renews, not elastic shear
        slip = speed * min(abs(b[SHEAR] / settled), 1.0)
    b[AGE] = _renewed(b[AGE], slip / c[RENEWAL], h)
    b[REST] = _renewed(b[REST], speed / RENEWAL_OF_REST, h)
    damped = c[DAMPER] * stiff * (b[SHEAR] - before) / h
    return stiffness * b[SHEAR] + damped + c[VISCOUS] * stiff * v
