"""Unknown effects of what else sounds near the rig, and of sensors, cables and recorders."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.signal import bilinear, fftconvolve, lfilter

from noise.diagnosis.cases.draws import SENSED, Array, Rng, slowly
from noise.training.causes.cases.unknown_effects.hooks import lagging, slewing
from noise.training.causes.cases.unknown_effects.mechanics import normed
from noise.training.causes.cases.variants.sensors import on_signals
from sim.effects.effect import Signals


def _on_channel(
    a: float, channel: int, change: Callable[[Array, float, Rng], Array]
) -> dict[str, Any]:
    """Change one channel, or all of them: ``change(x, rate, rng)``."""
    names = SENSED if channel == len(SENSED) else (SENSED[channel],)
    return on_signals(a, lambda signals, rate, rng: {
        name: change(x, rate, rng) if name in names else x for name, x in signals.items()
    })  # fmt: skip


def _added(
    a: float, levels: Array, series: Callable[[Signals, float, Rng], Array]
) -> dict[str, Any]:
    """Add a series of rms 1 to torque, acceleration and pressure, at levels."""

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        x = series(signals, rate, rng)
        x = x / (float(np.sqrt(np.mean(x**2))) + 1e-30)
        parts = zip(SENSED, levels.tolist(), strict=True)
        return signals | {name: signals[name] + a * level * x for name, level in parts}

    return on_signals(a, change)


def _times(signals: Signals, rate: float) -> Array:
    return np.arange(signals["torque"].size) / rate


def _ring(rng: Rng, rate: float, tones: Array, decay: float) -> Array:
    since = np.arange(int(6.0 * decay * rate) + 2) / rate
    ringing = np.sin(2 * np.pi * np.outer(since, tones) + rng.uniform(0.0, 6.3, tones.size))
    return np.asarray(ringing.sum(axis=1) * np.exp(-since / decay))


def shocks(a: float, tones: Array, count: int, decay: float) -> dict[str, Any]:
    """Be struck from outside."""

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        time = _times(signals, rate)
        shock = np.zeros(time.size)
        for at in rng.uniform(0.0, time[-1], count):
            since = np.maximum(time - at, 0.0)
            ringing = np.sin(2 * np.pi * tones[:, None] * since).sum(axis=0)
            shock += ringing * np.exp(-since / decay)
        sizes = {"torque": 0.5, "acceleration": 15.0, "pressure": 0.6}
        return {name: x + a * sizes.get(name, 0.0) * shock for name, x in signals.items()}

    return on_signals(a, change)


def second_source(
    a: float, pace: float, jitter: float, tones: Array, decay: float, levels: Array
) -> dict[str, Any]:
    """Hear another joint creak."""

    def series(signals: Signals, rate: float, rng: Rng) -> Array:
        n = signals["torque"].size
        steps = np.maximum(1.0 + jitter * rng.standard_normal(int(2 * pace * n / rate) + 4), 0.05)
        at = ((np.cumsum(steps) - rng.random()) / pace * rate).astype(np.int64)
        clicks = np.zeros(n)
        clicks[at[at < n]] = 1.0
        return np.asarray(fftconvolve(clicks, _ring(rng, rate, tones, decay))[:n])

    return _added(a, levels, series)


def gear_mesh(
    a: float, teeth: float, sizes: Array, depth: float, slow: int, levels: Array
) -> dict[str, Any]:
    """Hear the teeth of the drive."""
    sizes = sizes * np.array([1.0, 0.6, 0.3])

    def series(signals: Signals, _rate: float, rng: Rng) -> Array:
        turns, phases = signals["angle"] / (2 * np.pi), rng.random(4)
        mesh = sum(
            s * np.sin(2 * np.pi * ((k + 1) * teeth * turns + phases[k]))
            for k, s in enumerate(sizes.tolist())
        )
        return np.asarray((1.0 + depth * np.sin(2 * np.pi * (slow * turns + phases[3]))) * mesh)

    return _added(a, levels, series)


def rolling_bearing(
    a: float, order: float, tones: Array, decay: float, levels: Array
) -> dict[str, Any]:
    """Roll over a dent."""

    def series(signals: Signals, rate: float, rng: Rng) -> Array:
        turns = signals["angle"] / (2 * np.pi)
        passed = np.floor(order * turns + rng.random())
        clicks = np.diff(passed, prepend=passed[0]) * rng.uniform(0.6, 1.4, turns.size)
        return np.asarray(fftconvolve(clicks, _ring(rng, rate, tones, decay))[: turns.size])

    return _added(a, levels, series)


def inverter_tone(
    a: float, carrier: float, apart: float, sides: Array, levels: Array
) -> dict[str, Any]:
    """Hear the converter of a drive whistle."""

    def series(signals: Signals, rate: float, rng: Rng) -> Array:
        time, phases = _times(signals, rate), 6.3 * rng.random(5)
        tone = np.sin(2 * np.pi * carrier * time + phases[0])
        for k, size in enumerate(sides.tolist()):
            for sign in (-1.0, 1.0):
                side = carrier + sign * (k + 1) * apart
                tone += size * np.sin(2 * np.pi * side * time + phases[k + 1])
        return np.asarray(tone)

    return _added(a, levels, series)


def radio_buzz(
    a: float, pace: float, duty: float, group: float, on: float, levels: Array
) -> dict[str, Any]:
    """Pick up a telephone or a radio."""

    def series(signals: Signals, rate: float, rng: Rng) -> Array:
        time = _times(signals, rate)
        pulses = np.where((pace * time + rng.random()) % 1.0 < duty, 1.0, 0.0)
        return np.asarray(pulses * ((group * time + rng.random()) % 1.0 < on))

    return _added(a, levels, series)


def sweeping_tone(
    a: float, low: float, octaves: float, up: int, harmonics: int, levels: Array
) -> dict[str, Any]:
    """Hear a machine run up or down nearby."""

    def series(signals: Signals, rate: float, rng: Rng) -> Array:
        n = signals["torque"].size
        part = np.arange(n) / n
        turns = np.cumsum(low * 2.0 ** (octaves * (part if up else 1.0 - part))) / rate
        orders = range(1, harmonics + 1)
        return np.asarray(sum(np.sin(2 * np.pi * (k * turns + rng.random())) / k for k in orders))

    return _added(a, levels, series)


def crosstalk(a: float, way: int, sign: float) -> dict[str, Any]:
    """Leak from one channel into others."""
    source, into = (
        ("acceleration", ("torque", "pressure")),
        ("pressure", ("torque",)),
        ("torque", ("acceleration", "pressure")),
    )[way]

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        leak = normed(signals[source])
        return signals | {
            name: signals[name] + sign * a * leak * signals[name].std() for name in into
        }

    return on_signals(a, change)


def wow(a: float, slow: float, fast: float) -> dict[str, Any]:
    """Play back at a speed that swings."""

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        phases = rng.random(2)
        time = _times(signals, rate)
        late = 4e-3 * np.sin(2 * np.pi * (slow * time + phases[0]))
        late += 8e-4 * np.sin(2 * np.pi * (fast * time + phases[1]))
        return {name: np.interp(time - a * late, time, x) for name, x in signals.items()}

    return on_signals(a, change)


def wrong_rate(a: float, sign: float) -> dict[str, Any]:
    """Record all but the angle by a clock that is wrong."""
    error = 0.2 * a * sign

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        n = signals["torque"].size
        at = np.arange(n) * (1.0 + error)
        at = np.where(at > n - 1, 2 * (n - 1) - at, at)  # its end is played back
        return {
            name: x if name == "angle" else np.interp(at, np.arange(n), x)
            for name, x in signals.items()
        }

    return on_signals(a, change)


def lost_samples(a: float, often: float, long: float) -> dict[str, Any]:
    """Leave out samples in all channels."""

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

    return on_signals(a, change)


def aliased(a: float, slow: float, channel: int) -> dict[str, Any]:
    """Sample too seldom without a filter."""

    def change(x: Array, rate: float, _rng: Rng) -> Array:
        at = np.arange(x.size)
        kept = at[:: max(2, round(rate / slow))]
        return np.asarray(x + a * (np.interp(at, kept, x[kept]) - x))

    return _on_channel(a, channel, change)


def fading_resonance(
    a: float, frequency: float, damping: float, corner: float, peak: float, *, both: bool
) -> dict[str, Any]:
    """Ring along at some times and not at others."""
    names = ("acceleration", "pressure") if both else ("pressure",)

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        tuned = 0.5 / math.tan(math.pi * min(frequency / rate, 0.45))
        band = bilinear([0.0, 2.0 * damping, 0.0], [1.0, 2.0 * damping, 1.0], fs=tuned)
        gate = np.clip(slowly(rng, signals["torque"].size, rate, corner), 0.0, 2.0)
        rung = {k: signals[k] + a * peak * gate * lfilter(*band, signals[k]) for k in names}
        return signals | rung

    return on_signals(a, change)


def lost_bits(a: float, channel: int, *, coarse: bool) -> dict[str, Any]:
    """Read with too few steps, or with a bit that is stuck."""

    def change(x: Array, _rate: float, _rng: Rng) -> Array:
        step = 1.5 * a * float(x.std()) + 1e-12
        whole = np.floor(x / step)
        stuck = whole * step
        return np.asarray(stuck if coarse else np.where(whole % 2.0 == 1.0, stuck, x))

    return _on_channel(a, channel, change)


def bit_errors(a: float, often: float, bits: int, channel: int) -> dict[str, Any]:
    """Read single samples far off."""

    def change(x: Array, rate: float, rng: Rng) -> Array:
        hit = rng.random(x.size) < often / rate
        size = a * float(np.abs(x - x.mean()).max()) * 2.0 ** -rng.integers(0, bits, x.size)
        return np.asarray(x + hit * size * rng.choice([-1.0, 1.0], x.size))

    return _on_channel(a, channel, change)


def loose_plug(a: float, often: float, channel: int, hiss: float, jump: float) -> dict[str, Any]:
    """Lose contact now and then."""
    name = SENSED[channel % len(SENSED)]

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        x = signals[name]
        open_ = np.cumsum(rng.random(x.size) < often / rate) % 2 == 1
        more = open_ * x.std() * (hiss * rng.standard_normal(x.size) + jump)
        return signals | {name: x * (1.0 - a * open_) + a * more}

    return on_signals(a, change)


def zero_jumps(a: float, often: float, fading: float, channel: int) -> dict[str, Any]:
    """Move the zero of a channel in steps that fade."""

    def change(x: Array, rate: float, rng: Rng) -> Array:
        steps = (rng.random(x.size) < often / rate) * rng.standard_normal(x.size)
        steps[int(rng.integers(x.size))] += 1.0
        moved = lfilter([1.0], [1.0, -math.exp(-1.0 / (fading * rate))], steps)
        return np.asarray(x + 2.0 * a * x.std() * moved)

    return _on_channel(a, channel, change)


def slow_amplifier(a: float, share: float, channel: int) -> dict[str, Any]:
    """Follow no faster than an amplifier's slew rate."""

    def change(x: Array, _rate: float, _rng: Rng) -> Array:
        steepest = float(np.abs(np.diff(x)).max())
        return np.asarray(slewing(np.ascontiguousarray(x), steepest * 10.0 ** (-3.0 * share * a)))

    return _on_channel(a, channel, change)


def play_in_the_cell(a: float, passed: float) -> dict[str, Any]:
    """Pass on a part of the torque with play."""

    def change(signals: Signals, _rate: float, _rng: Rng) -> Signals:
        x = signals["torque"]
        lost = lagging(x, 1.2 * a * float(x.std()))
        return signals | {"torque": passed * x + (1.0 - passed) * lost}

    return on_signals(a, change)


def encoder_error(a: float, order: float, size: float) -> dict[str, Any]:
    """Read the angle with an error that comes again."""

    def change(signals: Signals, _rate: float, rng: Rng) -> Signals:
        angle, error = signals["angle"], a * (0.5 * size) / order
        return signals | {"angle": angle + error * np.sin(order * angle + rng.random())}

    return on_signals(a, change)
