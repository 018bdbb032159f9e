"""Unknown effects of contact, elastomer, drive and joints."""

from __future__ import annotations

import math

import numpy as np

from noise.training.causes.cases.variants import hooks
from noise.training.causes.cases.variants.contact import on_contact


def _table_hook(*numbers):
    return on_contact(hooks.table_hook, *numbers, n_states=2)


def _drawn_table(scale, table):
    """Change torques over time by what is drawn for each run."""

    def pack(_form, _values, rng):
        values = np.clip(table(rng), -0.6, 1.0)
        return np.concatenate([[hooks.TORQUES, hooks.OVER_TIME, scale, values.size], values])

    return {"contact": hooks.table_hook, "pack": pack, "n_states": 2}


def _over(over, what, scale, values):
    return _table_hook([what, over, scale, values.size], values)


def _noise(rng, n, rate, low, high):
    """Draw noise of a band, of unit variance."""
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    spectrum = np.zeros(frequency.size, dtype=complex)
    count = int(inside.sum())
    spectrum[inside] = rng.standard_normal(count) + 1j * rng.standard_normal(count)
    return normed(np.fft.irfft(spectrum, n))


def normed(x):
    """Take away the mean of a signal, and divide it by its standard deviation."""
    return (x - x.mean()) / (float(x.std()) + 1e-30)


def cogging(a, bumps, phase, power):
    """Press harder at poles or teeth."""
    turn = np.arange(4096) / 4096
    press = np.cos(2 * np.pi * (bumps * turn + phase)) ** power + 0.4 * np.cos(2 * np.pi * turn)
    return _over(hooks.OVER_ANGLE, hooks.TORQUES, 2 * np.pi, 0.35 * a * press)


def misaligned(a, phase, once, second_phase, what):
    """Press harder twice a turn."""
    turn = np.arange(2048) / 2048
    press = np.sin(2 * np.pi * (2 * turn + phase))
    press += 0.5 * once * np.sin(2 * np.pi * (turn + second_phase))
    return _over(hooks.OVER_ANGLE, what, 2 * np.pi, 0.5 * a * press)


def pumped_stiffness(a, frequency):
    """Let the stiffness swing by itself."""
    wave = 0.45 * a * np.sin(2 * np.pi * np.arange(256) / 256)
    return _over(hooks.OVER_TIME, hooks.STIFFNESSES, 1.0 / frequency, wave)


def shaken_load(a, frequency, third):
    """Press to and fro."""
    turn = 2 * np.pi * np.arange(256) / 256
    wave = 0.5 * a * (np.sin(turn) + third * np.sin(3 * turn))
    return _over(hooks.OVER_TIME, hooks.TORQUES, 1.0 / frequency, wave)


def debris(a, low, high, often, long):
    """Grind in bursts."""

    def table(rng):
        time = np.arange(40_000) / 20e3
        bursts = np.zeros(time.size)
        for _ in range(int(rng.poisson(often * 2)) + 1):
            since = (time - rng.uniform(0.0, 2.0)) / (long * rng.uniform(0.5, 1.5))
            bursts += np.where(since > 0.0, np.exp(-np.maximum(since, 0.0)), 0.0)
        return 0.2 * a * bursts * (1.0 + _noise(rng, time.size, 20e3, low, high))

    return _drawn_table(2.0, table)


def wandering_load(a, corner):
    """Press by more and less."""
    low, high = 0.5 * corner, 2.0 * corner + 1.0
    return _drawn_table(2.0, lambda rng: 0.3 * a * _noise(rng, 20_000, 10e3, low, high))


def self_energising(a, torque, sign):
    """Press harder, or less, the more torque there is."""
    return _table_hook(hooks.LOADED, 0.6 * a * sign, torque, 0.0)


def hardening_spring(a, torque, stiffness, power, twist):
    """Be the stiffer the further it is wound."""
    stiffer = 0.6 * a * stiffness / twist**power
    return _table_hook(hooks.SPRING, 0.0, torque / stiffness, power, stiffer)


def second_contact(a, torque, stiffness, late):
    """Meet a stop."""
    return _table_hook(hooks.SPRING, 0.0, torque / stiffness * late, 0.0, 20.0 * a * stiffness)


def rubbing_beside(a, torque, stiffness, early):
    """Rub a second time beside the elastomer."""
    return _table_hook(hooks.BESIDE, 0.4 * a * torque, torque / stiffness * early, 0.0)


def inner_resonance(a, stiffness, frequency, damping):
    """Swing within the rubber."""
    return _table_hook(hooks.ABSORBER, 1.2 * a * stiffness, 2 * np.pi * frequency, damping)


def backlash(a, torque, stiffness, inertia, damping, share):
    """Have play between shaft and drive."""
    stiff = 30.0 * stiffness
    inertia = max(inertia, stiff / (2 * math.pi * 4e3) ** 2)
    damping = 2.0 * damping * math.sqrt(stiff * inertia)
    play = a * torque / stiffness * share
    values = [inertia * (a > 0.0), stiff, 0, 0, 1, damping, 0, 1, 0, 1, play]
    return on_contact(hooks.compliance_hook, values, n_states=2)


def stalling_drive(a, often, duty):
    """Stall and catch up."""
    share = 0.9 * a

    def drive(speed, rate, _form, _values, rng):
        time = np.arange(speed.size) / rate
        stalled = (often * time + rng.random()) % 1.0 < duty
        return speed * np.where(stalled, 1.0 - share, 1.0 + share * duty / (1.0 - duty))

    return {"drive": drive}


def loose_bolt(a, duration, chance, strongest, seed):
    """Rattle in the joint."""

    def force(motion, _form, _values):
        turns = np.flatnonzero(np.diff(np.signbit(motion.clamp_speed)))
        own = np.random.default_rng([seed, turns.size])
        turns = turns[own.random(turns.size) < chance]
        struck = np.zeros_like(motion.torque)
        sizes = strongest * a * own.lognormal(0.0, 0.5, turns.size)
        np.add.at(struck, turns, sizes * own.choice([-1.0, 1.0], turns.size))
        n = max(2, round(duration * motion.rate))
        return np.convolve(struck, np.sin(np.pi * (np.arange(n) + 0.5) / n))[: struck.size]

    return {"force": force}
