"""Sensors and converters at fault: what overloads, drifts, or comes late."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..structure import filtered
from .form import DEVELOPMENT, SEALED, form, noise_in_band

_CHANNELS = ("torque", "acceleration", "pressure")


def _one_or_two(case):
    return tuple(case.choice(_CHANNELS, case.integers(1, 3), replace=False))


def _each(s, names, make, seed=0):
    """Replace channels by `make(x, rate, rng)`."""

    def change(signals, turned):
        rng = np.random.default_rng(seed)
        for name in names:
            signals[name] = make(signals[name], turned.rate, rng)

    s.sensors.append(change)


def _limits(x, share):
    mean = x.mean()
    return mean, np.abs(x - mean).max() * (1.0 - 0.75 * share)


@form("clipping", "measurement", DEVELOPMENT)
def wrapped_converter(s, a, case, run):
    def make(x, rate, rng):
        mean, limit = _limits(x, 0.6 * a)
        return mean + (x - mean + limit) % (2.0 * limit) - limit

    _each(s, _one_or_two(case), make)


@njit(cache=True)
def _recovering(x, limit, keep):
    y, tired = np.empty_like(x), 0.0
    for i in range(x.size):
        wanted = x[i] - tired
        y[i] = min(max(wanted, -limit), limit)
        tired = keep * tired + (1.0 - keep) * 6.0 * (wanted - y[i])
    return y


@form("clipping", "measurement", DEVELOPMENT)
def polynomial_overload(s, a, case, run):
    def make(x, rate, rng):
        mean, limit = _limits(x, 0.6)
        u = np.clip((x - mean) / (1.5 * limit), -1.0, 1.0)
        return x + a * (mean + 1.5 * limit * (u - u**3 / 3.0) - x)

    _each(s, _one_or_two(case), make)


@form("clipping", "measurement", SEALED)
def blocked_amplifier(s, a, case, run):
    time = case.uniform(5e-4, 5e-3)

    def make(x, rate, rng):
        mean, limit = _limits(x, a)
        return mean + _recovering(x - mean, limit, float(np.exp(-1.0 / (time * rate))))

    _each(s, _one_or_two(case), make)


@form("clipping", "measurement", SEALED)
def folding_one_side(s, a, case, run):
    side, back = float(case.choice([-1.0, 1.0])), case.uniform(0.0, 0.4)

    def make(x, rate, rng):
        mean, limit = _limits(x, a)
        over = np.maximum(side * (x - mean) - limit, 0.0)
        return x - side * (1.0 + back) * over

    _each(s, _one_or_two(case), make)


@form("gain_error", "measurement", DEVELOPMENT)
def wandering_gain(s, a, case, run):
    sign = float(case.choice([-1.0, 1.0]))

    def make(x, rate, rng):
        t = np.arange(x.size) / x.size
        walk = noise_in_band(rng, x.size, 1.0, 0.5 / x.size, 4.0 / x.size)
        return x * (1.0 + sign * a * (0.3 + 0.3 * t + 0.08 * walk))

    _each(s, _one_or_two(case), make, int(run.integers(2**31)))


@form("gain_error", "measurement", DEVELOPMENT)
def range_switched(s, a, case, run):
    sign = float(case.choice([-1.0, 1.0]))

    def make(x, rate, rng):
        at = rng.uniform(0.15, 0.6)
        return x * (1.0 + 0.6 * sign * a * (np.arange(x.size) / x.size > at))

    _each(s, _one_or_two(case), make, int(run.integers(2**31)))


@form("gain_error", "measurement", SEALED)
def gain_by_level(s, a, case, run):
    sign = float(case.choice([-1.0, 1.0]))

    def make(x, rate, rng):
        size = np.abs(x) / np.abs(x).max()
        return x * (1.0 + sign * a * (0.25 + 0.4 * size))

    _each(s, _one_or_two(case), make)


@form("gain_error", "measurement", SEALED)
def half_a_swing_of_warmth(s, a, case, run):
    sign, turns = float(case.choice([-1.0, 1.0])), case.uniform(0.3, 1.2)

    def make(x, rate, rng):
        phase = rng.uniform(0.0, 1.0) + turns * np.arange(x.size) / x.size
        return x * (1.0 + sign * a * (0.3 + 0.2 * np.sin(2 * np.pi * phase)))

    _each(s, _one_or_two(case), make, int(run.integers(2**31)))


def _one(case):
    return (str(case.choice(_CHANNELS)),)


def _read_at(x, rate, late):
    t = np.arange(x.size) / rate
    return np.interp(t - late, t, x)


@form("channel_delay", "measurement", DEVELOPMENT)
def all_pass(s, a, case, run):
    tau = 6e-4 * a

    def make(x, rate, rng):
        def response(f):
            w = 2j * np.pi * f * tau
            return ((1.0 - w) / (1.0 + w)) ** 2

        return filtered(x, rate, response, pad=int(0.02 * rate))

    _each(s, _one(case), make)


@form("channel_delay", "measurement", DEVELOPMENT)
def lost_blocks(s, a, case, run):
    def make(x, rate, rng):
        losses = np.sort(rng.uniform(0.0, 0.6, 3)) * x.size
        lost = sum(np.arange(x.size) > at for at in losses)
        return _read_at(x, rate, 2e-3 * a * (0.3 + lost))

    _each(s, _one(case), make, int(run.integers(2**31)))


@form("channel_delay", "measurement", SEALED)
def breathing_clock(s, a, case, run):
    often = case.uniform(1.0, 12.0)

    def make(x, rate, rng):
        t = np.arange(x.size) / rate
        return _read_at(x, rate, 3e-3 * a * (0.7 + 0.4 * np.sin(2 * np.pi * often * t)))

    _each(s, _one(case), make)


@form("channel_delay", "measurement", SEALED)
def long_cable_of_lags(s, a, case, run):
    tau = 2.5e-4 * a

    def make(x, rate, rng):
        def response(f):
            return np.exp(-2j * np.pi * f * 3.0 * tau / np.sqrt(1.0 + (f / 3e3) ** 2))

        return filtered(x, rate, response, pad=int(0.02 * rate))

    _each(s, _one(case), make)
