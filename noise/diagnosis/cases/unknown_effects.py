"""Effects that no library has, for the diagnosis to learn what it does not know.

Each is made of the same parts as the effects of `sim.effects` but is none of them: contact and
elastomer modulated over time or angle, springs that harden, drives that stall, sensors that leak
into each other, lose bits, contact or the beat. What they have in common is only that the cause
posterior must not give them a name.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from sim.contact import (
    CRITICAL,
    ELASTOMER_TORQUE,
    HOOK_SIGNATURE,
    KINETIC,
    SHAFT_ANGLE,
    STIFFNESS,
    TIME,
    TWIST,
)
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["UNKNOWN_EFFECTS", "draw_unknown_effect"]

Signals = dict[str, "NDArray[np.float64]"]
Recipe = Callable[[float, float, float, np.random.Generator], Effect]

_STRENGTH = {"strength": Parameter(1.0, "", 0.0, 1.0, "nothing at 0")}
_TORQUES, _STIFFNESS, _SPRING = 0.0, 1.0, 2.0
_OVER_TIME, _OVER_ANGLE = 0.0, 1.0
_HEADER = 4


def draw_unknown_effect(
    name: str, strength: float, kinetic_torque: float, stiffness: float, rng: np.random.Generator
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
    """
    return UNKNOWN_EFFECTS[name](strength, kinetic_torque, stiffness, rng)


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def _table_hook(context, values, state, state_rates, contact):
    what, over, scale = values[0], values[1], values[2]
    if what == _SPRING:
        deep = context[TWIST] - scale
        if values[3] > 0.0 or deep > 0.0:
            contact[ELASTOMER_TORQUE] += values[_HEADER] * deep * abs(deep) ** values[3]
        return
    n = values.size - _HEADER
    x = (context[TIME] if over == _OVER_TIME else context[SHAFT_ANGLE]) / scale
    x = (x - math.floor(x)) * n
    i = int(x)
    part = x - i
    table = (1.0 - part) * values[_HEADER + i % n] + part * values[_HEADER + (i + 1) % n]
    if what == _STIFFNESS:
        contact[STIFFNESS] *= 1.0 + table
    else:
        contact[KINETIC] *= 1.0 + table
        contact[CRITICAL] *= 1.0 + table


def _contact(pack: Callable[[np.random.Generator], NDArray[np.float64]]) -> Effect:
    return Effect(
        "unknown_effect", Stage.FRICTION, ("plain",), _STRENGTH, "strength", contact=_table_hook,
        pack=lambda _form, _values, rng: pack(rng),
    )  # fmt: skip


def _sensors(change: Callable[[Signals, float, np.random.Generator], Signals]) -> Effect:
    return Effect(
        "unknown_effect", Stage.MEASUREMENT, ("plain",), _STRENGTH, "strength",
        sensors=lambda signals, rate, _form, _values, rng: change(signals, rate, rng),
    )  # fmt: skip


def _table(
    what: float, over: float, scale: float, table: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.concatenate([[what, over, scale, 0.0], table])


def _cogging(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    turn = np.arange(4096) / 4096
    bumps = np.cos(2 * np.pi * (int(rng.integers(5, 40)) * turn + rng.random()))
    bumps = bumps ** int(rng.integers(1, 4)) + 0.4 * np.cos(2 * np.pi * turn)
    return _contact(lambda _rng: _table(_TORQUES, _OVER_ANGLE, 2 * np.pi, 0.35 * a * bumps))


def _pumped(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    period = 1.0 / math.exp(rng.uniform(math.log(40.0), math.log(700.0)))
    wave = 0.45 * a * np.sin(2 * np.pi * np.arange(256) / 256)
    return _contact(lambda _rng: _table(_STIFFNESS, _OVER_TIME, period, wave))


def _debris(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    low, high = float(rng.uniform(50.0, 300.0)), float(rng.uniform(1000.0, 4000.0))
    often, long = float(rng.uniform(5.0, 20.0)), float(rng.uniform(0.004, 0.05))

    def pack(rng: np.random.Generator) -> NDArray[np.float64]:
        time = np.arange(40_000) / 20e3
        bursts = np.zeros(time.size)
        for _ in range(int(rng.poisson(often * 2)) + 1):
            since = (time - rng.uniform(0.0, 2.0)) / (long * rng.uniform(0.5, 1.5))
            bursts += np.where(since > 0.0, np.exp(-np.maximum(since, 0.0)), 0.0)
        rough = 1.0 + _noise(rng, time.size, 20e3, low, high)
        return _table(_TORQUES, _OVER_TIME, 2.0, np.clip(0.2 * a * bursts * rough, -0.6, 1.0))

    return _contact(pack)


def _load(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    corner = math.exp(rng.uniform(0.0, math.log(15.0)))

    def pack(rng: np.random.Generator) -> NDArray[np.float64]:
        wander = _noise(rng, 20_000, 10e3, 0.5 * corner, 2.0 * corner + 1.0)
        return _table(_TORQUES, _OVER_TIME, 2.0, np.clip(0.3 * a * wander, -0.6, 1.0))

    return _contact(pack)


def _hardening(a: float, torque: float, stiffness: float, rng: np.random.Generator) -> Effect:
    power = float(rng.uniform(1.5, 2.5))
    wound = torque / stiffness
    more = 0.6 * a * stiffness / float(rng.uniform(0.002, 0.004)) ** power
    return _contact(lambda _rng: np.array([_SPRING, 0.0, wound, power, more]))


def _stop(a: float, torque: float, stiffness: float, rng: np.random.Generator) -> Effect:
    at = torque / stiffness * float(rng.uniform(1.0, 1.15))
    return _contact(lambda _rng: np.array([_SPRING, 0.0, at, 0.0, 20.0 * a * stiffness]))


def _stall(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    often, duty = float(rng.uniform(4.0, 18.0)), float(rng.uniform(0.2, 0.5))
    share = 0.9 * a

    def drive(speed, rate, _form, _values, rng):
        time = np.arange(speed.size) / rate
        stalled = (often * time + rng.random()) % 1.0 < duty
        return speed * np.where(stalled, 1.0 - share, 1.0 + share * duty / (1.0 - duty))

    return Effect("unknown_effect", Stage.DRIVE, ("plain",), _STRENGTH, "strength", drive=drive)


def _crosstalk(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    source, into = (
        ("acceleration", ("torque", "pressure")),
        ("pressure", ("torque",)),
        ("torque", ("acceleration", "pressure")),
    )[int(rng.integers(3))]
    sign = float(rng.choice([-1.0, 1.0]))

    def change(signals: Signals, _rate: float, _rng: np.random.Generator) -> Signals:
        leak = _normed(signals[source])
        return {
            name: x + sign * 0.6 * a * leak * x.std() if name in into else x
            for name, x in signals.items()
        }

    return _sensors(change)


def _wow(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    slow, fast = float(rng.uniform(1.0, 7.0)), float(rng.uniform(10.0, 70.0))

    def change(signals: Signals, rate: float, rng: np.random.Generator) -> Signals:
        phases = rng.random(2)
        read = {}
        for name, x in signals.items():
            time = np.arange(x.size) / rate
            late = 2.5e-3 * np.sin(2 * np.pi * (slow * time + phases[0]))
            late += 4e-4 * np.sin(2 * np.pi * (fast * time + phases[1]))
            read[name] = np.interp(time - a * late, time, x)
        return read

    return _sensors(change)


def _lost_bits(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    coarse, where = bool(rng.random() < 0.5), _where(rng)

    def change(signals: Signals, _rate: float, _rng: np.random.Generator) -> Signals:
        read = dict(signals)
        for name in where:
            step = 0.8 * a * float(signals[name].std()) + 1e-12
            whole = np.floor(signals[name] / step)
            stuck = whole * step
            read[name] = stuck if coarse else np.where(whole % 2.0 == 1.0, stuck, signals[name])
        return read

    return _sensors(change)


def _loose_plug(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    often, name = float(rng.uniform(8.0, 70.0)), _where(rng)[0]
    hiss, jump = float(rng.choice([0.0, 0.2])), float(rng.choice([0.0, 0.0, 1.0]))

    def change(signals: Signals, rate: float, rng: np.random.Generator) -> Signals:
        x = signals[name]
        open_ = np.cumsum(rng.random(x.size) < often / rate) % 2 == 1
        more = open_ * x.std() * (hiss * rng.standard_normal(x.size) + jump)
        return signals | {name: x * (1.0 - a * open_) + a * more}

    return _sensors(change)


def _shocks(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    tones, count = rng.uniform(25.0, 300.0, 4), int(rng.integers(2, 9))
    decay = float(rng.uniform(0.01, 0.06))

    def change(signals: Signals, rate: float, rng: np.random.Generator) -> Signals:
        time = np.arange(signals["torque"].size) / rate
        shock = np.zeros(time.size)
        for at in rng.uniform(0.0, time[-1], count):
            since = np.maximum(time - at, 0.0)
            ringing = np.sin(2 * np.pi * tones[:, None] * since).sum(axis=0)
            shock += ringing * np.exp(-since / decay)
        sizes = {"torque": 0.5, "acceleration": 15.0, "pressure": 0.6}
        return {name: x + a * sizes.get(name, 0.0) * shock for name, x in signals.items()}

    return _sensors(change)


def _play(a: float, _torque: float, _stiffness: float, rng: np.random.Generator) -> Effect:
    passed = float(rng.uniform(0.2, 0.5))

    def change(signals: Signals, _rate: float, _rng: np.random.Generator) -> Signals:
        x = signals["torque"]
        lost = _lagging(x, 1.2 * a * float(x.std()))
        return signals | {"torque": passed * x + (1.0 - passed) * lost}

    return _sensors(change)


UNKNOWN_EFFECTS: Mapping[str, Recipe] = {
    "cogging": _cogging,
    "pumped_stiffness": _pumped,
    "debris": _debris,
    "wandering_load": _load,
    "hardening_spring": _hardening,
    "second_contact": _stop,
    "stalling_drive": _stall,
    "crosstalk": _crosstalk,
    "wow": _wow,
    "lost_bits": _lost_bits,
    "loose_plug": _loose_plug,
    "shocks": _shocks,
    "play_in_the_cell": _play,
}
"""Each takes strength, kinetic torque, stiffness and a generator."""


@njit(cache=True)
def _lagging(x, width):
    y = np.empty_like(x)
    held = x[0]
    for i in range(x.size):
        held = min(max(held, x[i] - width), x[i] + width)
        y[i] = held
    return y


def _noise(
    rng: np.random.Generator, n: int, rate: float, low: float, high: float
) -> NDArray[np.float64]:
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    spectrum = np.zeros(frequency.size, dtype=complex)
    count = int(inside.sum())
    spectrum[inside] = rng.standard_normal(count) + 1j * rng.standard_normal(count)
    return _normed(np.fft.irfft(spectrum, n))


def _normed(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((x - x.mean()) / (float(x.std()) + 1e-30))


def _where(rng: np.random.Generator) -> tuple[str, ...]:
    names = ("torque", "acceleration", "pressure")
    one = int(rng.integers(4))
    return names if one == 3 else (names[one],)
