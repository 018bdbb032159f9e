# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN202
"""Compiled loop of the contact solver: steps, error control, events and outputs.

A step is repeated until its error is small enough. Where stick or slip ends within it, or a law's
sliding reverses, its length is iterated until that happens at its end; the next step begins with
the new right-hand side. Outputs are interpolated within the step that covers them.
`sim.solvers.contact_solver` has the right-hand side and the records.
"""

from __future__ import annotations

import math

from numba import float64, int64, njit, types

from models.compilation import COMPILED, PART
from sim.contact import CRITICAL, KINETIC, STICKS
from sim.solvers import contact_solver as at
from sim.solvers.tsitouras import (
    NODES,
    factor_of_step,
    fill_between,
    fill_stage,
    step_error,
    value_between,
    vertex,
)

_GRACE = 2e-3
"""Time at the start of a run that does not count towards the average step [s]."""

_LEAST_STEP = 1e-10
"""Step at which any error is accepted, since something jumps [s]."""

_TIME_TOLERANCE = 1e-14
"""Tolerance of the time of an event [s]."""

_EVENT_TOLERANCE = 1e-11
"""Tolerance of torque and speed where stick and slip end, over their scales."""

_TURN_TOLERANCE = 1e-7
"""Tolerance of the speed at which a law's sliding reverses, over its scale."""

_SECANTS = 4
"""Secant steps to the reversal of sliding in the dense output."""

_GRAZE = 2e-3
"""Distance to an event below which a step is examined for one, over its scale."""

_STALLED, _INSTANT = 10_000, 1e-9
"""Steps within an instant [s] from which on a graze is passed over."""

_KINK = 1e-7
"""Change of the drive's inertia torque at which a step ends, over the kinetic torque."""

_LEAST_FACTOR = 0.2
"""Factor that shortens a step in which the event cannot be bracketed."""

_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]
_RECORD = types.BaseTuple.from_types
_BUSHING = _RECORD([_VECTOR, int64, _VECTOR, _VECTOR, _VECTOR], at.Bushing)
_HOOKS = _RECORD([int64, int64[:, ::1]], at.Hooks)
_DRIVE = _RECORD([float64, _VECTOR, _VECTOR, _VECTOR], at.Drive)
_ROWS = _RECORD([_MATRIX, *[_VECTOR] * 7], at.Rows)
_LIMITS = _RECORD([float64, float64], at.Limits)


@njit(**PART)
def _stretch(drive, last, n, kink, i, end):
    """Return the last segment of the drive that a step up to `end` may reach, and its end.

    A step may cross samples, but not a kink of the drive.
    """
    while (i + 1) * drive.step < end:
        if i == last:
            # At the end of a block the drive is unknown; at the end of the run it continues.
            return i, (last + 1) * drive.step if drive.speed.size > n else math.inf
        i += 1
        if abs(drive.slope[i] - drive.slope[i - 1]) > kink:
            return i - 1, i * drive.step
    return i, math.inf


@njit(**PART)
def _bracketed(h, far, low, high, far_low, far_high, side):
    """Return a new length of a step in which stick or slip ends, and its bracket.

    Regula falsi; an end that stays twice counts half (the Illinois algorithm).
    """
    if far < 0.0:
        if side > 0.0:
            far_low *= 0.5
        side = 1.0
        high, far_high = h, far
    else:
        if side < 0.0:
            far_high *= 0.5
        side = -1.0
        low, far_low = h, far
    h = 0.5 * (low + high)
    if far_low > 0.0:
        margin = 0.4 * _TIME_TOLERANCE
        secant = low + (high - low) * far_low / (far_low - far_high)
        h = min(max(secant, low + margin), high - margin)
    return h, low, high, far_low, far_high, side


@njit(**PART)
def _turn_within(start, end_speed, k, h, slide, far_start, far_end):
    """Return the share of a step at which sliding reverses in its dense output, by secants.

    The speed of the shaft is interpolated linearly.
    """
    x_before, far_before = 0.0, far_start
    x = far_start / (far_start - far_end)
    for _ in range(_SECANTS):
        bend = start[1] + x * (end_speed - start[1]) - value_between(start, k, 1, x, h)
        far = far_start + x * (far_end - far_start) + slide * bend
        if far == far_before:
            break
        x_next = x - far * (x - x_before) / (far - far_before)
        x_before, far_before = x, far
        x = min(max(x_next, 0.0), 1.0)
    return x


@njit(
    types.void(
        _BUSHING, _HOOKS, _DRIVE, _LIMITS, _VECTOR, _ROWS, _MATRIX, int64[::1],
    ),
    cache=True, nogil=True, **COMPILED,
)  # fmt: skip
def run_contact(bushing, hooks, drive, limits, carried, rows, out, direction_out) -> None:
    """Fill the columns of `out`, and update `carried`, `rows` and the context.

    The drive may extend beyond the outputs, as far as steps may reach; beyond its end its slope
    continues.
    """
    s, has_law, context = bushing.system, bushing.law != 0, bushing.context
    k, start, end, u = rows.stages, rows.start, rows.end, rows.state
    slope, step, tolerance = drive.slope, drive.step, limits.tolerance
    n, d = direction_out.size, u.size
    lag = d - at.N_LAG if hooks.n > 0 else d
    last = max(drive.speed.size - 2, 0)  # segment of the drive
    t_crit, t_kin = s[8], s[9]
    bushing.contact[CRITICAL], bushing.contact[KINETIC] = t_crit, t_kin
    kink = _KINK * t_kin * s[6]
    # Scales: the twist at the critical torque, and the speed that it releases.
    twist_scale = max(t_crit, t_kin) / s[2]
    speed_scale = twist_scale * math.sqrt(s[2] * s[6])
    per_angle, per_speed = 1.0 / twist_scale, 1.0 / speed_scale
    # Distance to the end of stick or slip that counts as reached.
    if has_law:
        near_stick, near_slip = _TURN_TOLERANCE * speed_scale, _TURN_TOLERANCE * speed_scale
    else:
        near_stick, near_slip = _EVENT_TOLERANCE * t_crit, _EVENT_TOLERANCE * speed_scale
    mode, next_mode = int(carried[at.MODE]), int(carried[at.NEXT_MODE])
    slide, first = int(carried[at.SLIDE]), carried[at.FIRST]
    stick_start, stick_length = carried[at.STICK_START], carried[at.STICK_LENGTH]
    t0, t1 = carried[at.STEP_START], carried[at.STEP_END]
    step_of_stick, step_of_slip = carried[at.STEP_OF_STICK], carried[at.STEP_OF_SLIP]
    fresh, n_steps, error_before = carried[at.FRESH] != 0.0, carried[at.STEPS], carried[at.ERROR]
    sample, i0 = 0, 0
    friction, e, holding, critical, caught, shaft = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    far_start, far, far_early, far_late = carried[at.FAR], 0.0, 0.0, 0.0
    t_before, n_before = t1, n_steps
    if t1 <= _TIME_TOLERANCE:  # the drive may have a kink here
        fresh = True
    while True:
        # Outputs within the last step.
        while sample < n and sample * step < t1:
            length = t1 - t0
            fill_between(u, start, k, rows.weights, (sample * step - t0) / length, length)
            time = (first + sample) * step
            i = min(sample, last)
            stick_time = time - stick_start if mode == 0 else stick_length
            friction, e, holding, critical, caught, shaft = at.contact_rates(
                int64(at.N_STAGES), (sample - i) * step, i, time, stick_time, mode, bushing, hooks,
                drive, rows,
            )  # fmt: skip
            surface = k[0, at.N_STAGES]
            out[0, sample], out[1, sample] = friction, e
            out[2, sample], out[3, sample], out[4, sample] = u[0], surface, u[2]
            out[5, sample], out[6, sample] = u[3], shaft
            direction_out[sample] = mode
            sample += 1
        if sample == n:
            break
        if n_steps * at.SHORTEST_STEP > _GRACE + first * step + t1:
            carried[at.STEPS] = -1.0  # too many steps
            return
        # The next step begins at the end of the last, in the mode after its event.
        t0 = t1
        if next_mode != mode:
            if mode == 0:  # the contact has broken loose
                stick_length = first * step + t0 - stick_start
            else:  # the contact has caught
                stick_start = first * step + t0
                context[STICKS] += 1.0
            mode, fresh, error_before = next_mode, True, 1.0
        for j in range(d):
            start[j] = end[j]
            k[j, 0] = k[j, at.N_STAGES - 1]
        while i0 < last and (i0 + 1) * step <= t0 + _TIME_TOLERANCE:
            i0 += 1
            if abs(slope[i0] - slope[i0 - 1]) > kink:
                fresh = True
        aim = min(limits.longest, step_of_stick if mode == 0 and not has_law else step_of_slip)
        i_last, limit = _stretch(drive, last, n, kink, i0, t0 + aim)
        h = min(aim, limit - t0)
        # Bracket of the end of stick or slip within the step, and distances to the event.
        low, high, far_low, far_high, side = 0.0, -1.0, far_start, 0.0, 0.0
        begin = 0 if fresh else 1
        ends = False
        while True:
            n_steps += 1.0
            for stage in range(begin, at.N_STAGES):
                fill_stage(u, start, k, stage, h)
                t = t0 + NODES[stage] * h
                i = min(max(int(t / step), i0), i_last)
                time = first * step + t
                stick_time = time - stick_start if mode == 0 else stick_length
                friction, e, holding, critical, caught, shaft = at.contact_rates(
                    stage, t - i * step, i, time, stick_time, mode, bushing, hooks, drive,
                    rows,
                )  # fmt: skip
                # Distance to the end of stick or slip, or to the reversal of sliding.
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
                # The contact cannot hold from the start: it slides on, or back.
                mode = next_mode = 1 if holding > 0.0 else -1
                stick_length = first * step + t0 - stick_start
                continue
            begin = 1
            error = step_error(k, h, start, u, lag, per_angle, per_speed) / tolerance
            factor = factor_of_step(error, error_before)
            if far < 0.0 and high < 0.0 and far_low <= 0.0 and error < math.inf:
                # The event lies before the step: sliding has already reversed, or the step is too
                # long to bracket it.
                if has_law:
                    slide, far, far_low, far_start = -slide, -far, -far_low, -far_start
                elif h > _LEAST_STEP:
                    h *= _LEAST_FACTOR
                    continue
            if high < 0.0 and not (far < 0.0 and error < math.inf):
                # No event so far: check the error.
                if error > 1.0 and h > _LEAST_STEP:
                    h *= factor
                    aim = h
                    continue
                # Check for an event and its reversal within the step, by a parabola's vertex.
                x, least = 1.0, math.inf
                if not has_law:
                    x, least = vertex(0.0, far_start, NODES[2], far_early, NODES[3], far_late)
                    if least == math.inf:
                        x, least = vertex(NODES[2], far_early, NODES[3], far_late, 1.0, far)
                if x > 0.99 or least > _GRAZE * (t_crit if mode == 0 else speed_scale):
                    break
                if n_steps - n_before > _STALLED:  # it begins there: time has to go on
                    break
                h *= x
                continue
            # An event lies within the step, which is repeated until the event is at its end.
            trial, whole = h, high < 0.0
            h, low, high, far_low, far_high, side = _bracketed(
                h, far, low, high, far_low, far_high, side
            )
            if has_law and whole:
                h = trial * _turn_within(start, u[1], k, trial, slide, far_start, far)
            near = abs(far) <= (near_stick if mode == 0 else near_slip)
            if near or high - low <= _TIME_TOLERANCE:
                h = trial
                if error > 1.0 and h > _LEAST_STEP:  # event located, but the step is too long
                    h *= factor
                    aim = h
                    low, high, far_low, side = 0.0, -1.0, far_start, 0.0
                    continue
                ends = True
                break
        if not math.isfinite(error):
            for i in range(sample, n):
                for j in range(out.shape[0]):
                    out[j, i] = math.nan
                direction_out[i] = 0
            return
        # Accept the step.
        t1 = t0 + h
        if t1 > t_before + _INSTANT:
            t_before, n_before = t1, n_steps
        for j in range(d):
            end[j] = u[j]
        if h == aim:
            follows, error_before = h * factor, error
        else:
            follows = max(aim, h * factor)
        far_start, fresh = far, False
        if has_law or mode != 0:
            step_of_slip = min(follows, limits.longest)
        else:
            step_of_stick = min(follows, limits.longest)
            end[1] = k[0, at.N_STAGES - 1]  # the surface goes with the shaft
        if has_law:
            if ends:  # the sliding turns
                slide, far_start = -slide, -far
            elif slide == 0 and shaft != u[1]:  # it begins
                slide = 1 if shaft > u[1] else -1
        elif ends and mode == 0:  # it breaks loose
            next_mode = 1 if holding > 0.0 else -1
        elif ends:  # it is caught
            next_mode = 0
            end[1] = caught
    carried[at.MODE], carried[at.NEXT_MODE], carried[at.SLIDE] = mode, next_mode, slide
    carried[at.FIRST] = first + n
    carried[at.STICK_START], carried[at.STICK_LENGTH] = stick_start, stick_length
    carried[at.ANGLE], carried[at.STEPS], carried[at.FAR] = drive.angle[n], n_steps, far_start
    carried[at.STEP_START], carried[at.STEP_END] = t0 - n * step, t1 - n * step
    carried[at.STEP_OF_STICK], carried[at.STEP_OF_SLIP] = step_of_stick, step_of_slip
    carried[at.FRESH], carried[at.ERROR] = (1.0 if fresh else 0.0), error_before
