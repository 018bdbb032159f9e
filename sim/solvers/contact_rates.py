# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any, disable-error-code=call-arg
# ruff: noqa: ANN001
"""What moves the lumped model at one instant, with any friction law and any effects.

Compiled into `sim.solvers.contact_kernel` where it is used: what is called through pointers makes
every variable go through memory at each call, and a further call would do so twice. What each hook
reads of the inner states is a view made once, since making one costs more than the call.
"""

from __future__ import annotations

import math

from numba import njit

from models.compilation import PART
from sim.contact import (
    CREEP,
    CRITICAL,
    ELASTOMER_TORQUE,
    KINETIC,
    SHAFT_ANGLE,
    SHAFT_INERTIA,
    SHAFT_LAG,
    SHAFT_LAG_RATE,
    SHAFT_SPEED,
    SHAFT_TORQUE,
    SLIDING_SPEED,
    STICK_TIME,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
    TWIST_RATE,
    call_hook_at,
    call_law_at,
    pointer,
)
from sim.solvers.contact_state import N_LAG, N_MOTION

__all__ = ["contact_rates"]

_CREEP_ACCURACY = 1e-4
"""Of a creep's share before its last secant, which squares it."""

_MOST_CREEP_PASSES = 30


@njit(forceinline=True, **PART)
def contact_rates(
    stage, since, i, time, stick_time, mode, bushing, hooks, drive, rows
) -> tuple[float, float, float, float, float, float]:
    """Fill the rates of the state at a stage, `since` sample `i` of the drive [s].

    Returns friction torque, elastomer torque, what holds the surfaces together, what they can
    bear [Nm], the speed of the surface in stick, and that of the shaft [rad/s].
    """
    s, has_law, contact, context = (
        bushing.system,
        bushing.law != 0,
        bushing.contact,
        bushing.context,
    )
    j_e, k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = s[0], s[2], s[3], s[4], s[5], s[6], s[7]
    t_crit, t_kin = s[8], s[9]
    u, k = rows.state, rows.stages
    acceleration = drive.slope[i]
    shaft = drive.speed[i] + acceleration * since
    lag = u.size
    if hooks.n > 0:
        lag -= N_LAG
        shaft -= u[lag + 1]
    sticks = mode == 0 and not has_law
    surface = shaft if sticks else u[1]
    twist = u[0] - u[2]
    e = k_e * twist + c_e * (surface - u[3])
    critical, kinetic, creep = t_crit, t_kin, 0.0
    mobility, shaft_torque = 0.0, 0.0
    if hooks.n > 0:
        context[TIME], context[STICK_TIME] = time, stick_time
        turned = since * (drive.speed[i] + 0.5 * acceleration * since)
        context[SHAFT_ANGLE] = drive.angle[i] + turned
        context[SHAFT_SPEED], context[TWIST] = shaft, twist
        context[SHAFT_LAG], context[SHAFT_LAG_RATE] = u[lag], u[lag + 1]
        # A creeping contact relieves the elastomer's damper, on whose torque its creep depends:
        # a share is sought that makes itself, by secants from rest.
        share, share_before, gap_before = 0.0, 0.0, 0.0
        for turn in range(_MOST_CREEP_PASSES):
            context[SLIDING_SPEED], context[TWIST_RATE] = shaft - surface, surface - u[3]
            context[TORQUE] = e
            contact[CRITICAL], contact[KINETIC] = t_crit, t_kin
            contact[STIFFNESS], contact[ELASTOMER_TORQUE] = k_e, 0.0
            contact[CREEP], contact[SHAFT_TORQUE] = 0.0, 0.0
            contact[SHAFT_INERTIA] = math.inf
            at, seen, where = contact.ctypes, context.ctypes, hooks.addresses
            for a in range(hooks.n):
                call_hook_at(
                    where[a, 0], seen, pointer(where[a, 1]), pointer(where[a, 2]),
                    pointer(where[a, 3]), at,
                )  # fmt: skip
            creep = contact[CREEP]
            gap = creep - share
            if not sticks or gap == 0.0:
                break
            settled = turn > 0 and abs(gap) < _CREEP_ACCURACY
            change = gap
            if turn > 0 and gap != gap_before:
                change = -gap * (share - share_before) / (gap - gap_before)
            share_before, gap_before = share, gap
            share = min(max(share + change, 0.0), 1.0)
            surface = shaft * (1.0 - share)
            e = k_e * twist + c_e * (surface - u[3])
            if settled:
                break
        e += (contact[STIFFNESS] - k_e) * twist + contact[ELASTOMER_TORQUE]
        kinetic = contact[KINETIC]
        # What slides at a torque can be held by it, whatever an effect says.
        critical = max(contact[CRITICAL], kinetic)
        if contact[SHAFT_INERTIA] != math.inf:
            mobility = 1.0 / contact[SHAFT_INERTIA]
            shaft_torque = contact[SHAFT_TORQUE]
    # What holds the surfaces together, on a shaft whose end yields to the same torque.
    if mobility == 0.0:
        holding = e + j_e * acceleration
    else:
        holding = (e + j_e * shaft_torque * mobility) / (1.0 + j_e * mobility)
    if has_law:
        # Laws have the first of the inner states, effects those after.
        friction = call_law_at(
            bushing.law, shaft - surface, bushing.coefficients.ctypes, contact.ctypes,
            rows.inner.ctypes, rows.inner_rates.ctypes,
        )  # fmt: skip
    elif mode == 0:
        friction = holding
    else:
        friction = mode * kinetic
    k[0, stage] = surface
    k[1, stage] = 0.0 if sticks else (friction - e) * j_e_inverse
    k[2, stage] = u[3]
    k[3, stage] = (e - k_b * u[2] - c_b * u[3]) * j_c_inverse
    for j in range(N_MOTION, lag):
        k[j, stage] = rows.rates[j]
    if hooks.n > 0:  # the lag of the shaft's end behind its drive
        k[lag, stage] = u[lag + 1]
        turns = acceleration - (shaft_torque - friction) * mobility
        k[lag + 1, stage] = 0.0 if mobility == 0.0 else turns
    # A slip ends where it is as slow as the creep in which it would stick.
    caught = surface if sticks else shaft * (1.0 - creep)
    return friction, e, holding, critical, caught, shaft
