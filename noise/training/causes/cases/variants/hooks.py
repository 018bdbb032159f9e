# ruff: noqa: ARG001
"""Compiled functions of variants and unknown effects, most of them hooks of the contact.

What differs from variant to variant is a table among the values, so that few functions serve many
forms. Each table says its own length, since the solver lengthens the values of a shorter effect.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim.contact import (
    CREEP,
    CRITICAL,
    ELASTOMER_TORQUE,
    HOOK_SIGNATURE,
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
    slipless,
)


@njit(cache=True, error_model="numpy")
def _cubic(a, b, c, d, x):
    """Catmull and Rom's cubic between b and c."""
    return b + 0.5 * x * (
        c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a))
    )


@njit(cache=True, error_model="numpy")
def _curve(values, first, x):
    """Read a table over 0 to 1; it starts with its length."""
    n = int(values[first])
    place = min(max(x, 0.0), 1.0) * (n - 1)
    i = min(int(place), n - 2)
    at = first + 1
    return _cubic(
        values[at + max(i - 1, 0)], values[at + i], values[at + i + 1],
        values[at + min(i + 2, n - 1)], place - i,
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def _periodic(values, first, place):
    """Read a table that repeats; it starts with its length."""
    n = int(values[first])
    whole = math.floor(place)
    i = int(whole)
    at = first + 1
    return _cubic(
        values[at + (i - 1) % n], values[at + i % n], values[at + (i + 1) % n],
        values[at + (i + 2) % n], place - whole,
    )  # fmt: skip


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def rate_dependence_hook(context, values, state, state_rates, contact) -> None:
    """Torque over sliding speed: gain, speed, lag; curve over x / (1 + x)."""
    speed = abs(context[SLIDING_SPEED])
    if values[2] > 0.0:
        state_rates[0] = (speed - state[0]) / values[2]
        speed = max(state[0], 0.0)
    x = speed / values[1]
    gained = values[0] * _curve(values, 3, x / (1.0 + x)) * contact[KINETIC]
    contact[KINETIC] += gained
    contact[CRITICAL] += gained


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def ageing_hook(context, values, state, state_rates, contact) -> None:
    """Torques over age.

    Share, time, angle of renewal, what of the curve the plain torque is, whether the whole critical
    torque ages rather than the drop, whether slips renew in part only, share of the kinetic torque
    that ages along; curve over x / (1 + x).
    """
    own_age = max(state[0], 0.0)
    own = values[5] != 0.0 or slipless(context)
    age = own_age if own else max(context[STICK_TIME], 0.0)
    renewal = 1.0 - abs(context[SLIDING_SPEED]) * own_age / values[2]
    state_rates[0] = renewal if own else 0.0
    x = age / values[1]
    gained = values[0] * (_curve(values, 7, x / (1.0 + x)) - values[3])
    aged = contact[CRITICAL] - (0.0 if values[4] != 0.0 else contact[KINETIC])
    contact[KINETIC] *= 1.0 + gained * values[6]
    contact[CRITICAL] = max(contact[CRITICAL] + gained * aged, contact[KINETIC])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def creep_hook(context, values, state, state_rates, contact) -> None:
    """Creep over torque.

    Share, lag, speed of the creep itself (0 where it is a share of the shaft's), time in stick over
    which it fades (0 for none), share of the drop that is lost; curve over the torque's share of
    the critical one.
    """
    contact[CRITICAL] -= values[4] * (contact[CRITICAL] - contact[KINETIC])
    r = min(abs(context[TORQUE]) / contact[CRITICAL], 1.0)
    f = _curve(values, 5, r)
    if values[1] > 0.0:
        state_rates[0] = (f - state[0]) / values[1]
        f = min(max(state[0], 0.0), 1.0)
    if context[TORQUE] * context[SHAFT_SPEED] > 0.0:
        if values[3] > 0.0:
            f /= 1.0 + max(context[STICK_TIME], 0.0) / values[3]
        share = values[0] * f
        if values[2] > 0.0:
            share = min(share * values[2] / abs(context[SHAFT_SPEED]), 0.95)
        contact[CREEP] += share * (1.0 - contact[CREEP])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def patch_hook(context, values, state, state_rates, contact) -> None:
    """Drop over angle or time: points a radian or second, whether over time; factors."""
    along = context[TIME] if values[1] != 0.0 else context[SHAFT_ANGLE]
    share = max(_periodic(values, 2, along * values[0]), 0.0)
    contact[CRITICAL] = contact[KINETIC] + share * (contact[CRITICAL] - contact[KINETIC])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def film_hook(context, values, state, state_rates, contact) -> None:
    """Torque and drop on a film.

    Coverage, torque ratio, drop left, roughness, whether over the shaft's angle rather than the
    angle slid, scale [rad], whether the noise is over angle, its points a second or radian; the
    film's curve, and the noise.
    """
    state_rates[0] = abs(context[SLIDING_SPEED])
    if values[4] != 0.0:
        x = context[SHAFT_ANGLE] / values[5]
        x -= math.floor(x)
    else:
        x = state[0] / values[5]
        x = x / (1.0 + x)
    film = values[0] * _curve(values, 8, x)
    drop = (contact[CRITICAL] - contact[KINETIC]) * (1.0 - film * (1.0 - values[2]))
    along = context[SHAFT_ANGLE] if values[6] != 0.0 else context[TIME]
    rough = _periodic(values, 9 + int(values[8]), along * values[7])
    uneven = max(1.0 + film * values[3] * rough, 0.05)
    contact[KINETIC] *= (1.0 + film * (values[1] - 1.0)) * uneven
    contact[CRITICAL] = contact[KINETIC] + drop


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def heating_hook(context, values, state, state_rates, contact) -> None:
    """Torque over heat.

    Share lost, rise [K] over which, whether heat passes from one capacity to the next, their
    number, shares of it that kinetic torque, critical torque and stiffness lose; weights and rates;
    curve over x / (1 + x).
    """
    n = int(values[3])
    rise = 0.0
    for i in range(n):
        rise = state[i] if values[2] != 0.0 else rise + state[i]
    x = max(rise, 0.0) / values[1]
    lost = values[0] * _curve(values, 7 + 2 * n, x / (1.0 + x))
    contact[KINETIC] *= 1.0 - lost * values[4]
    contact[CRITICAL] = max(contact[CRITICAL] * (1.0 - lost * values[5]), contact[KINETIC])
    contact[STIFFNESS] *= 1.0 - lost * values[6]
    power = contact[KINETIC] * abs(context[SLIDING_SPEED])
    for i in range(n):
        rate = values[7 + n + i]
        if values[2] != 0.0 and i > 0:
            state_rates[i] = rate * (state[i - 1] - state[i])
        else:
            state_rates[i] = values[7 + i] * power - rate * state[i]


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def softening_hook(context, values, state, state_rates, contact) -> None:
    """Stiffness over departure from a mean.

    Share, twist, time of the mean, time for which the amplitude is held; curve over x / (1 + x).
    """
    mean = state[0]
    departure = context[TWIST] - mean
    state_rates[0] = departure / values[2]
    size = abs(departure)
    if values[3] > 0.0:
        risen = size - state[1]
        state_rates[1] = risen / (0.1 * values[3] if risen > 0.0 else values[3])
        size = max(state[1], 0.0)
    x = size / values[1]
    lost = values[0] * _curve(values, 4, x / (1.0 + x)) * contact[STIFFNESS]
    contact[STIFFNESS] -= lost
    contact[ELASTOMER_TORQUE] += lost * mean


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def bristle_hook(context, values, state, state_rates, contact) -> None:
    """Part of the stiffness in bristles that yield: share, number, the twist of each."""
    n = int(values[1])
    held = 0.0
    rate = context[TWIST_RATE]
    for i in range(n):
        bent = state[i]
        held += bent
        state_rates[i] = rate * (1.0 - abs(bent) / values[2 + i]) if rate * bent > 0.0 else rate
    lost = values[0] * contact[STIFFNESS]
    contact[ELASTOMER_TORQUE] += lost * (held / n - context[TWIST])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def dashpot_hook(context, values, state, state_rates, contact) -> None:
    """Branches beside or instead of the spring.

    Number, whether their dashpots thicken (0), thin (1) or are linear (2), twist over which, share
    of the spring that they replace; shares and rates.
    """
    n = int(values[0])
    share = 0.0
    for i in range(n):
        stretch = context[TWIST] - state[i]
        share += values[4 + i] * stretch
        y = min(abs(stretch) / values[2], 4.0)
        faster = 1.0
        if values[1] == 0.0:
            faster = 1.0 / (1.0 + y)
        elif values[1] == 1.0 and y > 1e-6:
            faster = math.sinh(y) / y
        state_rates[i] = stretch * values[4 + n + i] * faster
    contact[ELASTOMER_TORQUE] += contact[STIFFNESS] * (share - values[3] * context[TWIST])


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def compliance_hook(context, values, state, state_rates, contact) -> None:
    """Shaft that yields.

    Inertia (0 for a rigid one), stiffness, share that softens, share that is cubic, lag over which,
    damping, dry torque, lag over which that builds up, share of a Maxwell branch and its rate,
    play to each side.
    """
    if values[0] == 0.0:
        return
    lag, rate = context[SHAFT_LAG], context[SHAFT_LAG_RATE]
    lag -= min(max(lag, -values[10]), values[10])
    y = (lag / values[4]) ** 2
    spring = values[1] * lag * (1.0 - values[2] * y / (1.0 + y) + values[3] * (y - 1.0))
    bent = state[0]
    state_rates[0] = rate / values[7] * (1.0 - abs(bent) if rate * bent > 0.0 else 1.0)
    stretch = lag - state[1]
    state_rates[1] = stretch * values[9]
    contact[SHAFT_INERTIA] = values[0]
    contact[SHAFT_TORQUE] = (
        spring + values[5] * rate + values[6] * bent + values[8] * values[1] * stretch
    )


@njit(cache=True)
def droop(x, limit, deep, rate):
    """Clip as an overloaded amplifier does: it loses gain that comes back afterwards.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Signal over its peak [-].
    limit : float
        At which it is clipped, over the peak [-].
    deep : float
        Share of the gain that is lost in a long overload.
    rate : float
        At which it comes back, a sample [-].

    Returns
    -------
    ndarray, shape (n,)
        As `x` [-].

    Examples
    --------
    >>> droop(np.array([0.5, 2.0, 0.5]), 1.0, 1.0, 0.01).round(2)
    array([0.5 , 0.9 , 0.45])
    """
    y = np.empty_like(x)
    lost = 0.0
    for i in range(x.size):
        over = abs(x[i]) > limit
        lost += min(10.0 * rate, 1.0) * (deep - lost) if over else -min(rate, 1.0) * lost
        y[i] = (1.0 - lost) * min(max(x[i], -limit), limit)
    return y


TORQUES, STIFFNESSES, SPRING, BESIDE, ABSORBER, LOADED = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0
"""What is changed."""

OVER_TIME, OVER_ANGLE = 0.0, 1.0
HEADER = 4


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def table_hook(context, values, state, state_rates, contact):
    """Change one thing, the first value.

    Torques or stiffness by a table over time or angle: whether over angle, period, length; table.
    A spring beside the elastomer: 0, twist from which on, power (0 on one side alone); stiffness.
    Dry friction beside it: its torque, twist over which it builds up, 0.
    A mass that swings in it: stiffness, angular frequency, damping ratio.
    Torques by the elastomer's own torque: share, torque at which nothing changes, 0.
    """
    what, over, scale = values[0], values[1], values[2]
    if what == SPRING:
        deep = context[TWIST] - scale
        if values[3] > 0.0 or deep > 0.0:
            contact[ELASTOMER_TORQUE] += values[HEADER] * deep * abs(deep) ** values[3]
        return
    if what == BESIDE:
        bent, rate = state[0], context[TWIST_RATE] / scale
        state_rates[0] = rate * (1.0 - abs(bent)) if rate * bent > 0.0 else rate
        contact[ELASTOMER_TORQUE] += over * bent
        return
    if what == ABSORBER:
        stretch = context[TWIST] - state[0]
        slip = context[TWIST_RATE] - state[1]
        pull = scale * scale * stretch + 2.0 * values[3] * scale * slip
        state_rates[0], state_rates[1] = state[1], pull
        contact[ELASTOMER_TORQUE] += over * pull / (scale * scale)
        return
    if what == LOADED:
        factor = max(1.0 + over * (abs(context[TORQUE]) / scale - 1.0), 0.2)
        contact[KINETIC] *= factor
        contact[CRITICAL] *= factor
        return
    n = int(values[3])
    x = (context[TIME] if over == OVER_TIME else context[SHAFT_ANGLE]) / scale
    x = (x - math.floor(x)) * n
    i = int(x)
    part = x - i
    table = (1.0 - part) * values[HEADER + i % n] + part * values[HEADER + (i + 1) % n]
    if what == STIFFNESSES:
        contact[STIFFNESS] *= 1.0 + table
    else:
        contact[KINETIC] *= 1.0 + table
        contact[CRITICAL] *= 1.0 + table


@njit(cache=True)
def lagging(x, width):
    """Follow a signal, shape (n,), with play of half the width to each side."""
    y = np.empty_like(x)
    held = x[0]
    for i in range(x.size):
        held = min(max(held, x[i] - width), x[i] + width)
        y[i] = held
    return y


@njit(cache=True)
def slewing(x, most):
    """Follow a signal, shape (n,), by so much a sample at most."""
    y = np.empty_like(x)
    held = x[0]
    for i in range(x.size):
        held += min(max(x[i] - held, -most), most)
        y[i] = held
    return y
