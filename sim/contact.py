"""Arrays shared by solver, friction laws and effects during the solution of a motion.

Effects read the *context*, the kinematics at the current instant, and change the *contact*, the
current properties of contact and elastomer. Friction laws read the contact. Compiled functions with
these signatures are called through pointers, so one compiled solver serves all laws and effects.
Their arguments are pointers to the first element, which cost less than arrays.
"""
# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
# mypy: allow-untyped-calls
# ruff: noqa: ANN001, ANN201

from functools import cache
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import float64, int64, njit, types
from numba.extending import intrinsic as numba_intrinsic

intrinsic: Any = numba_intrinsic  # untyped, since calls leave out the context argument

# Context.
TIME = 0
"""Time since the start [s]."""
SHAFT_ANGLE = 1
"""Angle of the drive [rad]."""
SHAFT_SPEED = 2
"""Speed of the shaft at the bushing [rad/s]."""
SLIDING_SPEED = 3
"""Speed of the shaft over the bushing's surface [rad/s]; in stick, the speed of the creep."""
STICK_TIME = 4
"""Time since the contact began to stick [s]; in sliding, the duration of the last stick. With a law
that has an inner state there is no beginning of stick, and this is `TIME`: such laws have the age
of their contact as a state, and effects that need an age have a state of their own for them, like
`static_ageing`."""
STICKS = 5
"""Number of sticks so far; always 0 with a law that has an inner state."""
TWIST = 6
"""Twist of the elastomer, theta1 - theta2 [rad]."""
TWIST_RATE = 7
"""Rate of the twist [rad/s]."""
TORQUE = 8
"""Torque in the elastomer before effects [Nm]."""
SHAFT_LAG = 9
"""Angle by which the shaft at the bushing lags behind its drive [rad]."""
SHAFT_LAG_RATE = 10
"""Rate of the lag [rad/s]."""
N_CONTEXT = 11

# Contact.
CRITICAL = 0
"""Torque at which the contact breaks [Nm]."""
KINETIC = 1
"""Torque while the contact slides [Nm]."""
STIFFNESS = 2
"""Stiffness of the elastomer [Nm/rad]."""
ELASTOMER_TORQUE = 3
"""Torque of the elastomer beyond that of stiffness and damping [Nm]."""
CREEP = 4
"""Share of the shaft's speed at which the contact slips while it sticks."""
SHAFT_INERTIA = 5
"""Inertia of the end of a compliant shaft [kg m2]; infinite for a rigid one."""
SHAFT_TORQUE = 6
"""Torque of a compliant shaft on its end [Nm]."""
N_CONTACT = 7

_POINTER = types.CPointer(float64)

HOOK_SIGNATURE = types.void(_POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
"""``hook(context, values, state, state_rates, contact)`` changes `contact`, fills `state_rates`."""

LAW_SIGNATURE = float64(float64, _POINTER, _POINTER, _POINTER, _POINTER)
"""``torque = law(sliding_speed, coefficients, contact, state, state_rates)``."""

contact_hook = njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
law_torque = njit(LAW_SIGNATURE, cache=True, error_model="numpy")
"""Compile a hook or a law's torque when its file is imported."""


@intrinsic
def pointer(_context, address):
    """Return a pointer to numbers at an address, like `ndarray.ctypes`; for compiled code."""

    def cast(context, builder, signature, arguments):  # noqa: ANN202
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    return _POINTER(address), cast


@intrinsic
def call_hook_at(_context, address, context, values, state, state_rates, contact):  # noqa: ARG001
    """Call the effect's compiled function at an address; for compiled code."""
    return types.void(int64, *[_POINTER] * 5), _called_at


@intrinsic
def call_law_at(_context, address, speed, coefficients, contact, state, state_rates):  # noqa: ARG001
    """Call the law's compiled function at an address; for compiled code."""
    return float64(int64, float64, *[_POINTER] * 4), _called_at


def _called_at(context, builder, signature, arguments):  # noqa: ANN202
    kinds = [context.get_value_type(kind) for kind in signature.args[1:]]
    returned = signature.return_type
    returns = ir.VoidType() if returned is types.void else context.get_value_type(returned)
    function = builder.inttoptr(arguments[0], ir.FunctionType(returns, kinds).as_pointer())
    result = builder.call(function, arguments[1:])
    return context.get_dummy_value() if returned is types.void else result


@intrinsic
def _address(_context, function):  # noqa: ANN202
    def codegen(context, builder, _signature, arguments):  # noqa: ANN202
        first = builder.extract_value(arguments[0], 0)  # the address by C's convention
        return builder.ptrtoint(first, context.get_value_type(int64))

    return int64(function), codegen


@njit(
    [int64(types.FunctionType(signature)) for signature in (HOOK_SIGNATURE, LAW_SIGNATURE)],
    cache=True,
)
def _address_of(function):  # noqa: ANN202
    return _address(function)


@cache  # the look-up can take longer than a run
def address_of(function: Any) -> int:
    """Return the address of an effect's or a law's compiled function; 0 for None."""
    return 0 if function is None else _address_of(function)


@njit(cache=True)
def slipless(context):
    """Return whether a contact has not slipped yet, or its law has no discrete slips."""
    return context[STICKS] == 0.0 and context[STICK_TIME] == context[TIME]
