"""Drive and elastomer: a shaft that turns unevenly or gives; stiffer when fast, softer when far."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from .. import kernel
from .form import DEVELOPMENT, SEALED, form

_LARGEST_STIFFNESS = 4e5
_END_INERTIA = 5e-5


@form("speed_fluctuation", "drive", DEVELOPMENT)
def hunting_sawtooth(s, a, case, run):
    frequency, corner = case.uniform(4.0, 25.0), case.uniform(0.6, 0.9)
    turns = (frequency * s.time + run.random()) % 1.0
    saw = np.where(turns < corner, turns / corner, (1.0 - turns) / (1.0 - corner))
    s.omega *= 1.0 + 0.5 * a * (saw - 0.5)


@form("speed_fluctuation", "drive", DEVELOPMENT)
def belt_slips(s, a, case, run):
    rate, width = case.uniform(8.0, 20.0), case.uniform(0.01, 0.03)
    away = s.time[:, None] - run.uniform(0.0, s.time[-1], run.poisson(rate * s.time[-1]) + 1)
    inside = np.abs(away) < width
    dips = np.where(inside, 0.5 + 0.5 * np.cos(np.pi * away / width), 0.0).sum(axis=1)
    s.omega *= 1.0 - 0.45 * a * np.minimum(dips, 1.5)


@form("speed_fluctuation", "drive", SEALED)
def beating_pair(s, a, case, run):
    first, apart = case.uniform(6.0, 40.0), case.uniform(1.05, 1.3)
    phases = run.uniform(0.0, 2.0 * np.pi, 2)
    pair = np.sin(2 * np.pi * first * s.time + phases[0])
    pair += np.sin(2 * np.pi * first * apart * s.time + phases[1])
    s.omega *= 1.0 + 0.12 * a * pair


@form("speed_fluctuation", "drive", SEALED)
def lightly_damped_controller(s, a, case, run):
    turn = 2.0 * np.pi * case.uniform(8.0, 45.0) / s.rate
    keep = np.exp(-0.12 * turn)
    filtered = lfilter(
        [1.0], [1.0, -2.0 * keep * np.cos(turn), keep * keep], run.standard_normal(s.n + 1)
    )
    s.omega *= 1.0 + 0.12 * a * np.clip(filtered / filtered.std(), -3.0, 3.0)


def _compliant(s, a, stiffness):
    s.p[kernel.SHAFT_K] = min(stiffness / a, _LARGEST_STIFFNESS)
    s.p[kernel.SHAFT_J] = _END_INERTIA
    s.p[kernel.SHAFT_C] = 0.02 * np.sqrt(s.p[kernel.SHAFT_K] * _END_INERTIA)


@form("shaft_compliance", "drive", DEVELOPMENT)
def softening_shaft(s, a, case, run):
    _compliant(s, a, 1200.0)
    s.p[kernel.SHAFT_CUBIC] = case.uniform(0.1, 0.4) / s.p[kernel.T_KIN] ** 2


@form("shaft_compliance", "drive", DEVELOPMENT)
def dry_spline(s, a, case, run):
    _compliant(s, a, 1500.0)
    s.p[kernel.SHAFT_DRY] = case.uniform(0.02, 0.06) * s.p[kernel.T_KIN]


@form("shaft_compliance", "drive", SEALED)
def heavy_softening_coupling(s, a, case, run):
    _compliant(s, a, 1000.0)
    s.p[kernel.SHAFT_J] *= case.uniform(1.5, 4.0)
    s.p[kernel.SHAFT_C] *= case.uniform(3.0, 8.0)
    s.p[kernel.SHAFT_CUBIC] = 0.2 / s.p[kernel.T_KIN] ** 2


@form("shaft_compliance", "drive", SEALED)
def light_rubbing_coupling(s, a, case, run):
    _compliant(s, a, 1300.0)
    s.p[kernel.SHAFT_J] *= case.uniform(0.4, 0.7)
    s.p[kernel.SHAFT_DRY] = case.uniform(0.05, 0.1) * s.p[kernel.T_KIN]
    s.p[kernel.SHAFT_C] *= 0.3


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
