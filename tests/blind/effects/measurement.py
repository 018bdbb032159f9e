"""What sensors pick up besides: noise, hum, the resonance of their own mounts."""

from __future__ import annotations

import numpy as np
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
