"""The contact: how it creeps, ages, scatters, weakens, wears in and warms. All by tables."""

from __future__ import annotations

import numpy as np

from .. import kernel
from .form import DEVELOPMENT, SEALED, form, noise_in_band

_SLIDING = np.linspace(0.0, kernel.LARGEST_SLIDING, kernel.POINTS)
_RATIO = np.linspace(0.0, 1.0, kernel.POINTS)
_AGE = kernel.LOWEST_AGE * 10.0 ** (kernel.AGE_DECADES * _RATIO)
_SLID = kernel.LARGEST_FILM_ANGLE * _RATIO
_HEAT = kernel.LARGEST_HEAT * _RATIO
_STICKS = 4096


@form("partial_slip", "friction", DEVELOPMENT)
def bristles_of_uniform_strength(s, a, case, run):
    weakest = case.uniform(0.15, 0.45)
    s.creep = 0.9 * a * np.clip((_RATIO - weakest) / (1.0 - weakest), 0.0, 1.0)


@form("partial_slip", "friction", DEVELOPMENT)
def rational_creep(s, a, case, run):
    s.creep = 0.9 * a * _RATIO**2 / (_RATIO**2 + case.uniform(2.0, 6.0) * (1.0 - _RATIO))


@form("partial_slip", "friction", SEALED)
def weibull_bristles(s, a, case, run):
    strengths = np.sort(case.weibull(case.uniform(2.0, 4.0), 40))
    strengths *= 1.0 / strengths[-1]
    steps = np.searchsorted(strengths, _RATIO) / strengths.size
    s.creep = 0.9 * a * np.convolve(np.pad(steps, 8, mode="edge"), np.ones(17) / 17, "valid")


@form("partial_slip", "friction", SEALED)
def logarithmic_creep(s, a, case, run):
    c = case.uniform(0.9, 0.99)
    s.creep = 0.9 * a * np.log1p(-c * _RATIO) / np.log1p(-c)


@form("velocity_weakening", "friction", DEVELOPMENT)
def inverse_root(s, a, case, run):
    s.weakening *= 1.0 - 0.5 * a * (1.0 - 1.0 / np.sqrt(1.0 + _SLIDING / case.uniform(2.0, 8.0)))


@form("velocity_weakening", "friction", DEVELOPMENT)
def two_plateaus(s, a, case, run):
    middle, width = case.uniform(4.0, 9.0), case.uniform(3.0, 8.0)
    x = np.clip((_SLIDING - middle) / width + 0.5, 0.0, 1.0)
    s.weakening *= 1.0 - 0.35 * a * (x * x * (3.0 - 2.0 * x) + 0.2 * _SLIDING / 60.0)


@form("velocity_weakening", "friction", SEALED)
def arctangent(s, a, case, run):
    x = _SLIDING / case.uniform(2.5, 10.0)
    s.weakening *= 1.0 - 0.4 * a * 2.0 / np.pi * np.arctan(x)


@form("velocity_weakening", "friction", SEALED)
def table_of_a_tribometer(s, a, case, run):
    knots = np.array([0.0, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0])
    fall = np.concatenate([[0.0], np.cumsum(case.dirichlet(np.full(knots.size - 1, 2.0)))])
    s.weakening *= 1.0 - 0.4 * a * np.interp(_SLIDING, knots, fall)


@form("velocity_strengthening", "friction", DEVELOPMENT)
def root_of_speed(s, a, case, run):
    v = case.uniform(1.5, 4.0)
    s.weakening *= 1.0 + 0.5 * a * (np.sqrt(1.0 + _SLIDING / v) - 1.0) / (np.sqrt(1 + 10 / v) - 1)


@form("velocity_strengthening", "friction", DEVELOPMENT)
def hyperbolic_sine_of_eyring(s, a, case, run):
    v = case.uniform(1.0, 3.0)
    s.weakening *= 1.0 + 0.5 * a * np.arcsinh(_SLIDING / v) / np.arcsinh(10.0 / v)


@form("velocity_strengthening", "friction", SEALED)
def lubricated_power(s, a, case, run):
    m = case.uniform(0.55, 0.85)
    s.weakening *= 1.0 + 0.5 * a * ((1.0 + _SLIDING) ** m - 1.0) / (11.0**m - 1.0)


@form("velocity_strengthening", "friction", SEALED)
def from_a_threshold(s, a, case, run):
    start = case.uniform(0.5, 2.5)
    away = 0.5 * (_SLIDING - start + np.hypot(_SLIDING - start, 0.8))
    s.weakening *= 1.0 + 0.4 * a * (away - away[0]) / 10.0


def _aged(s, a, share):
    s.ageing = 1.0 - 0.95 * a * (1.0 - share)


@form("static_ageing", "friction", DEVELOPMENT)
def power_of_time(s, a, case, run):
    _aged(s, a, np.minimum((_AGE / case.uniform(6e-3, 30e-3)) ** case.uniform(0.2, 0.4), 1.0))


@form("static_ageing", "friction", DEVELOPMENT)
def hill(s, a, case, run):
    x = (_AGE / case.uniform(1e-3, 6e-3)) ** 2
    _aged(s, a, x / (1.0 + x))


@form("static_ageing", "friction", SEALED)
def per_decade(s, a, case, run):
    low, high = np.log(case.uniform(1e-5, 1e-4)), np.log(case.uniform(5e-3, 40e-3))
    _aged(s, a, np.clip((np.log(_AGE) - low) / (high - low), 0.0, 1.0))


@form("static_ageing", "friction", SEALED)
def stretched(s, a, case, run):
    _aged(s, a, 1.0 - np.exp(-((_AGE / case.uniform(1e-3, 8e-3)) ** case.uniform(0.4, 0.65))))


def _scattered(s, a, z):
    s.scatter = np.maximum(1.0 + 0.45 * a * z / z.std(), 0.05)


@form("critical_torque_scatter", "friction", DEVELOPMENT)
def correlated_laplace(s, a, case, run):
    rho, z = case.uniform(0.3, 0.7), run.laplace(size=_STICKS)
    for i in range(1, _STICKS):
        z[i] += rho * z[i - 1]
    _scattered(s, a, z)


@form("critical_torque_scatter", "friction", DEVELOPMENT)
def two_states(s, a, case, run):
    changes = run.random(_STICKS) < case.uniform(0.15, 0.4)
    _scattered(s, a, np.where(np.cumsum(changes) % 2 == 0, 1.0, -1.0))


@form("critical_torque_scatter", "friction", SEALED)
def heavy_tailed(s, a, case, run):
    _scattered(s, a, np.clip(run.standard_t(case.uniform(2.5, 4.0), _STICKS), -6.0, 6.0))


@form("critical_torque_scatter", "friction", SEALED)
def long_memory(s, a, case, run):
    z = noise_in_band(run, _STICKS, 1.0, 1e-3, 0.5, case.uniform(0.6, 1.1))
    _scattered(s, a, z**3 + 2.0 * z)


def _filmed(s, a, film, band, case, run):
    s.film = film
    s.p[kernel.FILM_GAIN] = case.uniform(0.5, 1.2) * a
    s.p[kernel.FILM_DROP] = case.uniform(0.5, 0.85) * a
    s.p[kernel.FILM_NOISE] = 0.06 * a
    s.film_noise = noise_in_band(run, s.n + 1, s.rate, *band, 0.5)


@form("transfer_film", "friction", DEVELOPMENT)
def cooperative_film(s, a, case, run):
    x = (_SLID / case.uniform(0.3, 1.2)) ** 2
    _filmed(s, a, x / (1.0 + x), (200.0, 1800.0), case, run)


@form("transfer_film", "friction", DEVELOPMENT)
def film_in_patches(s, a, case, run):
    places = np.sort(case.exponential(case.uniform(0.4, 1.2), 12))
    film = np.searchsorted(places, _SLID) / places.size
    _filmed(s, a, np.convolve(np.pad(film, 2, "edge"), np.ones(5) / 5, "valid"),
            (300.0, 1300.0), case, run)  # fmt: skip


@form("transfer_film", "friction", SEALED)
def root_of_distance(s, a, case, run):
    _filmed(s, a, np.minimum(np.sqrt(_SLID / case.uniform(1.0, 4.0)), 1.0),
            (250.0, 1200.0), case, run)  # fmt: skip


@form("transfer_film", "friction", SEALED)
def gompertz(s, a, case, run):
    film = np.exp(-4.0 * np.exp(-_SLID / case.uniform(0.2, 0.8)))
    _filmed(s, a, film, (150.0, 1600.0), case, run)


def _heated(s, resistances, times, table):
    s.heat = np.array([resistances, times]).T
    s.softening_by_heat = table


@form("frictional_heating", "friction", DEVELOPMENT)
def rational_softening(s, a, case, run):
    _heated(s, [0.4, 1.2], [0.02, case.uniform(0.2, 0.6)], 1.0 / (1.0 + 0.02 * a * _HEAT))


@form("frictional_heating", "friction", DEVELOPMENT)
def straight_to_a_floor(s, a, case, run):
    _heated(s, [0.3, 0.5, 1.0], [0.01, 0.08, case.uniform(0.3, 0.9)],
            np.maximum(1.0 - 0.012 * a * _HEAT, 1.0 - 0.6 * a))  # fmt: skip


@form("frictional_heating", "friction", SEALED)
def arrhenius(s, a, case, run):
    warm = 1.0 / 296.0 - 1.0 / (296.0 + _HEAT)
    _heated(s, [0.5, 1.3], [0.015, case.uniform(0.15, 0.7)], np.exp(-1800.0 * a * warm))


@form("frictional_heating", "friction", SEALED)
def through_a_transition(s, a, case, run):
    middle = case.uniform(15.0, 40.0)
    x = 1.0 / (1.0 + np.exp(-(_HEAT - middle) / 8.0))
    _heated(s, [0.2, 0.5, 1.2], [0.005, 0.05, case.uniform(0.2, 0.8)],
            1.0 - 0.5 * a * (x - x[0]))  # fmt: skip
