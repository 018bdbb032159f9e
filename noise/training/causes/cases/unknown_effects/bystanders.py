"""Unknown effects of what else sounds, sends or strikes near the rig."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.signal import fftconvolve

from noise.diagnosis.cases.draws import log_uniform, log_uniforms
from noise.training.causes.cases.unknown_effects.parts import Array, Recipe, Rng, added, on_sensors
from sim.effects.effect import Effect, Signals

_LEVELS = (0.4, 25.0, 1.0)
"""Of torque, acceleration and pressure at strength 1, at most [Nm], [m/s2], [Pa]."""


def _levels(rng: Rng) -> tuple[float, float, float]:
    torque, acceleration, pressure = (level * log_uniform(rng, 0.1, 1.0) for level in _LEVELS)
    return torque * float(rng.random() < 0.5), acceleration, pressure


def _shocks(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    tones, count = rng.uniform(25.0, 300.0, 4), int(rng.integers(2, 9))
    decay = float(rng.uniform(0.01, 0.06))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        time = np.arange(signals["torque"].size) / rate
        shock = np.zeros(time.size)
        for at in rng.uniform(0.0, time[-1], count):
            since = np.maximum(time - at, 0.0)
            ringing = np.sin(2 * np.pi * tones[:, None] * since).sum(axis=0)
            shock += ringing * np.exp(-since / decay)
        sizes = {"torque": 0.5, "acceleration": 15.0, "pressure": 0.6}
        return {name: x + a * sizes.get(name, 0.0) * shock for name, x in signals.items()}

    return on_sensors(a, change)


def _ring(rng: Rng, rate: float, tones: Array, decay: float) -> Array:
    since = np.arange(int(6.0 * decay * rate) + 2) / rate
    ringing = np.sin(2 * np.pi * np.outer(since, tones) + rng.uniform(0.0, 6.3, tones.size))
    return np.asarray(ringing.sum(axis=1) * np.exp(-since / decay))


def _second_source(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Hear another joint creak, at a pace of its own."""
    pace, jitter = log_uniform(rng, 4.0, 300.0), float(rng.uniform(0.0, 0.4))
    tones, decay = log_uniforms(rng, 300.0, 8000.0, 3), log_uniform(rng, 5e-4, 1e-2)

    def series(n: int, rate: float, rng: Rng) -> Array:
        steps = np.maximum(1.0 + jitter * rng.standard_normal(int(2 * pace * n / rate) + 4), 0.05)
        at = ((np.cumsum(steps) - rng.random()) / pace * rate).astype(np.int64)
        clicks = np.zeros(n)
        clicks[at[at < n]] = 1.0
        return np.asarray(fftconvolve(clicks, _ring(rng, rate, tones, decay))[:n])

    return added(a, _levels(rng), series)


def _of_turns(a: float, rng: Rng, wave: object) -> Effect:
    """Add what goes with the shaft's angle: ``wave(turns, rate, rng)``."""
    levels = _levels(rng)

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        x = wave(signals["angle"] / (2 * np.pi), rate, rng)  # type: ignore[operator]
        x = x / (float(np.sqrt(np.mean(x**2))) + 1e-30)
        sizes = dict(zip(("torque", "acceleration", "pressure"), levels, strict=True))
        return {name: y + a * sizes.get(name, 0.0) * x for name, y in signals.items()}

    return on_sensors(a, change)


def _gear_mesh(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Hear the teeth of the drive, of which so many pass in a turn of the shaft."""
    teeth = log_uniform(rng, 60.0, 3000.0)
    sizes = rng.exponential(1.0, 3) * np.array([1.0, 0.6, 0.3])
    depth, slow = float(rng.uniform(0.0, 0.8)), float(rng.integers(1, 20))

    def wave(turns: Array, _rate: float, rng: Rng) -> Array:
        phases = rng.random(4)
        mesh = sum(
            s * np.sin(2 * np.pi * ((k + 1) * teeth * turns + phases[k]))
            for k, s in enumerate(sizes.tolist())
        )
        return np.asarray((1.0 + depth * np.sin(2 * np.pi * (slow * turns + phases[3]))) * mesh)

    return _of_turns(a, rng, wave)


def _bearing(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Roll over a dent: impacts so often a turn, each of which rings."""
    order = log_uniform(rng, 40.0, 500.0)
    tones, decay = log_uniforms(rng, 800.0, 9000.0, 2), log_uniform(rng, 3e-4, 4e-3)

    def wave(turns: Array, rate: float, rng: Rng) -> Array:
        passed = np.floor(order * turns + rng.random())
        clicks = np.diff(passed, prepend=passed[0]) * rng.uniform(0.6, 1.4, turns.size)
        return np.asarray(fftconvolve(clicks, _ring(rng, rate, tones, decay))[: turns.size])

    return _of_turns(a, rng, wave)


def _inverter(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Hear the converter of a drive whistle, with side tones."""
    carrier, apart = log_uniform(rng, 1500.0, 14e3), log_uniform(rng, 15.0, 200.0)
    sides = rng.uniform(0.1, 1.0, 2)

    def series(n: int, rate: float, rng: Rng) -> Array:
        time, phases = np.arange(n) / rate, 6.3 * rng.random(5)
        tone = np.sin(2 * np.pi * carrier * time + phases[0])
        for k, size in enumerate(sides.tolist()):
            for sign in (-1.0, 1.0):
                tone += size * np.sin(
                    2 * np.pi * (carrier + sign * (k + 1) * apart) * time + phases[k + 1]
                )
        return np.asarray(tone)

    return added(a, _levels(rng), series)


def _radio(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Pick up a telephone or a radio: short pulses in groups."""
    pace, duty = log_uniform(rng, 80.0, 400.0), float(rng.uniform(0.03, 0.3))
    group, on = log_uniform(rng, 2.0, 12.0), float(rng.uniform(0.3, 0.9))

    def series(n: int, rate: float, rng: Rng) -> Array:
        time = np.arange(n) / rate
        pulses = np.where((pace * time + rng.random()) % 1.0 < duty, 1.0, 0.0)
        return pulses * ((group * time + rng.random()) % 1.0 < on)

    return added(a, _levels(rng), series)


def _sweeping(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Hear a machine run up or down nearby: a tone that climbs through the recording."""
    low, octaves = log_uniform(rng, 50.0, 1500.0), float(rng.uniform(0.5, 3.0))
    up, harmonics = bool(rng.integers(2)), int(rng.integers(1, 5))

    def series(n: int, rate: float, rng: Rng) -> Array:
        part = np.arange(n) / n
        turns = np.cumsum(low * 2.0 ** (octaves * (part if up else 1.0 - part))) / rate
        return np.asarray(
            sum(np.sin(2 * np.pi * (k * turns + rng.random())) / k for k in range(1, harmonics + 1))
        )

    return added(a, _levels(rng), series)


BYSTANDERS: Mapping[str, Recipe] = {
    "shocks": _shocks,
    "second_source": _second_source,
    "gear_mesh": _gear_mesh,
    "rolling_bearing": _bearing,
    "inverter_tone": _inverter,
    "radio_buzz": _radio,
    "sweeping_tone": _sweeping,
}
"""Each takes strength, kinetic torque, stiffness and a generator."""
