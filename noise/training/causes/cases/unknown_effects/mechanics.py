"""Unknown effects of contact, elastomer, drive and joints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.cases.draws import log_uniform
from noise.training.causes.cases.unknown_effects.hooks import (
    ABSORBER,
    BESIDE,
    LOADED,
    OVER_ANGLE,
    OVER_TIME,
    SPRING,
    STIFFNESSES,
    TORQUES,
)
from noise.training.causes.cases.unknown_effects.parts import (
    Array,
    Recipe,
    Rng,
    noise,
    on_contact,
    table,
    unknown,
)
from noise.training.causes.cases.variants.hooks import compliance_hook
from sim.effects.effect import Effect, Stage

if TYPE_CHECKING:
    from sim.motion import Motion


def _cogging(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    turn = np.arange(4096) / 4096
    bumps = np.cos(2 * np.pi * (int(rng.integers(5, 40)) * turn + rng.random()))
    bumps = bumps ** int(rng.integers(1, 4)) + 0.4 * np.cos(2 * np.pi * turn)
    return on_contact(lambda _rng: table(TORQUES, OVER_ANGLE, 2 * np.pi, 0.35 * a * bumps))


def _misaligned(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Press harder twice a turn, and be stiffer there."""
    turn = np.arange(2048) / 2048
    press = np.sin(2 * np.pi * (2 * turn + rng.random()))
    press += 0.5 * float(rng.random()) * np.sin(2 * np.pi * (turn + rng.random()))
    what = float(rng.choice([TORQUES, STIFFNESSES]))
    return on_contact(lambda _rng: table(what, OVER_ANGLE, 2 * np.pi, 0.5 * a * press))


def _pumped(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    period = 1.0 / log_uniform(rng, 40.0, 700.0)
    wave = 0.45 * a * np.sin(2 * np.pi * np.arange(256) / 256)
    return on_contact(lambda _rng: table(STIFFNESSES, OVER_TIME, period, wave))


def _shaken(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Press to and fro by what else vibrates on the bench."""
    period, third = 1.0 / log_uniform(rng, 12.0, 400.0), float(rng.uniform(0.0, 0.5))
    turn = 2 * np.pi * np.arange(256) / 256
    wave = 0.5 * a * (np.sin(turn) + third * np.sin(3 * turn))
    return on_contact(lambda _rng: table(TORQUES, OVER_TIME, period, wave))


def _debris(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    low, high = float(rng.uniform(50.0, 300.0)), float(rng.uniform(1000.0, 4000.0))
    often, long = float(rng.uniform(5.0, 20.0)), float(rng.uniform(0.004, 0.05))

    def pack(rng: Rng) -> Array:
        time = np.arange(40_000) / 20e3
        bursts = np.zeros(time.size)
        for _ in range(int(rng.poisson(often * 2)) + 1):
            since = (time - rng.uniform(0.0, 2.0)) / (long * rng.uniform(0.5, 1.5))
            bursts += np.where(since > 0.0, np.exp(-np.maximum(since, 0.0)), 0.0)
        rough = 1.0 + noise(rng, time.size, 20e3, low, high)
        return table(TORQUES, OVER_TIME, 2.0, np.clip(0.2 * a * bursts * rough, -0.6, 1.0))

    return on_contact(pack)


def _load(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    corner = log_uniform(rng, 1.0, 15.0)

    def pack(rng: Rng) -> Array:
        wander = noise(rng, 20_000, 10e3, 0.5 * corner, 2.0 * corner + 1.0)
        return table(TORQUES, OVER_TIME, 2.0, np.clip(0.3 * a * wander, -0.6, 1.0))

    return on_contact(pack)


def _self_energising(a: float, torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Press harder, or less, the more torque there is: a wedge, a sprag."""
    share = 0.6 * a * float(rng.choice([-1.0, 1.0]))
    return on_contact(lambda _rng: np.array([LOADED, share, torque, 0.0]))


def _hardening(a: float, torque: float, stiffness: float, rng: Rng) -> Effect:
    power = float(rng.uniform(1.5, 2.5))
    wound = torque / stiffness
    more = 0.6 * a * stiffness / float(rng.uniform(0.002, 0.004)) ** power
    return on_contact(lambda _rng: np.array([SPRING, 0.0, wound, power, more]))


def _stop(a: float, torque: float, stiffness: float, rng: Rng) -> Effect:
    at = torque / stiffness * float(rng.uniform(1.0, 1.15))
    return on_contact(lambda _rng: np.array([SPRING, 0.0, at, 0.0, 20.0 * a * stiffness]))


def _rubbing_beside(a: float, torque: float, stiffness: float, rng: Rng) -> Effect:
    """Rub a second time beside the elastomer: another bushing, a flange that touches."""
    built = torque / stiffness * log_uniform(rng, 0.005, 0.1)
    dry = 0.4 * a * torque
    return on_contact(lambda _rng: np.array([BESIDE, dry, built, 0.0]))


def _inner_resonance(a: float, _torque: float, stiffness: float, rng: Rng) -> Effect:
    """Swing within the rubber: a metal sleeve in it, a mass that hangs on it."""
    turning, damping = 2 * np.pi * log_uniform(rng, 60.0, 1500.0), log_uniform(rng, 0.01, 0.2)
    return on_contact(lambda _rng: np.array([ABSORBER, 1.2 * a * stiffness, turning, damping]))


def _backlash(a: float, torque: float, stiffness: float, rng: Rng) -> Effect:
    """Have play between shaft and drive: teeth, a key, an arm on its pin."""
    stiff = 30.0 * stiffness
    inertia = max(log_uniform(rng, 3e-5, 2e-4), stiff / (2 * math.pi * 4e3) ** 2)
    damping = 2.0 * log_uniform(rng, 0.03, 0.2) * math.sqrt(stiff * inertia)
    play = a * torque / stiffness * float(rng.uniform(0.3, 1.0))
    values = np.array([inertia * (a > 0.0), stiff, 0, 0, 1, damping, 0, 1, 0, 1, play])
    return unknown(
        Stage.FRICTION, contact=compliance_hook, pack=lambda _form, _values, _rng: values,
        n_states=2,
    )  # fmt: skip


def _stall(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    often, duty = float(rng.uniform(4.0, 18.0)), float(rng.uniform(0.2, 0.5))
    share = 0.9 * a

    def drive(
        speed: Array, rate: float, _form: str, _values: Mapping[str, float], rng: Rng
    ) -> Array:
        time = np.arange(speed.size) / rate
        stalled = (often * time + rng.random()) % 1.0 < duty
        return speed * np.where(stalled, 1.0 - share, 1.0 + share * duty / (1.0 - duty))

    return unknown(Stage.DRIVE, drive=drive)


def _loose_bolt(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Rattle in the joint as often as the clamp swings, not as the contact slips."""
    duration, chance = log_uniform(rng, 2e-5, 3e-4), float(rng.uniform(0.3, 1.0))
    strongest, seed = log_uniform(rng, 60.0, 500.0), int(rng.integers(2**31))

    def force(motion: Motion, _form: str, _values: Mapping[str, float]) -> Array:
        turns = np.flatnonzero(np.diff(np.signbit(motion.clamp_speed)))
        own = np.random.default_rng([seed, turns.size])
        turns = turns[own.random(turns.size) < chance]
        struck = np.zeros_like(motion.torque)
        sizes = strongest * a * own.lognormal(0.0, 0.5, turns.size)
        np.add.at(struck, turns, sizes * own.choice([-1.0, 1.0], turns.size))
        n = max(2, round(duration * motion.rate))
        return np.convolve(struck, np.sin(np.pi * (np.arange(n) + 0.5) / n))[: struck.size]

    return unknown(Stage.STRUCTURE, force=force)


MECHANICS: Mapping[str, Recipe] = {
    "cogging": _cogging,
    "misaligned": _misaligned,
    "pumped_stiffness": _pumped,
    "shaken_load": _shaken,
    "debris": _debris,
    "wandering_load": _load,
    "self_energising": _self_energising,
    "hardening_spring": _hardening,
    "second_contact": _stop,
    "rubbing_beside": _rubbing_beside,
    "inner_resonance": _inner_resonance,
    "backlash": _backlash,
    "stalling_drive": _stall,
    "loose_bolt": _loose_bolt,
}
"""Each takes strength, kinetic torque, stiffness and a generator."""
