"""The elastomer: stiffer when it is fast, softer when it is deformed far."""

from __future__ import annotations

import numpy as np

from .. import kernel
from .form import DEVELOPMENT, SEALED, form

_AMPLITUDE = np.linspace(0.0, kernel.LARGEST_AMPLITUDE, kernel.POINTS)


def _branches(s, stiffness, times, forces=0.0):
    s.branches = np.array(
        [stiffness, times, np.broadcast_to(forces, np.shape(times))], dtype=float
    ).T.copy()


@form("viscoelastic_stiffness", "friction", DEVELOPMENT)
def springpot_of_nine(s, a, case, run):
    times = np.geomspace(3e-5, 0.3, 9)
    weight = times ** -case.uniform(0.1, 0.3)
    _branches(s, 0.9 * a * s.p[kernel.K_E] * weight / weight.sum(), times)


@form("viscoelastic_stiffness", "friction", DEVELOPMENT)
def dashpot_of_second_degree(s, a, case, run):
    k = 0.6 * a * s.p[kernel.K_E]
    _branches(s, [k], [case.uniform(4e-4, 2e-3)], [0.0015 * k])


@form("viscoelastic_stiffness", "friction", SEALED)
def log_normal_spectrum(s, a, case, run):
    times = np.geomspace(4e-5, 0.05, 7)
    middle = np.log(case.uniform(3e-4, 2e-3))
    weight = np.exp(-0.5 * ((np.log(times) - middle) / 1.5) ** 2)
    _branches(s, 0.7 * a * s.p[kernel.K_E] * weight / weight.sum(), times)


@form("viscoelastic_stiffness", "friction", SEALED)
def yielding_and_plain_dashpots(s, a, case, run):
    k = 0.35 * a * s.p[kernel.K_E]
    _branches(s, [k, k], [case.uniform(2e-4, 6e-4), 3e-3], [0.001 * k, 0.0])


def _held(s, table, forget, follow):
    s.softening = table
    s.p[kernel.PEAK_RATE], s.p[kernel.MEAN_RATE] = forget, follow


@form("amplitude_softening", "friction", DEVELOPMENT)
def power_of_held_amplitude(s, a, case, run):
    g = 1.0 - (1.0 + _AMPLITUDE / case.uniform(5e-4, 2e-3)) ** -0.7
    _held(s, 1.0 - 0.6 * a * g, case.uniform(20.0, 60.0), 15.0)


@form("amplitude_softening", "friction", DEVELOPMENT)
def softer_then_harder(s, a, case, run):
    x = _AMPLITUDE / case.uniform(1e-3, 2.5e-3)
    _held(s, 1.0 - 0.5 * a * x * np.exp(1.0 - x) + 0.01 * a * np.minimum(x * x, 30.0), 40.0, 20.0)


@form("amplitude_softening", "friction", SEALED)
def sliding_fillers(s, a, case, run):
    shares = case.dirichlet(np.full(5, 3.0))
    k = 0.5 * a * s.p[kernel.K_E] * shares
    s.p[kernel.K_E] *= 1.0 - 0.5 * a
    s.friction = np.array([k, k * np.geomspace(3e-4, 6e-3, 5)]).T.copy()


@form("amplitude_softening", "friction", SEALED)
def logarithm_of_held_amplitude(s, a, case, run):
    g = np.minimum(np.log1p(_AMPLITUDE / case.uniform(2e-4, 8e-4)) / np.log(21.0), 1.0)
    _held(s, 1.0 - 0.55 * a * g, case.uniform(60.0, 200.0), 25.0)
