"""Effects that are in no library, from which the posterior learns the cause ``unknown``.

They use the same hooks as the effects of `sim.effects` but are none of them: contact and elastomer
modulated over time or angle, hardening springs, drives that stall or have play, sound sources
beside the rig, sensors with crosstalk, lost samples, bit errors, loose contacts or a wrong clock.
They are rows of ``unknown_effects.toml``.

A row names a function of this file and the distribution of its parameters. Decorators turn
functions of signals into what `noise.training.causes.cases.variants.made` calls.
"""

from __future__ import annotations

import math
from functools import wraps
from typing import NamedTuple

import numpy as np
from scipy.signal import bilinear, fftconvolve, lfilter

from noise.base import packaged_toml
from noise.base.arrays import Rng
from noise.diagnosis.cases.draws import SENSED, slowly
from noise.training.causes.cases.variants import hooks, made
from noise.training.causes.cases.variants.contact import on_contact
from noise.training.causes.cases.variants.hooks import lagging, slewing
from noise.training.causes.cases.variants.sensors import on_signals
from sim.effects.effect import Effect, Signals, Stage
from sim.parameters import Parameter


def _table_hook(*numbers):
    return on_contact(hooks.table_hook, *numbers, n_states=2)


def _drawn_table(scale, table):
    """Change torques over time by a table that is drawn for each run."""

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
    """Subtract the mean of a signal, and divide it by its standard deviation."""
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


class _Run(NamedTuple):
    """Signals of a run, sampling rate [Hz], and random generator."""

    signals: Signals
    rate: float
    rng: Rng

    @property
    def times(self):
        return np.arange(self.signals["torque"].size) / self.rate


def _signals(function):
    """Change signals: ``function(run, a, **numbers)``."""

    @wraps(function)
    def maker(a, **numbers):
        return on_signals(a, lambda *run: function(_Run(*run), a, **numbers))

    return maker


def _channel(function):
    """Change one channel, or all of them: ``function(x, rate, rng, a, **numbers)``."""

    @wraps(function)
    def maker(a, channel, **numbers):
        names = SENSED if channel == len(SENSED) else (SENSED[channel],)
        return on_signals(a, lambda signals, rate, rng: {
            name: np.asarray(function(x, rate, rng, a, **numbers)) if name in names else x
            for name, x in signals.items()
        })  # fmt: skip

    return maker


def _added(function):
    """Add ``function(run, **numbers)``, of rms 1, times levels to the channels."""

    @wraps(function)
    def maker(a, levels, **numbers):
        def change(signals, rate, rng):
            x = function(_Run(signals, rate, rng), **numbers)
            x = x / (float(np.sqrt(np.mean(x**2))) + 1e-30)
            parts = zip(SENSED, levels.tolist(), strict=True)
            return signals | {name: signals[name] + a * level * x for name, level in parts}

        return on_signals(a, change)

    return maker


def _ring(rng, rate, tones, decay):
    since = np.arange(int(6.0 * decay * rate) + 2) / rate
    ringing = np.sin(2 * np.pi * np.outer(since, tones) + rng.uniform(0.0, 6.3, tones.size))
    return ringing.sum(axis=1) * np.exp(-since / decay)


@_signals
def shocks(run, a, tones, count, decay):
    """Be struck from outside."""
    time = run.times
    shock = np.zeros(time.size)
    for at in run.rng.uniform(0.0, time[-1], count):
        since = np.maximum(time - at, 0.0)
        shock += np.sin(2 * np.pi * tones[:, None] * since).sum(axis=0) * np.exp(-since / decay)
    sizes = {"torque": 0.5, "acceleration": 15.0, "pressure": 0.6}
    return {name: x + a * sizes.get(name, 0.0) * shock for name, x in run.signals.items()}


@_added
def second_source(run, pace, jitter, tones, decay):
    """Hear another joint creak."""
    n = run.signals["torque"].size
    steps = np.maximum(
        1.0 + jitter * run.rng.standard_normal(int(2 * pace * n / run.rate) + 4), 0.05
    )
    at = ((np.cumsum(steps) - run.rng.random()) / pace * run.rate).astype(np.int64)
    clicks = np.zeros(n)
    clicks[at[at < n]] = 1.0
    return fftconvolve(clicks, _ring(run.rng, run.rate, tones, decay))[:n]


@_added
def gear_mesh(run, teeth, sizes, depth, slow):
    """Hear the teeth of the drive."""
    turns, phases = run.signals["angle"] / (2 * np.pi), run.rng.random(4)
    mesh = sum(
        s * np.sin(2 * np.pi * ((k + 1) * teeth * turns + phases[k]))
        for k, s in enumerate((sizes * np.array([1.0, 0.6, 0.3])).tolist())
    )
    return (1.0 + depth * np.sin(2 * np.pi * (slow * turns + phases[3]))) * mesh


@_added
def rolling_bearing(run, order, tones, decay):
    """Roll over a dent."""
    turns = run.signals["angle"] / (2 * np.pi)
    passed = np.floor(order * turns + run.rng.random())
    clicks = np.diff(passed, prepend=passed[0]) * run.rng.uniform(0.6, 1.4, turns.size)
    return fftconvolve(clicks, _ring(run.rng, run.rate, tones, decay))[: turns.size]


@_added
def inverter_tone(run, carrier, apart, sides):
    """Hear the converter of a drive whistle."""
    time, phases = run.times, 6.3 * run.rng.random(5)
    tone = np.sin(2 * np.pi * carrier * time + phases[0])
    for k, size in enumerate(sides.tolist()):
        for sign in (-1.0, 1.0):
            side = carrier + sign * (k + 1) * apart
            tone += size * np.sin(2 * np.pi * side * time + phases[k + 1])
    return tone


@_added
def radio_buzz(run, pace, duty, group, on):
    """Pick up a telephone or a radio."""
    time = run.times
    pulses = np.where((pace * time + run.rng.random()) % 1.0 < duty, 1.0, 0.0)
    return pulses * ((group * time + run.rng.random()) % 1.0 < on)


@_added
def sweeping_tone(run, low, octaves, up, harmonics):
    """Hear a machine run up or down nearby."""
    n = run.signals["torque"].size
    part = np.arange(n) / n
    turns = np.cumsum(low * 2.0 ** (octaves * (part if up else 1.0 - part))) / run.rate
    orders = range(1, harmonics + 1)
    return sum(np.sin(2 * np.pi * (k * turns + run.rng.random())) / k for k in orders)


@_signals
def crosstalk(run, a, way, sign):
    """Leak from one channel into others."""
    source, into = (
        ("acceleration", ("torque", "pressure")),
        ("pressure", ("torque",)),
        ("torque", ("acceleration", "pressure")),
    )[way]
    leak = normed(run.signals[source])
    return run.signals | {k: run.signals[k] + sign * a * leak * run.signals[k].std() for k in into}


@_signals
def wow(run, a, slow, fast):
    """Play back at a speed that swings."""
    phases = run.rng.random(2)
    time = run.times
    late = 4e-3 * np.sin(2 * np.pi * (slow * time + phases[0]))
    late += 8e-4 * np.sin(2 * np.pi * (fast * time + phases[1]))
    return {name: np.interp(time - a * late, time, x) for name, x in run.signals.items()}


@_signals
def wrong_rate(run, a, sign):
    """Record all but the angle by a clock that is wrong."""
    n = run.signals["torque"].size
    at = np.arange(n) * (1.0 + 0.2 * a * sign)
    at = np.where(at > n - 1, 2 * (n - 1) - at, at)  # its end is played back
    return {
        name: x if name == "angle" else np.interp(at, np.arange(n), x)
        for name, x in run.signals.items()
    }


@_signals
def lost_samples(run, a, often, long):
    """Leave out samples in all channels."""
    n = run.signals["torque"].size
    gaps = run.rng.random(n) < often / run.rate
    jumps = gaps * np.ceil(a * long * run.rate * run.rng.exponential(1.0, n))
    at = np.arange(n) + np.cumsum(jumps)
    at = np.minimum(at, 2 * (n - 1) - np.minimum(at, 2 * (n - 1)))  # its end is played back
    read = np.clip(at, 0, n - 1).astype(np.int64)
    return {name: x if name == "angle" else x[read] for name, x in run.signals.items()}


@_channel
def aliased(x, rate, _rng, a, slow):
    """Sample too seldom without a filter."""
    at = np.arange(x.size)
    sampled = at[:: max(2, round(rate / slow))]
    return x + a * (np.interp(at, sampled, x[sampled]) - x)


@_signals
def fading_resonance(run, a, frequency, damping, corner, peak, *, both):
    """Ring along at some times and not at others."""
    names = ("acceleration", "pressure") if both else ("pressure",)
    tuned = 0.5 / math.tan(math.pi * min(frequency / run.rate, 0.45))
    band = bilinear([0.0, 2.0 * damping, 0.0], [1.0, 2.0 * damping, 1.0], fs=tuned)
    gate = np.clip(slowly(run.rng, run.signals["torque"].size, run.rate, corner), 0.0, 2.0)
    return run.signals | {
        k: run.signals[k] + a * peak * gate * lfilter(*band, run.signals[k]) for k in names
    }


@_channel
def lost_bits(x, _rate, _rng, a, *, coarse):
    """Read with too few steps, or with a bit that is stuck."""
    step = 1.5 * a * float(x.std()) + 1e-12
    whole = np.floor(x / step)
    return whole * step if coarse else np.where(whole % 2.0 == 1.0, whole * step, x)


@_channel
def bit_errors(x, rate, rng, a, often, bits):
    """Read single samples far off."""
    hit = rng.random(x.size) < often / rate
    size = a * float(np.abs(x - x.mean()).max()) * 2.0 ** -rng.integers(0, bits, x.size)
    return x + hit * size * rng.choice([-1.0, 1.0], x.size)


@_signals
def loose_plug(run, a, often, channel, hiss, jump):
    """Lose contact now and then."""
    name = SENSED[channel % len(SENSED)]
    x = run.signals[name]
    open_ = np.cumsum(run.rng.random(x.size) < often / run.rate) % 2 == 1
    more = open_ * x.std() * (hiss * run.rng.standard_normal(x.size) + jump)
    return run.signals | {name: x * (1.0 - a * open_) + a * more}


@_channel
def zero_jumps(x, rate, rng, a, often, fading):
    """Move the zero of a channel in steps that fade."""
    steps = (rng.random(x.size) < often / rate) * rng.standard_normal(x.size)
    steps[int(rng.integers(x.size))] += 1.0
    moved = lfilter([1.0], [1.0, -math.exp(-1.0 / (fading * rate))], steps)
    return x + 2.0 * a * x.std() * moved


@_channel
def slow_amplifier(x, _rate, _rng, a, share):
    """Follow no faster than an amplifier's slew rate."""
    steepest = float(np.abs(np.diff(x)).max())
    return slewing(np.ascontiguousarray(x), steepest * 10.0 ** (-3.0 * share * a))


@_signals
def play_in_the_cell(run, a, passed):
    """Pass on a part of the torque with play."""
    x = run.signals["torque"]
    lost = lagging(x, 1.2 * a * float(x.std()))
    return run.signals | {"torque": passed * x + (1.0 - passed) * lost}


@_signals
def encoder_error(run, a, order, size):
    """Read the angle with an error that comes again."""
    angle, error = run.signals["angle"], a * (0.5 * size) / order
    return run.signals | {"angle": angle + error * np.sin(order * angle + run.rng.random())}


UNKNOWN_EFFECTS = packaged_toml("noise.training.causes.cases", "unknown_effects.toml")
"""Rows by name."""

_STRENGTH = {"strength": Parameter(1.0, "", 0.0, 1.0, "nothing at 0")}


def draw_unknown_effect(
    name: str, strength: float, kinetic_torque: float, stiffness: float, rng: Rng
) -> Effect:
    """Draw an unknown effect.

    Parameters
    ----------
    name : str
        Of `UNKNOWN_EFFECTS`.
    strength : float
        From 0 to 1 [-].
    kinetic_torque, stiffness : float
        Of the rig [Nm], [Nm/rad].
    rng : numpy.random.Generator

    Returns
    -------
    Effect

    Examples
    --------
    >>> import numpy as np
    >>> draw_unknown_effect("wow", 0.5, 8.0, 665.0, np.random.default_rng(0)).stage.value
    'measurement'
    """
    row = UNKNOWN_EFFECTS[name]
    specs = {key: spec for key, spec in row.items() if key != "stage"}
    acting = made(globals()[name], specs, strength, rng, torque=kinetic_torque, stiffness=stiffness)
    return Effect(
        "unknown_effect", Stage(row["stage"]), ("plain",), _STRENGTH, "strength", **acting
    )
