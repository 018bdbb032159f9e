# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""The compiled loop of the contact solver: steps, their errors, their events, the outputs."""

from __future__ import annotations

import math

from numba import boolean, float64, int64, njit, types

from sim.contact import CRITICAL, HOOK_SIGNATURE, KINETIC, LAW_SIGNATURE, STICKS
from sim.solvers import contact_state as at
from sim.solvers.compilation import UNCOUNTED
from sim.solvers.contact_rates import contact_rates
from sim.solvers.contact_state import N_MOTION, N_STAGES
from sim.solvers.dormand_prince import (
    NODES,
    fill_dense,
    fill_stage,
    step_error,
    vertex,
)

__all__ = ["run_contact"]

_GRACE = 2e-3
"""Time that is granted to what has just begun [s]."""

_LEAST_STEP = 1e-10
"""At which an error is accepted: something jumps [s]."""

_TIME_TOLERANCE = 1e-14
"""[s]"""

_EVENT_TOLERANCE = 1e-11
"""Of torque and speed where stick and slip end, over their scales."""

_TURN_TOLERANCE = 1e-7
"""Of the speed at which a law's sliding turns, over its scale."""

_GRAZE = 2e-3
"""How near an end may come within a step that is not looked at more closely, over its scale."""

_KINK = 1e-7
"""Of the torque that the drive's acceleration takes, over the kinetic one: a step ends there."""

_SAFETY, _LEAST_FACTOR, _MOST_FACTOR = 0.9, 0.2, 4.0

_HOOK = types.FunctionType(HOOK_SIGNATURE)
_LAW = types.FunctionType(LAW_SIGNATURE)
_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]


@njit(
    types.void(
        _VECTOR, _LAW, boolean, _VECTOR,
        _HOOK, _HOOK, _HOOK, _HOOK, _HOOK, _HOOK, _HOOK, _HOOK, int64, _MATRIX, int64[::1],
        _VECTOR, float64, float64, float64, _VECTOR, _MATRIX, _VECTOR, _VECTOR, _MATRIX, _MATRIX,
        int64[::1],
    ),
    cache=True, nogil=True, **UNCOUNTED,
)  # fmt: skip
def run_contact(
    s, law, has_law, coefficients, h0, h1, h2, h3, h4, h5, h6, h7, n_hooks, values, offsets,
    shaft_speed, step, longest, tolerance, carried, rows, context, contact, along, out,
    direction_out,
) -> None:  # fmt: skip
    """Write the columns of `out`; `carried`, `rows` and `context` are carried on.

    The drive may be known beyond the outputs, as far as steps may reach; where it is not, it goes
    on as it did. `along` has room for its slope and angle.
    """
    n, n_known, d = direction_out.size, shaft_speed.size, rows.shape[1]
    k, start, end = rows[:N_STAGES], rows[N_STAGES], rows[N_STAGES + 1]
    u, p, q = rows[N_STAGES + 2], rows[N_STAGES + 3], rows[N_STAGES + 4 :]
    slope, angle = along[0], along[1]
    # What each hook and the law see of the inner states and their rates.
    o0, o1, o2 = N_MOTION + offsets[0], N_MOTION + offsets[1], N_MOTION + offsets[2]
    o3, o4, o5 = N_MOTION + offsets[3], N_MOTION + offsets[4], N_MOTION + offsets[5]
    o6, o7, o8 = N_MOTION + offsets[6], N_MOTION + offsets[7], N_MOTION + offsets[8]
    inner = (
        u[o0:o1], u[o1:o2], u[o2:o3], u[o3:o4],
        u[o4:o5], u[o5:o6], u[o6:o7], u[o7:o8], u[N_MOTION:],
    )  # fmt: skip
    rates = (
        p[o0:o1], p[o1:o2], p[o2:o3], p[o3:o4],
        p[o4:o5], p[o5:o6], p[o6:o7], p[o7:o8], p[N_MOTION:],
    )  # fmt: skip
    numbers = (
        values[0], values[1], values[2], values[3], values[4], values[5], values[6], values[7],
    )  # fmt: skip
    drive = shaft_speed, slope, angle
    t_crit, t_kin = s[8], s[9]
    contact[CRITICAL], contact[KINETIC] = t_crit, t_kin
    angle[0] = carried[at.ANGLE]
    for i in range(n_known - 1):
        slope[i] = (shaft_speed[i + 1] - shaft_speed[i]) / step
        angle[i + 1] = angle[i] + 0.5 * step * (shaft_speed[i] + shaft_speed[i + 1])
    last = max(n_known - 2, 0)  # segment of the drive
    for i in range(last + 1, slope.size):
        slope[i] = slope[last]
    kink = _KINK * t_kin * s[6]
    # The twist at the critical torque, and the speed that it becomes when released.
    twist_scale = max(t_crit, t_kin) / s[2]
    speed_scale = twist_scale * math.sqrt(s[2] * s[6])
    mode, next_mode = int(carried[at.MODE]), int(carried[at.NEXT_MODE])
    slide, first = int(carried[at.SLIDE]), carried[at.FIRST]
    stick_start, stick_length = carried[at.STICK_START], carried[at.STICK_LENGTH]
    t0, t1 = carried[at.STEP_START], carried[at.STEP_END]
    step_of_stick, step_of_slip = carried[at.STEP_OF_STICK], carried[at.STEP_OF_SLIP]
    fresh, n_done = carried[at.FRESH] != 0.0, carried[at.DONE]
    sample, i0 = 0, 0
    friction, e, holding, critical, caught, shaft = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    far_start, far, far_early, far_late = carried[at.FAR], 0.0, 0.0, 0.0
    if t1 <= _TIME_TOLERANCE:  # the drive may have a kink here
        fresh = True
    while True:
        dense = False
        while sample < n and sample * step < t1:
            length = t1 - t0
            if not dense:
                dense = True
                fill_dense(q, k, length)
            x = (sample * step - t0) / length
            for j in range(d):
                u[j] = start[j] + x * (q[0, j] + x * (q[1, j] + x * (q[2, j] + x * q[3, j])))
            time = (first + sample) * step
            i = min(sample, last)
            stick_time = time - stick_start if mode == 0 else stick_length
            friction, e, holding, critical, caught, shaft = contact_rates(
                (sample - i) * step, i, time, stick_time, mode, u, p, s, law, has_law, coefficients,
                h0, h1, h2, h3, h4, h5, h6, h7, n_hooks, numbers, inner, rates, drive, context,
                contact,
            )  # fmt: skip
            out[0, sample], out[1, sample] = friction, e
            out[2, sample], out[3, sample], out[4, sample] = u[0], p[0], u[2]
            out[5, sample], out[6, sample] = u[3], shaft
            direction_out[sample] = mode
            sample += 1
        if sample == n:
            break
        if n_done * at.SHORTEST_STEP > _GRACE + first * step + t1:
            carried[at.DONE] = -1.0
            return
        # The next step, on a stretch of the drive without a kink.
        t0 = t1
        if next_mode != mode:
            if mode == 0:
                stick_length = first * step + t0 - stick_start
            else:
                stick_start = first * step + t0
                context[STICKS] += 1.0
            mode, fresh = next_mode, True
        for j in range(d):
            start[j] = end[j]
            k[0, j] = k[N_STAGES - 1, j]
        while i0 < last and (i0 + 1) * step <= t0 + _TIME_TOLERANCE:
            i0 += 1
            if abs(slope[i0] - slope[i0 - 1]) > kink:
                fresh = True
        aim = min(longest, step_of_stick if mode == 0 and not has_law else step_of_slip)
        i_last, limit = i0, math.inf
        while (i_last + 1) * step < t0 + aim:
            if i_last == last:
                if n_known > n:
                    limit = (last + 1) * step
                break
            i_last += 1
            if abs(slope[i_last] - slope[i_last - 1]) > kink:
                limit = i_last * step
                i_last -= 1
                break
        h = min(aim, limit - t0)
        # Whether stick or slip ends in it: brackets of that, and how far from it they are.
        low, high, far_low, far_high, side = 0.0, -1.0, far_start, 0.0, 0
        begin = 0 if fresh else 1
        ends = False
        while True:
            n_done += 1.0
            for stage in range(begin, N_STAGES):
                fill_stage(u, start, k, stage, h)
                t = t0 + NODES[stage] * h
                i = min(max(int(t / step), i0), i_last)
                time = first * step + t
                stick_time = time - stick_start if mode == 0 else stick_length
                friction, e, holding, critical, caught, shaft = contact_rates(
                    t - i * step, i, time, stick_time, mode, u, p, s, law, has_law, coefficients,
                    h0, h1, h2, h3, h4, h5, h6, h7, n_hooks, numbers, inner, rates, drive, context,
                    contact,
                )  # fmt: skip
                for j in range(d):
                    k[stage, j] = p[j]
                if has_law:
                    far = slide * (shaft - u[1])
                elif mode == 0:
                    far = critical - abs(holding)
                else:
                    far = mode * (caught - u[1])
                if stage == 2:
                    far_early = far
                elif stage == 3:
                    far_late = far
                elif stage == 0:
                    far_start = far_low = far
                    if mode == 0 and not has_law and far < 0.0:
                        break
            if begin == 0 and mode == 0 and not has_law and far_start < 0.0:
                # It cannot hold from the start: it slides on, or back.
                mode = next_mode = 1 if holding > 0.0 else -1
                stick_length = first * step + t0 - stick_start
                continue
            begin = 1
            error = step_error(k, h, start, u, twist_scale, speed_scale) / tolerance
            factor = _MOST_FACTOR
            if error > 0.0:
                factor = min(max(_SAFETY * error**-0.2, _LEAST_FACTOR), _MOST_FACTOR)
            if far < 0.0 and high < 0.0 and far_low <= 0.0 and error < math.inf:
                if has_law:  # turned already
                    slide, far, far_low, far_start = -slide, -far, -far_low, -far_start
                elif h > _LEAST_STEP:
                    h *= _LEAST_FACTOR
                    continue
            if high < 0.0 and not (far < 0.0 and error < math.inf):
                if error > 1.0 and h > _LEAST_STEP:
                    h *= min(factor, _SAFETY)
                    aim = h
                    continue
                # Nor may it end within the step and begin again: the vertex of a parabola tells.
                x, least = 1.0, math.inf
                if not has_law:
                    x, least = vertex(0.0, far_start, NODES[2], far_early, NODES[3], far_late)
                    if least == math.inf:
                        x, least = vertex(NODES[2], far_early, NODES[3], far_late, 1.0, far)
                if x > 0.99 or least > _GRAZE * (t_crit if mode == 0 else speed_scale):
                    break
                h *= x
                continue
            # Regula falsi; the end that stays twice counts for half (the Illinois algorithm).
            if far < 0.0:
                if side > 0:
                    far_low *= 0.5
                side = 1
                high, far_high = h, far
            else:
                if side < 0:
                    far_high *= 0.5
                side = -1
                low, far_low = h, far
            if has_law:
                near = abs(far) <= _TURN_TOLERANCE * speed_scale
            elif mode == 0:
                near = abs(far) <= _EVENT_TOLERANCE * t_crit
            else:
                near = abs(far) <= _EVENT_TOLERANCE * speed_scale
            if near or high - low <= _TIME_TOLERANCE:
                if error > 1.0 and h > _LEAST_STEP:
                    h *= min(factor, _SAFETY)
                    aim = h
                    low, high, far_low, side = 0.0, -1.0, far_start, 0
                    continue
                ends = True
                break
            h = 0.5 * (low + high)
            if far_low > 0.0:
                margin = 0.4 * _TIME_TOLERANCE
                secant = low + (high - low) * far_low / (far_low - far_high)
                h = min(max(secant, low + margin), high - margin)
        if not math.isfinite(error):
            for i in range(sample, n):
                for j in range(out.shape[0]):
                    out[j, i] = math.nan
                direction_out[i] = 0
            return
        t1 = t0 + h
        for j in range(d):
            end[j] = u[j]
        follows = h * factor if h == aim else max(aim, h * factor)
        far_start, fresh = far, False
        if has_law or mode != 0:
            step_of_slip = min(follows, longest)
        else:
            step_of_stick = min(follows, longest)
            end[1] = p[0]
        if has_law:
            if ends:
                slide, far_start = -slide, -far
            elif slide == 0 and shaft != u[1]:
                slide = 1 if shaft > u[1] else -1
        elif ends and mode == 0:
            next_mode = 1 if holding > 0.0 else -1
        elif ends:
            next_mode = 0
            end[1] = caught
    carried[at.MODE], carried[at.NEXT_MODE], carried[at.SLIDE] = mode, next_mode, slide
    carried[at.FIRST] = first + n
    carried[at.STICK_START], carried[at.STICK_LENGTH] = stick_start, stick_length
    carried[at.ANGLE], carried[at.DONE], carried[at.FAR] = angle[n], n_done, far_start
    carried[at.STEP_START], carried[at.STEP_END] = t0 - n * step, t1 - n * step
    carried[at.STEP_OF_STICK], carried[at.STEP_OF_SLIP] = step_of_stick, step_of_slip
    carried[at.FRESH] = 1.0 if fresh else 0.0
