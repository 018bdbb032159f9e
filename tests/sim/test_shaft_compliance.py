"""The shaft's end on a torsional spring."""

import math

import numpy as np
import pytest

from models.rig_file import load_material_rig
from sim.contact import (
    N_CONTACT,
    N_CONTEXT,
    SHAFT_INERTIA,
    SHAFT_LAG,
    SHAFT_LAG_RATE,
    SHAFT_TORQUE,
)
from sim.effects import EFFECTS
from tests.helpers.contact_calls import call_hook
from tests.helpers.contacts import contact_of, hook, solve_contact

TRUE_STICK = load_material_rig("fluorocarbon-thesis")
EFFECT = EFFECTS["shaft_compliance"]
RATE = 90e3


def solve(*hooks, stiffness=3745.0, samples=3000):
    torques, options = contact_of(TRUE_STICK, 0.279e-3, stiffness)
    return solve_contact(*torques, np.ones(samples), 1.0 / RATE, hooks=hooks, **options)


def shaft_torque(effect, lag, rate):
    context, contact = np.zeros(N_CONTEXT), np.zeros(N_CONTACT)
    context[SHAFT_LAG], context[SHAFT_LAG_RATE] = lag, rate
    call_hook(effect.function, context, effect.values, np.zeros(0), np.zeros(0), contact)
    return contact[SHAFT_TORQUE], contact[SHAFT_INERTIA]


def test_the_default_shaft_has_the_mode_of_table_3_1():
    torque, inertia = shaft_torque(hook("shaft_compliance"), 1e-3, 0.0)
    assert math.sqrt(torque / 1e-3 / inertia) / (2.0 * math.pi) == pytest.approx(1568.0, rel=2e-3)


def test_spring_and_damper_have_the_forms_they_are_named_for():
    kappa = EFFECT.parameters["compliance"].default
    reference = kappa * EFFECT.parameters["reference_torque"].default
    linear, stiffening, quadratic = (hook("shaft_compliance", form=form) for form in EFFECT.forms)
    for lag in (0.5 * reference, -reference, 2.0 * reference):
        plain = shaft_torque(linear, lag, 0.0)[0]
        assert plain == pytest.approx(lag / kappa)
        assert shaft_torque(quadratic, lag, 0.0)[0] == pytest.approx(plain)
        expected = plain * (1.0 + (lag / reference) ** 2)
        assert shaft_torque(stiffening, lag, 0.0)[0] == pytest.approx(expected)
    # Over a cycle that swings the torque by its reference both dampers dissipate the same.
    omega = 2.0 * math.pi * 1568.0
    rate = omega * reference * np.cos(2.0 * np.pi * np.arange(1000) / 1000)
    lost = [np.mean([shaft_torque(h, 0.0, r)[0] * r for r in rate]) for h in (linear, quadratic)]
    assert lost[0] > 0.0
    assert lost[1] == pytest.approx(lost[0], rel=5e-3)


def test_what_the_drive_gives_is_stored_or_dissipated():
    kappa = 1e-3
    effect = hook("shaft_compliance", compliance=kappa)
    states, _ = solve(effect, samples=18000)
    friction, end = states[:, 0], states[:, 6]
    lag = np.zeros_like(end)
    np.cumsum(0.5 * (2.0 - end[1:] - end[:-1]) / RATE, out=lag[1:])
    pairs = zip(lag, 1.0 - end, strict=True)
    torque, inertia = np.array([shaft_torque(effect, a, v) for a, v in pairs]).T
    given = np.sum(torque - friction * end) / RATE
    stored = 0.5 * lag[-1] ** 2 / kappa + 0.5 * inertia[0] * (end[-1] ** 2 - end[0] ** 2)
    damped = np.sum((torque - lag / kappa) * (1.0 - end)) / RATE
    assert damped > 0.0
    assert given - stored == pytest.approx(damped, rel=0.05)
