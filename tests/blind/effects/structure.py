"""From torque to sound: other clamp, beams, plate and room than measured, blows at each slip.

The responses that a case hands out are of the structure without these.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import fftconvolve

from .. import kernel
from ..structure import accelerance, filtered
from .form import DEVELOPMENT, SEALED, form, noise_in_band

_SOUND = 2e-3
"""Pascal per m/s2 of what is added to the acceleration."""


def _added(s, response):
    """Add a path from torque to acceleration, heard as well."""

    def change(signals, turned):
        more = filtered(turned.states[:, kernel.TORQUE], turned.rate, response)
        signals["acceleration"] = signals["acceleration"] + more
        signals["pressure"] = signals["pressure"] + _SOUND * more

    s.structure.append(change)


@form("beam_modes", "structure", DEVELOPMENT)
def waves_in_a_rod(s, a, case, run):
    late, back = case.uniform(2e-4, 6e-4), case.uniform(0.6, 0.85)

    def response(f):
        turn = back * np.exp(-2j * np.pi * f * late) / (1.0 + 1j * f / 6e3)
        high = 1j * f / (1j * f + 400.0)
        return 150.0 * a * high**2 * turn / (1.0 - turn)

    _added(s, response)


@form("beam_modes", "structure", DEVELOPMENT)
def cluster(s, a, case, run):
    f = case.uniform(500.0, 4000.0) * case.uniform(0.85, 1.18, 9)
    zeta, gain = case.uniform(0.004, 0.02, 9), 12.0 * a * case.standard_normal(9)
    _added(s, lambda x: accelerance(x, f, zeta, gain))


@form("beam_modes", "structure", SEALED)
def hysteretic_series(s, a, case, run):
    f = case.uniform(450.0, 1500.0) * np.arange(1, 6) ** 1.6
    gain, loss = 25.0 * a * case.uniform(0.4, 1.0, 5) * case.choice([-1.0, 1.0], 5), 0.03

    def response(x):
        x2 = (x[:, None] / f) ** 2
        return (-gain * x2 / (1.0 + 1j * loss * np.sign(x[:, None]) - x2)).sum(axis=1)

    _added(s, response)


@form("beam_modes", "structure", SEALED)
def dispersive_flange(s, a, case, run):
    corner, back = case.uniform(150.0, 400.0), case.uniform(0.6, 0.8)

    def response(f):
        turn = back * np.exp(-2j * np.pi * np.sqrt(f / corner)) / (1.0 + 1j * f / 8e3)
        return 200.0 * a * (1j * f / (1j * f + 600.0)) ** 2 * turn / (1.0 - turn)

    _added(s, response)


def _blows(s, a, case, run, shape, law):
    """At each slip a blow of some shape, which rings in acceleration and pressure."""
    f = case.uniform(2500.0, 12e3, 6)
    zeta, gain = case.uniform(0.01, 0.04, 6), case.uniform(0.5, 1.5, 6) * case.choice([-1, 1], 6)
    air = gain * case.uniform(0.5, 1.5, 6)
    seed = int(run.integers(2**31))

    def change(signals, turned):
        rng = np.random.default_rng(seed)
        train = np.zeros(turned.states.shape[0])
        for time, drop in turned.slips:
            pulse = law(drop, rng) * shape(rng, turned.rate)
            at = int(time * turned.rate)
            end = min(at + pulse.size, train.size)
            train[at:end] += pulse[: end - at]
        struck = filtered(train, turned.rate, lambda x: accelerance(x, f, zeta, gain))
        heard = filtered(train, turned.rate, lambda x: accelerance(x, f, zeta, air))
        signals["acceleration"] = signals["acceleration"] + 120.0 * a * struck
        signals["pressure"] = signals["pressure"] + 0.6 * a * heard

    s.structure.append(change)


@form("slip_pulse", "structure", DEVELOPMENT)
def dying_push(s, a, case, run):
    length = case.uniform(2e-5, 6e-5)

    def shape(rng, rate):
        return np.exp(-np.arange(int(6.0 * length * rate) + 1) / (length * rate))

    _blows(s, a, case, run, shape, lambda drop, _rng: drop / 2.7)


@form("slip_pulse", "structure", DEVELOPMENT)
def bouncing_blow(s, a, case, run):
    apart = case.uniform(3e-4, 1.2e-3)

    def shape(rng, rate):
        pulse = np.zeros(int(2.5 * apart * rate) + 4)
        pulse[0] = 2.0
        pulse[int(apart * rng.uniform(0.8, 1.2) * rate)] = 1.2
        pulse[int(1.7 * apart * rng.uniform(0.9, 1.1) * rate)] = 0.6
        return pulse

    _blows(s, a, case, run, shape, lambda _drop, _rng: 1.0)


@form("slip_pulse", "structure", SEALED)
def crunch(s, a, case, run):
    length = case.uniform(3e-4, 1e-3)

    def shape(rng, rate):
        n = int(4.0 * length * rate) + 1
        return rng.standard_normal(n) * np.exp(-np.arange(n) / (length * rate))

    _blows(s, a, case, run, shape, lambda drop, _rng: 0.5 * (drop / 2.7) ** 1.5)


@form("slip_pulse", "structure", SEALED)
def doublet_of_chance(s, a, case, run):
    length, spread = case.uniform(3e-5, 8e-5), case.uniform(0.2, 0.5)

    def shape(rng, rate):
        t = np.arange(-4.0 * length, 4.0 * length, 1.0 / rate) / length
        return -2.0 * t * np.exp(-t * t)

    _blows(s, a, case, run, shape,
           lambda _drop, rng: 1.3 * np.exp(spread * rng.standard_normal()))  # fmt: skip


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
