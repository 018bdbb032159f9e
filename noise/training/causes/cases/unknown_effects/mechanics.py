"""Unknown effects of contact, elastomer, drive and joints."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from noise.diagnosis.cases.draws import Array, Rng
from noise.training.causes.cases.unknown_effects.hooks import (
    ABSORBER,
    BESIDE,
    LOADED,
    OVER_ANGLE,
    OVER_TIME,
    SPRING,
    STIFFNESSES,
    TORQUES,
    table_hook,
)
from noise.training.causes.cases.variants.hooks import compliance_hook

if TYPE_CHECKING:
    from sim.motion import Motion


def _on_contact(pack: Callable[[Rng], Array]) -> dict[str, Any]:
    """Act on the contact, by the numbers of its hook."""
    return {
        "contact": table_hook, "pack": lambda _form, _values, rng: pack(rng), "n_states": 2,
    }  # fmt: skip


def _fixed(*numbers: float) -> dict[str, Any]:
    return _on_contact(lambda _rng: np.array(numbers))


def _over(over: float, what: float, scale: float, values: Array) -> dict[str, Any]:
    return _on_contact(lambda _rng: _table(what, over, scale, values))


def _table(what: float, over: float, scale: float, values: Array) -> Array:
    """Pack a table as the hook reads it."""
    return np.concatenate([[what, over, scale, values.size], values])


def _noise(rng: Rng, n: int, rate: float, low: float, high: float) -> Array:
    """Draw noise of a band, of unit variance."""
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    spectrum = np.zeros(frequency.size, dtype=complex)
    count = int(inside.sum())
    spectrum[inside] = rng.standard_normal(count) + 1j * rng.standard_normal(count)
    return normed(np.fft.irfft(spectrum, n))


def normed(x: Array) -> Array:
    """Take away the mean of a signal, and divide it by its standard deviation."""
    return np.asarray((x - x.mean()) / (float(x.std()) + 1e-30))


def cogging(a: float, bumps: int, phase: float, power: int) -> dict[str, Any]:
    """Press harder at poles or teeth."""
    turn = np.arange(4096) / 4096
    press = np.cos(2 * np.pi * (bumps * turn + phase)) ** power + 0.4 * np.cos(2 * np.pi * turn)
    return _over(OVER_ANGLE, TORQUES, 2 * np.pi, 0.35 * a * press)


def misaligned(
    a: float, phase: float, once: float, second_phase: float, what: float
) -> dict[str, Any]:
    """Press harder twice a turn."""
    turn = np.arange(2048) / 2048
    press = np.sin(2 * np.pi * (2 * turn + phase))
    press += 0.5 * once * np.sin(2 * np.pi * (turn + second_phase))
    return _over(OVER_ANGLE, what, 2 * np.pi, 0.5 * a * press)


def pumped_stiffness(a: float, frequency: float) -> dict[str, Any]:
    """Let the stiffness swing by itself."""
    wave = 0.45 * a * np.sin(2 * np.pi * np.arange(256) / 256)
    return _over(OVER_TIME, STIFFNESSES, 1.0 / frequency, wave)


def shaken_load(a: float, frequency: float, third: float) -> dict[str, Any]:
    """Press to and fro."""
    turn = 2 * np.pi * np.arange(256) / 256
    wave = 0.5 * a * (np.sin(turn) + third * np.sin(3 * turn))
    return _over(OVER_TIME, TORQUES, 1.0 / frequency, wave)


def debris(a: float, low: float, high: float, often: float, long: float) -> dict[str, Any]:
    """Grind in bursts."""

    def pack(rng: Rng) -> Array:
        time = np.arange(40_000) / 20e3
        bursts = np.zeros(time.size)
        for _ in range(int(rng.poisson(often * 2)) + 1):
            since = (time - rng.uniform(0.0, 2.0)) / (long * rng.uniform(0.5, 1.5))
            bursts += np.where(since > 0.0, np.exp(-np.maximum(since, 0.0)), 0.0)
        rough = 1.0 + _noise(rng, time.size, 20e3, low, high)
        return _table(TORQUES, OVER_TIME, 2.0, np.clip(0.2 * a * bursts * rough, -0.6, 1.0))

    return _on_contact(pack)


def wandering_load(a: float, corner: float) -> dict[str, Any]:
    """Press by more and less."""

    def pack(rng: Rng) -> Array:
        wander = _noise(rng, 20_000, 10e3, 0.5 * corner, 2.0 * corner + 1.0)
        return _table(TORQUES, OVER_TIME, 2.0, np.clip(0.3 * a * wander, -0.6, 1.0))

    return _on_contact(pack)


def self_energising(a: float, torque: float, sign: float) -> dict[str, Any]:
    """Press harder, or less, the more torque there is."""
    return _fixed(LOADED, 0.6 * a * sign, torque, 0.0)


def hardening_spring(
    a: float, torque: float, stiffness: float, power: float, twist: float
) -> dict[str, Any]:
    """Be the stiffer the further it is wound."""
    return _fixed(SPRING, 0.0, torque / stiffness, power, 0.6 * a * stiffness / twist**power)


def second_contact(a: float, torque: float, stiffness: float, late: float) -> dict[str, Any]:
    """Meet a stop."""
    return _fixed(SPRING, 0.0, torque / stiffness * late, 0.0, 20.0 * a * stiffness)


def rubbing_beside(a: float, torque: float, stiffness: float, early: float) -> dict[str, Any]:
    """Rub a second time beside the elastomer."""
    return _fixed(BESIDE, 0.4 * a * torque, torque / stiffness * early, 0.0)


def inner_resonance(a: float, stiffness: float, frequency: float, damping: float) -> dict[str, Any]:
    """Swing within the rubber."""
    return _fixed(ABSORBER, 1.2 * a * stiffness, 2 * np.pi * frequency, damping)


def backlash(
    a: float, torque: float, stiffness: float, inertia: float, damping: float, share: float
) -> dict[str, Any]:
    """Have play between shaft and drive."""
    stiff = 30.0 * stiffness
    inertia = max(inertia, stiff / (2 * math.pi * 4e3) ** 2)
    damping = 2.0 * damping * math.sqrt(stiff * inertia)
    play = a * torque / stiffness * share
    values = np.array([inertia * (a > 0.0), stiff, 0, 0, 1, damping, 0, 1, 0, 1, play])
    return {
        "contact": compliance_hook, "pack": lambda _form, _values, _rng: values, "n_states": 2,
    }  # fmt: skip


def stalling_drive(a: float, often: float, duty: float) -> dict[str, Any]:
    """Stall and catch up."""
    share = 0.9 * a

    def drive(speed: Array, rate: float, _form: str, _values: Any, rng: Rng) -> Array:
        time = np.arange(speed.size) / rate
        stalled = (often * time + rng.random()) % 1.0 < duty
        return speed * np.where(stalled, 1.0 - share, 1.0 + share * duty / (1.0 - duty))

    return {"drive": drive}


def loose_bolt(
    a: float, duration: float, chance: float, strongest: float, seed: int
) -> dict[str, Any]:
    """Rattle in the joint."""

    def force(motion: Motion, _form: str, _values: Any) -> Array:
        turns = np.flatnonzero(np.diff(np.signbit(motion.clamp_speed)))
        own = np.random.default_rng([seed, turns.size])
        turns = turns[own.random(turns.size) < chance]
        struck = np.zeros_like(motion.torque)
        sizes = strongest * a * own.lognormal(0.0, 0.5, turns.size)
        np.add.at(struck, turns, sizes * own.choice([-1.0, 1.0], turns.size))
        n = max(2, round(duration * motion.rate))
        return np.convolve(struck, np.sin(np.pi * (np.arange(n) + 0.5) / n))[: struck.size]

    return {"force": force}
