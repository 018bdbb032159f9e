"""Effects in no library. An honest diagnosis calls them unknown."""

from __future__ import annotations

import numpy as np
from numba import njit

from .. import kernel
from .form import DEVELOPMENT, SEALED, form, noise_in_band


@njit(cache=True)
def _play(x, width):
    y, held = np.empty_like(x), x[0]
    for i in range(x.size):
        held = min(max(held, x[i] - width), x[i] + width)
        y[i] = held
    return y


_TURN = np.linspace(0.0, 1.0, kernel.POINTS)


@form("stranger_second_contact_rattles", "structure", DEVELOPMENT)
def hertzian_stop(s, a, case, run):
    s.p[kernel.STOP_AT] = s.static_twist * case.uniform(1.01, 1.05)
    s.p[kernel.STOP_STIFFNESS] = 4e5 * a * a


@form("stranger_cogging", "friction", DEVELOPMENT)
def poles_of_the_motor(s, a, case, run):
    poles, phase = int(case.integers(9, 30)), case.random()
    bump = np.cos(2 * np.pi * (poles * _TURN + phase)) ** 3 + 0.5 * np.cos(2 * np.pi * _TURN)
    s.angle_gain = 1.0 + 0.35 * a * bump


@form("stranger_parametric_stiffness", "friction", DEVELOPMENT)
def pumped_stiffness(s, a, case, run):
    f = case.uniform(60.0, 600.0)
    s.stiffness_gain = 1.0 + 0.45 * a * np.sin(2 * np.pi * (f * s.time + run.random()))


@form("stranger_crackling_contact", "measurement", DEVELOPMENT)
def loose_plug(s, a, case, run):
    name, often = str(case.choice(["torque", "acceleration", "pressure"])), case.uniform(10, 60)
    seed = int(run.integers(2**31))

    def change(signals, turned):
        rng, x = np.random.default_rng(seed), signals[name]
        open_ = np.cumsum(rng.random(x.size) < often / turned.rate) % 2 == 1
        held = x * (1.0 - a * open_) + 0.2 * a * open_ * x.std() * rng.standard_normal(x.size)
        signals[name] = held

    s.sensors.append(change)


@form("stranger_absorber", "structure", DEVELOPMENT)
def mass_hung_on_the_clamp(s, a, case, run):
    s.p[kernel.ABSORBER_J] = 0.35 * a * s.p[kernel.J_C]
    w = 2.0 * np.pi * case.uniform(120.0, 420.0)
    s.p[kernel.ABSORBER_K] = s.p[kernel.ABSORBER_J] * w * w
    s.p[kernel.ABSORBER_C] = 0.04 * s.p[kernel.ABSORBER_J] * w


@form("stranger_loose_anchor", "structure", SEALED)
def clearance(s, a, case, run):
    s.p[kernel.GAP] = s.static_twist * case.uniform(0.05, 0.15)
    s.p[kernel.GAP_AT] = s.static_twist * case.uniform(0.97, 1.05)
    s.p[kernel.GAP_SHARE] = 0.9 * a


@form("stranger_recorder_wow", "measurement", SEALED)
def wow_and_flutter(s, a, case, run):
    slow, fast = case.uniform(2.0, 6.0), case.uniform(12.0, 60.0)
    phases = run.random(2)

    def change(signals, turned):
        for name in signals:
            t = np.arange(signals[name].size) / turned.rate
            late = 3e-3 * np.sin(2 * np.pi * (slow * t + phases[0]))
            late += 4e-4 * np.sin(2 * np.pi * (fast * t + phases[1]))
            signals[name] = np.interp(t - a * late, t, signals[name])

    s.sensors.append(change)


@form("stranger_drive_dead_zone", "drive", SEALED)
def gear_play(s, a, case, run):
    s.p[kernel.SHAFT_K] = min(6000.0 / a, 4e5)
    s.p[kernel.SHAFT_J] = 5e-5
    s.p[kernel.SHAFT_C] = 0.03
    s.p[kernel.SHAFT_GAP] = 0.02 * a
    share, often = 0.9 * a, case.uniform(5.0, 15.0)
    stalled = ((often * s.time + run.random()) % 1.0) < 0.3
    s.omega *= np.where(stalled, 1.0 - share, 1.0 + 3.0 / 7.0 * share)


@form("stranger_wear_debris", "friction", SEALED)
def grains(s, a, case, run):
    bursts = np.zeros(s.n + 1)
    for _ in range(run.poisson(12.0 * s.time[-1]) + 1):
        away = (s.time - run.uniform(0.0, s.time[-1])) / run.uniform(5e-3, 40e-3)
        bursts += np.where(away > 0.0, np.exp(-np.maximum(away, 0.0)), 0.0) * run.uniform(0.4, 1.0)
    rough = noise_in_band(run, s.n + 1, s.rate, 80.0, 3000.0, 1.0)
    s.torque_gain = np.clip(1.0 + 0.25 * a * bursts * (1.0 + rough), 0.4, 2.0)


@form("stranger_progressive_stiffness", "friction", SEALED)
def cubic_spring(s, a, case, run):
    s.p[kernel.MEAN_RATE] = 20.0
    s.p[kernel.CUBIC] = 0.6 * a / case.uniform(2e-3, 4e-3) ** 2


@form("stranger_crosstalk", "measurement", SEALED)
def shared_ground(s, a, case, run):
    sign = float(case.choice([-1.0, 1.0]))

    def change(signals, turned):
        leaks = signals["acceleration"] - signals["acceleration"].mean()
        signals["torque"] = signals["torque"] + 0.015 * a * sign * leaks
        signals["pressure"] = signals["pressure"] + 0.01 * a * leaks

    s.sensors.append(change)


@form("stranger_missing_codes", "measurement", SEALED)
def stuck_bit(s, a, case, run):
    def change(signals, turned):
        for name in ("torque", "acceleration", "pressure"):
            x = signals[name]
            step = 0.8 * a * x.std()
            stuck = (np.floor(x / step) % 2.0) == 1.0
            signals[name] = np.where(stuck, np.floor(x / step) * step, x)

    s.sensors.append(change)


@form("stranger_passing_shocks", "measurement", SEALED)
def trolley(s, a, case, run):
    seed = int(run.integers(2**31))
    f = case.uniform(30.0, 250.0, 4)

    def change(signals, turned):
        rng = np.random.default_rng(seed)
        t = np.arange(signals["torque"].size) / turned.rate
        for at in rng.uniform(0.0, t[-1], 4):
            away = np.maximum(t - at, 0.0)
            shock = sum(np.sin(2 * np.pi * x * away) for x in f) * np.exp(-away / 0.03)
            for name, level in (("torque", 0.5), ("acceleration", 15.0), ("pressure", 0.6)):
                signals[name] = signals[name] + a * level * shock

    s.sensors.append(change)


@form("stranger_torque_hysteresis", "measurement", SEALED)
def play_in_the_cell(s, a, case, run):
    def change(signals, turned):
        x = signals["torque"]
        signals["torque"] = 0.3 * x + 0.7 * _play(x, 1.2 * a * x.std())

    s.sensors.append(change)
