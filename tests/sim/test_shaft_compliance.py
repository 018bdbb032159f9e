"""The shaft's end on a torsional spring."""

import math

import numpy as np
import pytest

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
from tests.helpers.contacts import hook

EFFECT = EFFECTS["shaft_compliance"]


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
