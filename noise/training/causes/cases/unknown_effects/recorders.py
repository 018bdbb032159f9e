"""Unknown effects of sensors, cables and recorders."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from scipy.signal import bilinear, lfilter

from noise.diagnosis.cases.draws import log_uniform, slowly
from noise.training.causes.cases.unknown_effects.hooks import lagging, slewing
from noise.training.causes.cases.unknown_effects.parts import (
    Array,
    Recipe,
    Rng,
    normed,
    on_sensors,
    where,
)
from sim.effects.effect import Effect, Signals


def _each(a: float, rng: Rng, change: Callable[[Array, float, Rng], Array]) -> Effect:
    """Change one channel, or all of them: ``change(x, rate, rng)``."""
    names = where(rng)
    return on_sensors(
        a,
        lambda signals, rate, rng: {
            name: change(x, rate, rng) if name in names else x for name, x in signals.items()
        },
    )


def _crosstalk(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    source, into = (
        ("acceleration", ("torque", "pressure")),
        ("pressure", ("torque",)),
        ("torque", ("acceleration", "pressure")),
    )[int(rng.integers(3))]
    sign = float(rng.choice([-1.0, 1.0]))

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        leak = normed(signals[source])
        return {
            name: x + sign * a * leak * x.std() if name in into else x
            for name, x in signals.items()
        }

    return on_sensors(a, change)


def _wow(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    slow, fast = float(rng.uniform(1.0, 7.0)), float(rng.uniform(10.0, 70.0))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        phases = rng.random(2)
        read = {}
        for name, x in signals.items():
            time = np.arange(x.size) / rate
            late = 4e-3 * np.sin(2 * np.pi * (slow * time + phases[0]))
            late += 8e-4 * np.sin(2 * np.pi * (fast * time + phases[1]))
            read[name] = np.interp(time - a * late, time, x)
        return read

    return on_sensors(a, change)


def _wrong_rate(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Record all but the angle by a clock that is wrong."""
    error = 0.2 * a * float(rng.choice([-1.0, 1.0]))

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        n = signals["torque"].size
        at = np.arange(n) * (1.0 + error)
        at = np.where(at > n - 1, 2 * (n - 1) - at, at)  # its end is played back
        return {
            name: x if name == "angle" else np.interp(at, np.arange(n), x)
            for name, x in signals.items()
        }

    return on_sensors(a, change)


def _lost_samples(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Leave out samples in all channels, now and then, and go on as if nothing were missing."""
    often, long = log_uniform(rng, 5.0, 60.0), log_uniform(rng, 1e-3, 1e-2)

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        n = signals["torque"].size
        gaps = rng.random(n) < often / rate
        jumps = gaps * np.ceil(a * long * rate * rng.exponential(1.0, n))
        at = np.arange(n) + np.cumsum(jumps)
        at = np.minimum(at, 2 * (n - 1) - np.minimum(at, 2 * (n - 1)))  # its end is played back
        return {
            name: x if name == "angle" else x[np.clip(at, 0, n - 1).astype(np.int64)]
            for name, x in signals.items()
        }

    return on_sensors(a, change)


def _aliased(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Sample too seldom without a filter, and read between the samples."""
    slow = log_uniform(rng, 1500.0, 9000.0)

    def change(x: Array, rate: float, _rng: Rng) -> Array:
        at = np.arange(x.size)
        kept = at[:: max(2, round(rate / slow))]
        return np.asarray(x + a * (np.interp(at, kept, x[kept]) - x))

    return _each(a, rng, change)


def _fading_resonance(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Ring along at some times and not at others: a cover that lifts, a cable that touches."""
    frequency, damping = log_uniform(rng, 200.0, 8000.0), log_uniform(rng, 0.005, 0.05)
    corner, peak = log_uniform(rng, 1.0, 15.0), log_uniform(rng, 10.0, 80.0)
    names = ("acceleration", "pressure") if rng.random() < 0.4 else ("pressure",)

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        tuned = 0.5 / math.tan(math.pi * min(frequency / rate, 0.45))
        band = bilinear([0.0, 2.0 * damping, 0.0], [1.0, 2.0 * damping, 1.0], fs=tuned)
        gate = np.clip(slowly(rng, signals["torque"].size, rate, corner), 0.0, 2.0)
        return {
            name: x + a * peak * gate * lfilter(*band, x) if name in names else x
            for name, x in signals.items()
        }

    return on_sensors(a, change)


def _lost_bits(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    coarse = bool(rng.random() < 0.5)

    def change(x: Array, _rate: float, _rng: Rng) -> Array:
        step = 1.5 * a * float(x.std()) + 1e-12
        whole = np.floor(x / step)
        stuck = whole * step
        return np.asarray(stuck if coarse else np.where(whole % 2.0 == 1.0, stuck, x))

    return _each(a, rng, change)


def _bit_errors(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Read single samples far off, by a power of two of the range."""
    often, bits = log_uniform(rng, 20.0, 2000.0), int(rng.integers(1, 5))

    def change(x: Array, rate: float, rng: Rng) -> Array:
        hit = rng.random(x.size) < often / rate
        size = a * float(np.abs(x - x.mean()).max()) * 2.0 ** -rng.integers(0, bits, x.size)
        return np.asarray(x + hit * size * rng.choice([-1.0, 1.0], x.size))

    return _each(a, rng, change)


def _loose_plug(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    often, name = float(rng.uniform(8.0, 70.0)), where(rng)[0]
    hiss, jump = float(rng.choice([0.0, 0.2])), float(rng.choice([0.0, 0.0, 1.0]))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        x = signals[name]
        open_ = np.cumsum(rng.random(x.size) < often / rate) % 2 == 1
        more = open_ * x.std() * (hiss * rng.standard_normal(x.size) + jump)
        return signals | {name: x * (1.0 - a * open_) + a * more}

    return on_sensors(a, change)


def _zero_jumps(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Move the zero of a channel in steps that fade: charge, static, a tap on the cable."""
    often, fading = log_uniform(rng, 2.0, 25.0), log_uniform(rng, 5e-3, 0.5)

    def change(x: Array, rate: float, rng: Rng) -> Array:
        steps = (rng.random(x.size) < often / rate) * rng.standard_normal(x.size)
        steps[int(rng.integers(x.size))] += 1.0
        moved = lfilter([1.0], [1.0, -math.exp(-1.0 / (fading * rate))], steps)
        return np.asarray(x + 2.0 * a * x.std() * moved)

    return _each(a, rng, change)


def _slow_amplifier(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Follow no faster than an amplifier's slew rate."""
    share = float(rng.uniform(0.5, 1.0))

    def change(x: Array, _rate: float, _rng: Rng) -> Array:
        steepest = float(np.abs(np.diff(x)).max())
        return np.asarray(slewing(np.ascontiguousarray(x), steepest * 10.0 ** (-3.0 * share * a)))

    return _each(a, rng, change)


def _play(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    passed = float(rng.uniform(0.2, 0.5))

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        x = signals["torque"]
        lost = lagging(x, 1.2 * a * float(x.std()))
        return signals | {"torque": passed * x + (1.0 - passed) * lost}

    return on_sensors(a, change)


def _encoder(a: float, _torque: float, _stiffness: float, rng: Rng) -> Effect:
    """Read the angle with an error that comes again with each line or turn of the encoder."""
    order, size = log_uniform(rng, 1.0, 2000.0), 0.5 * float(rng.uniform(0.3, 1.0))

    def change(signals: Signals, _rate: float, rng: Rng) -> Signals:
        angle = signals["angle"]
        return signals | {"angle": angle + a * size / order * np.sin(order * angle + rng.random())}

    return on_sensors(a, change)


RECORDERS: Mapping[str, Recipe] = {
    "crosstalk": _crosstalk,
    "wow": _wow,
    "wrong_rate": _wrong_rate,
    "lost_samples": _lost_samples,
    "aliased": _aliased,
    "fading_resonance": _fading_resonance,
    "lost_bits": _lost_bits,
    "bit_errors": _bit_errors,
    "loose_plug": _loose_plug,
    "zero_jumps": _zero_jumps,
    "slow_amplifier": _slow_amplifier,
    "play_in_the_cell": _play,
    "encoder_error": _encoder,
}
"""Each takes strength, kinetic torque, stiffness and a generator."""
