"""The two small arrays that solver, friction laws and effects share while a motion is solved.

Effects read the *context*, what goes on at this instant, and change the *contact*, what bushing
and elastomer are at this instant. Friction laws read the contact. Compiled functions with these
signatures are called through pointers, so that one compiled solver serves all laws and effects;
what they are given are pointers to the first of so many numbers, which costs less than arrays do.
"""
# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
# mypy: allow-untyped-calls
# ruff: noqa: ANN001, ANN201

from __future__ import annotations

from numba import float64, njit, types
from numba.extending import intrinsic

__all__ = [
    "CREEP", "CRITICAL", "ELASTOMER_TORQUE", "HOOK_SIGNATURE", "KINETIC", "LAW_SIGNATURE",
    "N_CONTACT", "N_CONTEXT", "SHAFT_ANGLE", "SHAFT_INERTIA", "SHAFT_LAG", "SHAFT_LAG_RATE",
    "SHAFT_SPEED", "SHAFT_TORQUE", "SLIDING_SPEED", "STICKS", "STICK_TIME", "STIFFNESS", "TIME",
    "TORQUE", "TWIST", "TWIST_RATE", "call_hook", "call_law", "no_hook", "no_law", "pointer",
    "slipless",
]  # fmt: skip

# Context.
TIME = 0
"""Since the start [s]."""
SHAFT_ANGLE = 1
"""Of the drive [rad]."""
SHAFT_SPEED = 2
"""At the bushing [rad/s]."""
SLIDING_SPEED = 3
"""Of the shaft over the bushing's surface [rad/s]; in stick that of the creep."""
STICK_TIME = 4
"""Since the contact began to stick [s]; that of the last stick while it slides. With a law that has
an inner state nothing begins to stick, and this is `TIME`: such laws carry the age of their contact
as a state, and effects that need one have their own for them, as `static_ageing` does."""
STICKS = 5
"""How often the contact has begun to stick; 0 throughout with a law that has an inner state."""
TWIST = 6
"""Of the elastomer, theta1 - theta2 [rad]."""
TWIST_RATE = 7
"""[rad/s]"""
TORQUE = 8
"""In the elastomer, before effects [Nm]."""
SHAFT_LAG = 9
"""Angle by which the shaft at the bushing lags behind its drive [rad]."""
SHAFT_LAG_RATE = 10
"""[rad/s]"""
N_CONTEXT = 11

# Contact.
CRITICAL = 0
"""Torque at which it breaks [Nm]."""
KINETIC = 1
"""Torque while it slides [Nm]."""
STIFFNESS = 2
"""Of the elastomer [Nm/rad]."""
ELASTOMER_TORQUE = 3
"""What the elastomer adds to stiffness and damping [Nm]."""
CREEP = 4
"""Share of the shaft's speed at which the contact slips while it sticks."""
SHAFT_INERTIA = 5
"""Of the shaft's end on a compliant shaft [kg m2]; infinite on a rigid one."""
SHAFT_TORQUE = 6
"""Of the compliant shaft on its end [Nm]."""
N_CONTACT = 7

_POINTER = types.CPointer(float64)
_ARRAY = float64[::1]

HOOK_SIGNATURE = types.void(_POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
"""``hook(context, values, state, state_rates, contact)`` changes `contact`, fills `state_rates`."""

LAW_SIGNATURE = float64(float64, _POINTER, _POINTER, _POINTER, _POINTER)
"""``torque = law(sliding_speed, coefficients, contact, state, state_rates)``."""


@intrinsic
def pointer(_context, address):
    """Pointer to numbers at an address, as `ndarray.ctypes` has it; for compiled code."""

    def cast(context, builder, signature, arguments):  # noqa: ANN202
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    return _POINTER(address), cast


@njit(HOOK_SIGNATURE, cache=True)
def no_hook(context, values, state, state_rates, contact):
    """Leave the contact as it is, in place of an effect that there is not."""


@njit(LAW_SIGNATURE, cache=True)
def no_law(sliding_speed, coefficients, contact, state, state_rates):  # noqa: ARG001
    """Torque in place of a law's where the contact truly sticks [Nm]: none."""
    return 0.0


@njit(types.void(types.FunctionType(HOOK_SIGNATURE), *[_ARRAY] * 5), cache=True)
def call_hook(hook, context, values, state, state_rates, contact):
    """Call an effect's compiled function with arrays, which Python could not."""
    hook(context.ctypes, values.ctypes, state.ctypes, state_rates.ctypes, contact.ctypes)


@njit(float64(types.FunctionType(LAW_SIGNATURE), float64, *[_ARRAY] * 4), cache=True)
def call_law(law, sliding_speed, coefficients, contact, state, state_rates):
    """Call a law's compiled function with arrays; returns its torque [Nm]."""
    return law(sliding_speed, coefficients.ctypes, contact.ctypes, state.ctypes, state_rates.ctypes)


@njit(cache=True)
def slipless(context):
    """Whether a contact has not slipped since the start, or its law knows no slips."""
    return context[STICKS] == 0.0 and context[STICK_TIME] == context[TIME]
