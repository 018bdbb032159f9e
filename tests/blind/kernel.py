"""The compiled loop of the second rig: short fixed steps, a state machine for stick and slip.

Velocity Verlet at 300 to 400 kHz, so that the fastest mode turns by 0.02 rad in a step; the instant
at which stick or slip ends is found by a straight line through the step, which is then taken in
two pieces. Everything that an effect may change is a table, a modulation over time or a scalar
that is neutral in the plain rig, and laws of friction that creep are numbers of a contact, so one
loop serves all.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .contact import PART, REST, START, TRUE_STICK, drag_of

# Scalars of a run
(J_E, J_C, K_E, K_B, C_E, C_B, T_CRIT, T_KIN) = range(8)
(FILM_GAIN, FILM_DROP, FILM_NOISE) = range(8, 11)
(MEAN_RATE, PEAK_RATE, CUBIC) = range(11, 14)
(GAP, GAP_AT, GAP_SHARE, STOP_AT, STOP_STIFFNESS) = range(14, 19)
(ABSORBER_J, ABSORBER_K, ABSORBER_C) = range(19, 22)
(SHAFT_K, SHAFT_J, SHAFT_C, SHAFT_GAP, SHAFT_CUBIC, SHAFT_DRY) = range(22, 28)
N_SCALARS = 28

# Grids of the tables
LARGEST_SLIDING = 60.0
LOWEST_AGE, AGE_DECADES = 1e-6, 6.0
LARGEST_FILM_ANGLE, LARGEST_HEAT, LARGEST_AMPLITUDE = 20.0, 200.0, 0.05
POINTS = 513

LEAST_TORQUE = 1e-9
"""[Nm]; ratios are of something, even where nothing sticks."""

# Columns of the result
TORQUE, CLAMP_ACCELERATION, X1, V1, X2, V2, FRICTION, SURFACE_SPEED, SURFACE_ANGLE = range(9)
N_COLUMNS = 9


@njit(**PART)
def _look_up(table, position):
    """Straight line in a table over [0, 1]."""
    scaled = position * (table.size - 1)
    if scaled <= 0.0:
        return table[0]
    if scaled >= table.size - 1:
        return table[table.size - 1]
    i = int(scaled)
    return table[i] + (scaled - i) * (table[i + 1] - table[i])


@njit(**PART)
def _elastomer(x, v, k_now, p, z, branches, friction, softening, m):
    """Torque of the elastomer at twist x and its rate v; m: slow mean, peak, previous twist."""
    k = p[K_E] * k_now
    away = x - m[0]
    size = max(abs(away), m[1]) if p[PEAK_RATE] > 0.0 else abs(away)
    torque = k * (m[0] + away * _look_up(softening, size / LARGEST_AMPLITUDE))
    torque += p[C_E] * v + p[CUBIC] * k * away * away * away
    for i in range(branches.shape[0]):
        torque += branches[i, 0] * (x - z[i])
    for j in range(friction.shape[0]):
        force = friction[j, 0] * (x - z[branches.shape[0] + j])
        torque += min(max(force, -friction[j, 1]), friction[j, 1])
    return torque


@njit(**PART)
def _support(x, v, p):
    """Torque of the beams on the clamp."""
    torque = p[K_B] * x + p[C_B] * v
    if p[GAP] > 0.0:
        inside = min(max(x - p[GAP_AT], -p[GAP]), p[GAP])
        torque -= p[GAP_SHARE] * p[K_B] * inside
    if p[STOP_STIFFNESS] > 0.0 and x > p[STOP_AT]:
        deep = x - p[STOP_AT]
        torque += p[STOP_STIFFNESS] * deep * math.sqrt(deep) * (1.0 + 0.02 * max(v, -20.0))
    return torque


@njit(**PART)
def _shaft_torque(lag, rate, p):
    """Torque by which a compliant shaft drives its end, which lags by `lag`."""
    free = lag - min(max(lag, -p[SHAFT_GAP]), p[SHAFT_GAP])
    dry = p[SHAFT_DRY] * rate / (abs(rate) + 0.05)
    spring = p[SHAFT_K] * free
    return spring / math.sqrt(1.0 + p[SHAFT_CUBIC] * spring * spring) + p[SHAFT_C] * rate + dry


@njit(**PART)
def _step(y, h, way, t_kin, ratio_base, drive, k_now, p, z, tables, m, creeping, drop):
    """Advance the state by `h`; return the friction torque, the elastomer's, and the sliding.

    y: x1, v1, a1, x2, v2, a2, end of the shaft x, v, a, absorber x, v, a. drive: shaft's angle,
    speed, acceleration at the end of the step. way: of the sliding, 0 in stick. creeping: law,
    numbers and state of a contact that never sticks truly; drop: what it may bear beyond t_kin.
    """
    weakening, creep, branches, friction, softening = tables
    fixed = p[K_B] < 0.0
    compliant = p[SHAFT_K] > 0.0
    v2 = y[4] + h * y[5]
    half2 = y[4] + 0.5 * h * y[5]
    x2 = 0.0 if fixed else y[3] + h * half2
    half3 = y[10] + 0.5 * h * y[11]
    x3 = y[9] + h * half3
    if compliant:
        half_s = y[7] + 0.5 * h * y[8]
        xs, vs, a_s = y[6] + h * half_s, y[7] + h * y[8], y[8]
    else:
        half_s = 0.0
        xs, vs, a_s = drive[0], drive[1], drive[2]
    slow = 1.0
    if way == 0.0:
        if vs > 0.0:
            slow = 1.0 - _look_up(creep, ratio_base)
        v1 = vs * slow
        x1 = y[0] + 0.5 * h * (y[1] + v1)
        half1 = v1
        a1 = a_s
    else:
        half1 = y[1] + 0.5 * h * y[2]
        x1 = y[0] + h * half1
        v1 = y[1] + h * y[2]
        a1 = 0.0
    if fixed:
        v2, half2 = 0.0, 0.0
    torque = _elastomer(x1 - x2, v1 - v2, k_now, p, z, branches, friction, softening, m)
    drag = 0.0
    if way == 0.0:
        if compliant:
            pull = _shaft_torque(drive[0] - xs, drive[1] - vs, p)
            a_s = (pull - torque) / (p[SHAFT_J] + p[J_E])
            vs = half_s + 0.5 * h * a_s
            v1, a1 = vs * slow, a_s
        drag = torque + p[J_E] * a1
    else:
        sliding = abs(vs - v1)
        drag = way * t_kin * _look_up(weakening, sliding / LARGEST_SLIDING)
        law, c, b = creeping
        if law != TRUE_STICK:
            drag = drag_of(law, c, t_kin, drag, drop, vs - v1, h, b)
        a1 = (drag - torque) / p[J_E]
        v1 = half1 + 0.5 * h * a1
        if compliant:
            pull = _shaft_torque(drive[0] - xs, drive[1] - vs, p)
            a_s = (pull - drag) / p[SHAFT_J]
            vs = half_s + 0.5 * h * a_s
    if not fixed:
        back = 0.0
        if p[ABSORBER_J] > 0.0:
            v3 = y[10] + h * y[11]
            back = p[ABSORBER_K] * (x2 - x3) + p[ABSORBER_C] * (v2 - v3)
            y[11] = back / p[ABSORBER_J]
            y[9], y[10] = x3, half3 + 0.5 * h * y[11]
        y[5] = (torque - back - _support(x2, v2, p)) / p[J_C]
        y[3], y[4] = x2, half2 + 0.5 * h * y[5]
    y[0], y[1], y[2] = x1, v1, a1
    y[6], y[7], y[8] = xs, vs, a_s
    return drag, torque, vs - v1


@njit(**PART)
def _slow_states(h, x, z, branches, friction, m, p):
    """Dashpots, dry-friction elements, slow mean and held peak of the elastomer."""
    for i in range(branches.shape[0]):
        gap = x - z[i]
        rate = h / branches[i, 1]
        if branches[i, 2] > 0.0:
            rate *= abs(gap) * branches[i, 0] / branches[i, 2]
        z[i] += gap * min(rate / (1.0 + 0.5 * rate), 1.0)
    for j in range(friction.shape[0]):
        i = branches.shape[0] + j
        limit = friction[j, 1] / friction[j, 0]
        z[i] += max(x - z[i] - limit, 0.0) + min(x - z[i] + limit, 0.0)
    m[0] += h * p[MEAN_RATE] * (x - m[0])
    m[1] = max(abs(x - m[0]), m[1] * (1.0 - h * p[PEAK_RATE]))


@njit(**PART)
def _age(t):
    return math.log10(max(t, LOWEST_AGE) / LOWEST_AGE) / AGE_DECADES


@njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)
def integrate(
    steps, h, p, start, omega, torque_gain, film_noise, stiffness_gain,
    weakening, ageing, scatter, creep, angle_gain, film, heat, softening_by_heat,
    branches, friction, softening, law, contact, result, slips,
):  # fmt: skip
    """Integrate result.shape[0] samples of `steps` steps of `h` each; return the number of slips.

    omega and the three modulations: at the samples and one beyond. slips: rows of time and drop.
    heat: rows of resistance and time constant. A contact that creeps slips where it slides at twice
    the shaft's speed, and rests where it is slower than the shaft. Filled in place: result, slips.
    """
    n = result.shape[0]
    y, old, drive = start.copy(), start.copy(), np.zeros(3)
    z = np.zeros(branches.shape[0] + friction.shape[0])
    m = np.zeros(2)
    q = np.zeros(heat.shape[0])
    tables = (weakening, creep, branches, friction, softening)
    way, stick_time, slid, drag, torque = np.sign(y[7] - y[1]), 0.0, 0.0, 0.0, 0.0
    angle, sticks, n_slips = y[6], 0, 0
    creeping, loose = (law, contact, np.array(START)), False
    if law != TRUE_STICK:
        way = 1.0
    before = 0.0  # the holding torque, or the sliding speed, a step ago
    for i in range(n):
        slope = (omega[i + 1] - omega[i]) / (steps * h)
        result[i, 0] = torque
        result[i, 1] = y[5]
        result[i, 2], result[i, 3], result[i, 4], result[i, 5] = y[0], y[1], y[3], y[4]
        result[i, 6], result[i, 7], result[i, 8] = drag, y[7], y[6]
        chi = _look_up(film, slid / LARGEST_FILM_ANGLE)
        warm = 0.0
        for b in range(q.size):
            warm += q[b]
        level = torque_gain[i] * _look_up(softening_by_heat, warm / LARGEST_HEAT)
        level *= _look_up(angle_gain, (angle / (2.0 * math.pi)) % 1.0)
        level *= (1.0 + p[FILM_GAIN] * chi) * (1.0 + p[FILM_NOISE] * chi * film_noise[i])
        t_kin = p[T_KIN] * level
        drop = (p[T_CRIT] - p[T_KIN]) * level * (1.0 - p[FILM_DROP] * chi)
        k_now = stiffness_gain[i]
        for j in range(steps):
            speed = omega[i] + slope * h * j
            old[:] = y
            left = h
            drive[0] = angle + left * (speed + 0.5 * slope * left)
            drive[1], drive[2] = speed + slope * left, slope
            rested = stick_time if law == TRUE_STICK else creeping[2][REST]
            crit = t_kin + drop * scatter[sticks % scatter.size] * _look_up(ageing, _age(rested))
            crit = max(crit, LEAST_TORQUE)
            ratio = min(max(torque / crit, 0.0), 1.0)
            drag, torque, sliding = _step(
                y, left, way, t_kin, ratio, drive, k_now, p, z, tables, m, creeping, crit - t_kin
            )
            now = drag if way == 0.0 else way * sliding
            allowed = 0.0
            if way != 0.0 and drive[1] > 0.0:
                allowed = way * y[7] * _look_up(creep, min(max(torque / crit, 0.0), 1.0))
                now -= allowed
            breaks = way == 0.0 and abs(now) > crit
            stops = way != 0.0 and now < 0.0 and law == TRUE_STICK
            if law != TRUE_STICK and not loose and sliding > 2.0 * y[7]:
                loose = True
                if n_slips < slips.shape[0]:
                    slips[n_slips, 0] = (i * steps + j + 1) * h
                    slips[n_slips, 1] = max(drag - t_kin, 0.0)
                    n_slips += 1
            elif loose and sliding < y[7]:
                loose = False
                sticks += 1
            if breaks or stops:
                if breaks:
                    span = abs(now) - abs(before)
                    part = (crit - abs(before)) / span if span > 0.0 else 0.0
                else:
                    part = before / (before - now) if before > 0.0 else 0.0
                part = min(max(part, 0.0), 1.0)
                y[:] = old
                drive[0] = angle + part * h * (speed + 0.5 * slope * part * h)
                drive[1] = speed + slope * part * h
                drag, torque, sliding = _step(
                    y, part * h, way, t_kin, ratio, drive, k_now, p, z, tables, m, creeping,
                    crit - t_kin,
                )  # fmt: skip
                left = (1.0 - part) * h
                if breaks:
                    way = 1.0 if now > 0.0 else -1.0
                    if n_slips < slips.shape[0]:
                        slips[n_slips, 0] = (i * steps + j + part) * h
                        slips[n_slips, 1] = abs(drag) - t_kin
                        n_slips += 1
                    sticks += 1
                    y[2] = (way * t_kin - torque) / p[J_E]
                    if p[SHAFT_K] > 0.0:
                        pull = _shaft_torque(drive[0] - y[6], drive[1] - y[7], p)
                        y[8] = (pull - way * t_kin) / p[SHAFT_J]
                else:
                    hold = torque + p[J_E] * y[8]
                    crit = max(
                        t_kin + drop * scatter[sticks % scatter.size] * ageing[0], LEAST_TORQUE
                    )
                    y[1] = y[1] + sliding - way * allowed
                    way = 0.0
                    stick_time = 0.0
                    if abs(hold) > crit:
                        way = 1.0 if hold > 0.0 else -1.0
                        y[2] = (way * t_kin - torque) / p[J_E]
                drive[0] = angle + h * (speed + 0.5 * slope * h)
                drive[1] = speed + slope * h
                drag, torque, sliding = _step(
                    y, left, way, t_kin, ratio, drive, k_now, p, z, tables, m, creeping,
                    crit - t_kin,
                )  # fmt: skip
                now = drag if way == 0.0 else way * sliding
                if way != 0.0 and drive[1] > 0.0:
                    now -= way * y[7] * _look_up(creep, min(max(torque / crit, 0.0), 1.0))
            before = now
            if way == 0.0:
                stick_time += h
            slid += abs(sliding) * h
            for b in range(q.size):
                q[b] += h / heat[b, 1] * (heat[b, 0] * abs(drag * sliding) - q[b])
            _slow_states(h, y[0] - y[3], z, branches, friction, m, p)
            angle += h * (speed + 0.5 * slope * h)
    return n_slips
