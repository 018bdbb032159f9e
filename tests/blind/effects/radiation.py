"""Plate and room: other ways from the structure to the microphone."""

from __future__ import annotations

import numpy as np
from scipy.signal import fftconvolve

from ..structure import accelerance, filtered
from .form import DEVELOPMENT, SEALED, form, noise_in_band


def _through(s, response):
    def change(signals, turned):
        signals["pressure"] = filtered(signals["pressure"], turned.rate, response)

    s.radiation.append(change)


@form("plate_modes", "radiation", DEVELOPMENT)
def coincidence(s, a, case, run):
    f0, zeta = case.uniform(900.0, 4000.0), case.uniform(0.08, 0.2)

    def response(f):
        x = f / f0
        return 1.0 + 2.5 * a * 2.0 * zeta * x * x / (1.0 - x * x + 2j * zeta * x)

    _through(s, response)


@form("plate_modes", "radiation", DEVELOPMENT)
def absorbing_panels(s, a, case, run):
    f0, zeta = case.uniform(250.0, 3000.0, 4), case.uniform(0.03, 0.1, 4)

    def response(f):
        x = f[:, None] / f0
        return np.prod(1.0 - 0.95 * a * 2j * zeta * x / (1.0 - x * x + 2j * zeta * x), axis=1)

    _through(s, response)


@form("plate_modes", "radiation", SEALED)
def bending_waves_in_a_strip(s, a, case, run):
    corner, back = case.uniform(60.0, 200.0), case.uniform(0.5, 0.8)

    def response(f):
        turn = back * np.exp(-2j * np.pi * np.sqrt(f / corner)) / (1.0 + 1j * f / 7e3)
        return 1.0 + 1.2 * a * turn / (1.0 - turn)

    _through(s, response)


@form("plate_modes", "radiation", SEALED)
def guard_that_sings(s, a, case, run):
    f0, zeta = case.uniform(300.0, 3500.0, 5), case.uniform(0.006, 0.03, 5)
    gain = 1.5e-3 * a * case.standard_normal(5)

    def change(signals, turned):
        more = filtered(signals["acceleration"], turned.rate,
                        lambda x: accelerance(x, f0, zeta, gain))  # fmt: skip
        signals["pressure"] = signals["pressure"] + more

    s.radiation.append(change)


@form("room_reflections", "radiation", DEVELOPMENT)
def flutter_between_walls(s, a, case, run):
    late, back = case.uniform(4e-3, 15e-3), case.uniform(0.6, 0.85)

    def response(f):
        turn = back * np.exp(-2j * np.pi * f * late) / (1.0 + 1j * f / 5e3)
        return 1.0 + 1.0 * a * turn / (1.0 - turn)

    _through(s, response)


def _tail(s, a, case, decay, shape):
    seed = int(case.integers(2**31))

    def change(signals, turned):
        rng = np.random.default_rng(seed)
        t = np.arange(int(0.25 * turned.rate)) / turned.rate
        taps = shape(rng, t, turned.rate) * decay(t)
        taps *= 1.5 * a / np.sqrt(np.sum(taps**2))
        dry = signals["pressure"]
        signals["pressure"] = dry + fftconvolve(dry, taps)[: dry.size]

    s.radiation.append(change)


@form("room_reflections", "radiation", DEVELOPMENT)
def sparse_tail(s, a, case, run):
    first, time = case.uniform(2e-3, 6e-3), case.uniform(0.02, 0.08)

    def shape(rng, t, rate):
        hits = rng.random(t.size) < 1200.0 / rate
        return np.where(hits & (t > first), rng.choice([-1.0, 1.0], t.size), 0.0)

    _tail(s, a, case, lambda t: np.exp(-t / time), shape)


@form("room_reflections", "radiation", SEALED)
def double_slope(s, a, case, run):
    short, long = case.uniform(8e-3, 0.02), case.uniform(0.06, 0.15)

    def shape(rng, t, rate):
        return noise_in_band(rng, t.size, rate, 100.0, 6e3, 0.7) * (t > 3e-3)

    _tail(s, a, case, lambda t: np.exp(-t / short) + 0.15 * np.exp(-t / long), shape)


@form("room_reflections", "radiation", SEALED)
def four_coupled_delays(s, a, case, run):
    late = case.uniform(3e-3, 14e-3, 4)
    back = 0.42 * np.array([[1, 1, 1, 1], [1, -1, 1, -1], [1, 1, -1, -1], [1, -1, -1, 1.0]])

    def response(f):
        wait = np.exp(-2j * np.pi * f[:, None] * late) / (1.0 + 1j * f[:, None] / 6e3)
        total = seen = wait
        for _ in range(9):
            seen = (seen @ back.T) * wait
            total = total + seen
        return 1.0 + 0.7 * a * total.sum(axis=1)

    _through(s, response)
