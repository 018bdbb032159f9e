"""Further forms of what acts on the contact: friction, film, heat, elastomer, and the shaft."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import lfilter

from noise.diagnosis.cases.draws import curve, exponential, far_curve, noise
from noise.training.causes.cases.variants import hooks
from sim.effects import EFFECTS

_SOFTEST = 0.78
"""Share of the stiffness lost at strength 1, so that the torque still rises with the twist."""

_N_DRAWS = 4096


def on_contact(hook, *numbers, n_states=1):
    """Act by a compiled function that reads these numbers."""
    packed = np.concatenate([np.atleast_1d(part) for part in numbers]).astype(np.float64)
    return {"contact": hook, "pack": lambda _form, _values, _rng: packed, "n_states": n_states}


def weakens(a, shape, speed, lag=0.0):
    """Let the torque fall with the sliding speed."""
    return on_contact(hooks.rate_dependence_hook, [-0.85 * a, speed, lag], shape)


def strengthens(a, shape, speed, lag=0.0, height=1.0):
    """Let the torque rise with the sliding speed."""
    gain = 1.5 * height  # of strength 1, whatever the strength: forms stay what they are
    u = np.linspace(0.0, 1.0, shape.size - 1)
    slope = float(np.max(np.gradient(shape[1:], u) * (1.0 - u) ** 2))
    # The solver follows a rise of up to 0.5 s/rad over the kinetic torque.
    speed = max(speed, gain * slope / 0.5)
    return on_contact(hooks.rate_dependence_hook, [a * gain, speed, lag], shape)


def ages(
    a, shape, time, level=1.0, *, whole=False, renewal=0.0, kinetic=0.0, gain=0.0, drop_gain=1.0
):
    """Let the contact grow stronger in stick."""
    gain = gain or (0.97 if level == 1.0 else 1.0 if whole else drop_gain)
    header = [gain * a, time, renewal or 4e-4, level, whole, renewal > 0.0, kinetic]
    return on_contact(hooks.ageing_hook, header, shape)


def creeps(a, shape, lag=0.0, speed=0.0, fading=0.0, lost=0.0, most=0.95):
    """Let the contact creep before it slips; what has slipped may carry less."""
    return on_contact(hooks.creep_hook, [most * a, lag, speed, fading, a * lost], shape)


def yields(a, power, softer):
    """Put a contact that is the softer the nearer it is to slip in series with the elastomer."""
    compliance = 3.0 * a**1.5 * softer  # unloaded, over the elastomer's
    shape = curve(lambda r: compliance / (compliance + (1.0 - r) ** power + 1e-9))
    return creeps(float(a > 0.0), shape)


def films(a, shape, torque, drop, roughness, scale, low, widths, patches=0.0, *, fixed=False):
    """Let a film change torque, drop and roughness as it grows, or where it lies."""
    high = low * widths
    points = 12.0 * high
    per = points / 3.0 if fixed else points
    header = [a, torque, drop, roughness, patches > 0.0, patches or scale, fixed, per]

    def numbers(_form, _values, rng):
        time_series = noise(rng, 2**14, points, low, high)
        return np.concatenate([np.array(header, float), shape, [2**14], time_series])

    return {"contact": hooks.film_hook, "pack": numbers, "n_states": 1}


def heats(
    a, resistance, times=(), parts=1.0, power=0.0, rise=0.0, shape=None, softening=0.04, passes=0,
    kinetic=1.0, critical=1.0, stiffness=0.0, **_drawn
):  # fmt: skip
    """Lose torque over heat; by default so much a kelvin, down to a tenth."""
    rates = passes / np.full(passes, times) if passes else 1.0 / np.atleast_1d(times)
    weights = resistance * parts * rates
    if np.size(times) == 0:  # a kernel that falls by a power
        rates = 1000.0 * 5.0 ** -np.arange(6, dtype=np.float64)
        steps = rates**-power
        weights = resistance * steps / steps.sum() * rates
    lost = 0.75 * a
    if shape is None:
        shape, lost, rise = far_curve(exponential), 0.9, 0.9 / max(softening * a, 1e-12)
    header = [lost, rise, passes > 0, rates.size, kinetic, critical, stiffness]
    return on_contact(hooks.heating_hook, header, weights, rates, shape, n_states=rates.size)


def softens(a, shape, twist, mean, held=0.0, *, whole=False):
    """Lose stiffness over the departure of the twist from its mean."""
    del whole  # what twist and mean were drawn by
    return on_contact(hooks.softening_hook, [_SOFTEST * a, twist, mean, held], shape, n_states=2)


def bristles(a, n, twists):
    """Let small parts of the network slip."""
    return on_contact(hooks.bristle_hook, [_SOFTEST * a, n], twists, n_states=n)


def branches(a, times, replaced, shares=None, kind=2.0, twist=1.0, exponent=0.0, *, lost, **_drawn):
    """Put Maxwell branches beside the spring, or let them take the place of a part of it."""
    if shares is None:
        shares = times**-exponent
    rates = 1.0 / np.maximum(times, 2e-5)
    most = 0.85 if lost else 0.9 if kind < 2.0 else 3.0
    parts = most * a * shares / shares.sum()
    header = [times.size, kind, twist, most * a * replaced]
    return on_contact(hooks.dashpot_hook, header, parts, rates, n_states=times.size)


def yielding_shaft(
    a,
    lag,
    built,
    inertia,
    damping_ratio,
    branch_time,
    softening=0.0,
    cubic=0.0,
    dry_torque=0.0,
    branch=0.0,
):
    """Let the shaft yield: rigid at strength 0."""
    if a == 0.0:
        return on_contact(hooks.compliance_hook, np.zeros(11), n_states=2)
    stiffness = 400.0 / a  # at strength 1 less than the elastomer's
    dry_lag = dry_torque / stiffness / built or 1.0
    stiffest = stiffness * (1.0 + branch + 0.7 * (dry_torque > 0.0) + 3.0 * cubic)
    inertia = max(inertia, stiffest / (2.0 * math.pi * 4e3) ** 2)
    damping = 2.0 * damping_ratio * math.sqrt(stiffness * inertia)
    numbers = [
        inertia, stiffness, softening, cubic, lag / stiffness, damping, dry_torque, dry_lag, branch,
        1.0 / branch_time, 0.0,
    ]  # fmt: skip
    return on_contact(hooks.compliance_hook, numbers, n_states=2)


def scatters(a, form, most=0.8, **numbers):
    """Let critical torques differ from stick to stick, by so much of the drop at strength 1."""
    plain = EFFECTS["critical_torque_scatter"]

    def pack(_form, _values, rng):
        z = _SEQUENCES[form](rng, **numbers)
        return np.concatenate([[5e-3], most * a * (z - z.mean()) / (z.std() + 1e-9)])

    return {"contact": plain.contact, "pack": pack, "n_states": plain.n_states}


def _long_memory(rng, power):
    size = np.maximum(np.arange(_N_DRAWS // 2 + 1), 8.0) ** -power
    return np.fft.irfft(size * np.exp(2j * np.pi * rng.random(size.size)), _N_DRAWS)


def _two_states(rng, chances):
    down, up = chances
    chance, state, states = rng.random(_N_DRAWS), 0, np.zeros(_N_DRAWS)
    for i in range(_N_DRAWS):
        if chance[i] < (down if state else up):
            state = 1 - state
        states[i] = state
    return states + 0.1 * rng.standard_normal(_N_DRAWS)


def _remembering(z, memory):
    return lfilter([1.0], [1.0, -memory], z)


_SEQUENCES = {
    "heavy_tails": lambda r, freedom: np.clip(r.standard_t(freedom, _N_DRAWS), -12.0, 12.0),
    "long_memory": _long_memory,
    "two_states": _two_states,
    "skewed": lambda r, sign, memory: _remembering(sign * r.standard_exponential(_N_DRAWS), memory),
    "alternating": lambda r, memory: _remembering(r.standard_normal(_N_DRAWS), -memory),
    "lognormal": lambda r, wide: r.lognormal(0.0, wide, _N_DRAWS),
    "weakest_link": lambda r, modulus: r.weibull(modulus, _N_DRAWS),
    "early_breaks": lambda r, often: np.where(r.random(_N_DRAWS) < often, -1.0, 0.0),
    "levels": lambda r, n, levels: r.choice(levels[:n], _N_DRAWS),
    "whole_torque": lambda r: r.standard_normal(_N_DRAWS),
    "drifting": lambda r, forgotten: _remembering(r.standard_normal(_N_DRAWS), 1.0 - forgotten),
}
"""Drops of the torque from stick to stick: bonds' strengths (lognormal), the weakest of many links
(Weibull 1951), few that break early, the whole critical torque, never below the kinetic one."""


def scatters_along(a, finest, *, over_time):
    """Let the drop depend on the place along the shaft, or wander over time."""

    def pack(_form, _values, rng):
        time_series = noise(rng, _N_DRAWS, 8.0 * finest, 0.05 * finest, finest)
        header = [8.0 * finest, over_time, _N_DRAWS]
        return np.concatenate([header, 1.0 + 0.8 * a * time_series])

    return {"contact": hooks.patch_hook, "pack": pack, "n_states": 0}
