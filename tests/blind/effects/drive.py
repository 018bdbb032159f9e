"""The drive: a shaft that turns unevenly, a shaft that gives."""

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
