"""Sensors and converters: noise, hum, mounts that ring, what overloads, drifts, or comes late."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.signal import lfilter

from ..structure import filtered
from .form import DEVELOPMENT, SEALED, form, noise_in_band

_NOISE = {"torque": 0.15, "acceleration": 8.0, "pressure": 0.3}
_HUM = {"torque": 0.3, "acceleration": 6.0, "pressure": 0.25}


def _added(s, a, levels, case, run, make):
    """Add `make(rng, time, rate)` to the channels, each in a share of its own."""
    shares = {name: case.uniform(0.3, 1.0) for name in levels}
    seed = int(run.integers(2**31))

    def change(signals, turned):
        rng = np.random.default_rng(seed)
        for name, level in levels.items():
            t = np.arange(signals[name].size) / turned.rate
            signals[name] = signals[name] + a * level * shares[name] * make(rng, t, turned.rate)

    s.sensors.append(change)


@form("background_noise", "measurement", DEVELOPMENT)
def surging_band(s, a, case, run):
    low, beat = case.uniform(60.0, 600.0), case.uniform(2.0, 8.0)
    high = low * case.uniform(2.0, 8.0)

    def make(rng, t, rate):
        surge = 1.0 + 0.8 * np.sin(2 * np.pi * (beat * t + rng.random()))
        return surge * noise_in_band(rng, t.size, rate, low, high)

    _added(s, a, _NOISE, case, run, make)


@form("background_noise", "measurement", DEVELOPMENT)
def clicks(s, a, case, run):
    often, ring = case.uniform(20.0, 120.0), case.uniform(800.0, 5000.0)

    def make(rng, t, rate):
        train = (rng.random(t.size) < often / rate) * rng.standard_normal(t.size)
        turn, keep = 2 * np.pi * ring / rate, np.exp(-1500.0 / rate)
        return 12.0 * lfilter([1.0], [1.0, -2 * keep * np.cos(turn), keep**2], train) * turn

    _added(s, a, _NOISE, case, run, make)


@form("background_noise", "measurement", SEALED)
def three_humps(s, a, case, run):
    centres = case.uniform(100.0, 5000.0, 3)

    def make(rng, t, rate):
        parts = [noise_in_band(rng, t.size, rate, 0.8 * f, 1.25 * f) for f in centres]
        return np.sum(parts, axis=0) / np.sqrt(3.0) + 0.3 * rng.standard_normal(t.size)

    _added(s, a, _NOISE, case, run, make)


@form("background_noise", "measurement", SEALED)
def heavy_tailed_gusts(s, a, case, run):
    tilt = case.uniform(0.6, 1.6)

    def make(rng, t, rate):
        gust = np.exp(noise_in_band(rng, t.size, rate, 1.0, 15.0))
        return gust * noise_in_band(rng, t.size, rate, 30.0, 12e3, tilt) / 1.6

    _added(s, a, _NOISE, case, run, make)


def _mains(case):
    return float(case.choice([50.0, 60.0])) * (1.0 + 2e-3 * case.standard_normal())


@form("mains_hum", "measurement", DEVELOPMENT)
def dimmer(s, a, case, run):
    f, cut = _mains(case), case.uniform(0.15, 0.4)

    def make(rng, t, rate):
        turns = (f * t + rng.random()) % 1.0
        return np.where(turns % 0.5 > cut, np.sin(2 * np.pi * turns), 0.0) * 1.8

    _added(s, a, _HUM, case, run, make)


@form("mains_hum", "measurement", DEVELOPMENT)
def wandering_phase(s, a, case, run):
    f, fifth = _mains(case), case.uniform(0.2, 0.7)

    def make(rng, t, rate):
        phase = 2 * np.pi * f * t + np.cumsum(rng.standard_normal(t.size)) * np.sqrt(2.0 / rate)
        return 1.3 * (np.sin(phase) + fifth * np.sin(5 * phase + 1.0))

    _added(s, a, _HUM, case, run, make)


@form("mains_hum", "measurement", SEALED)
def two_machines(s, a, case, run):
    f, slip = _mains(case), case.uniform(0.96, 0.985)

    def make(rng, t, rate):
        phases = 2 * np.pi * rng.random(3)
        total = np.sin(2 * np.pi * f * t + phases[0]) + 0.8 * np.sin(2 * np.pi * f * slip * t)
        return total + 0.5 * np.sin(6 * np.pi * f * t + phases[1])

    _added(s, a, _HUM, case, run, make)


@form("mains_hum", "measurement", SEALED)
def modulated_comb(s, a, case, run):
    f, deep = _mains(case), case.uniform(0.3, 0.9)

    def make(rng, t, rate):
        phase = f * t + rng.random() + 0.03 * np.sin(2 * np.pi * (f / 9.0) * t)
        comb = 2.0 * (phase % 1.0) - 1.0
        return 1.7 * comb * (1.0 + deep * np.sin(2 * np.pi * 0.04 * f * t))

    _added(s, a, _HUM, case, run, make)


def _mounted(s, response, names=("acceleration",)):
    def change(signals, turned):
        for name in names:
            signals[name] = filtered(signals[name], turned.rate, response)

    s.sensors.append(change)


@form("mount_resonance", "measurement", DEVELOPMENT)
def mass_on_mass(s, a, case, run):
    f1, f2, share = case.uniform(1200.0, 4000.0), case.uniform(1.3, 1.8), case.uniform(0.4, 0.7)

    def response(f):
        x, y = f / f1, f / (f1 * f2)
        first = 1.0 / (1.0 - x * x + 0.06j * x)
        second = 1.0 / (1.0 - y * y + 0.08j * y)
        return 1.0 + a * (share * first + (1.0 - share) * second - 1.0)

    _mounted(s, response)


@form("mount_resonance", "measurement", DEVELOPMENT)
def wax_of_third_order(s, a, case, run):
    f1, lag = case.uniform(800.0, 3000.0), case.uniform(0.3, 0.9)

    def response(f):
        x = f / f1
        yields = (1.0 + 1j * x) / (1.0 + 1j * x * lag - x * x - 0.15j * x**3)
        return 1.0 + a * (yields - 1.0)

    _mounted(s, response)


@form("mount_resonance", "measurement", SEALED)
def loss_without_rate(s, a, case, run):
    f1, loss = case.uniform(900.0, 3500.0), case.uniform(0.05, 0.15)

    def response(f):
        x2 = (f / f1) ** 2
        stiffness = 1.0 + 1j * loss * np.sign(f)
        return 1.0 + a * (stiffness / (stiffness - x2) - 1.0)

    _mounted(s, response)


@form("mount_resonance", "measurement", SEALED)
def long_stinger(s, a, case, run):
    quarter, damping = 1.0 / (4.0 * case.uniform(1000.0, 3500.0)), case.uniform(0.04, 0.12)

    def response(f):
        standing = np.cos(2 * np.pi * f * quarter * (1.0 - 1j * damping))
        rolled = 1.0 / (1.0 + (f / (2.0 / quarter)) ** 2)
        return 1.0 + a * (rolled / standing - 1.0)

    _mounted(s, response)


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
