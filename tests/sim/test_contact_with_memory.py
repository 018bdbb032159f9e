"""The contact with memory in its limits, and its slips at the tightest fit."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.rig_file import load_material_rig
from sim.contact import CRITICAL, KINETIC, N_CONTACT, call_law
from sim.friction.contact_with_memory import LAW
from sim.parameters import resolve
from tests.helpers.rig_measures import slip_rates

T_CRIT, T_KIN = 12.0, 8.0
STEP = 2e-6
GIVEN = {"contact_stiffness_per_torque": 1500.0, "renewal_angle": 0.0,
         "renewal_angle_per_torque": 2e-5, "ageing_time": 3e-4, "weakening_share": 0.02,
         "weakening_exponent": 2.0}  # fmt: skip


def driven(speed, values=GIVEN, torques=(T_CRIT, T_KIN)):
    """Torque over time while the surfaces slide as told, and the law's state at the end."""
    coefficients = LAW.coefficients(resolve(LAW.name, LAW.parameters, values))
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC] = torques
    state = LAW.state()
    rates, middle, torque = np.zeros(state.size), np.zeros(state.size), []
    for v in speed:
        torque.append(call_law(LAW.torque, v, coefficients, contact, state, rates))
        call_law(LAW.torque, v, coefficients, contact, state + 0.5 * STEP * rates, middle)
        state = state + STEP * middle
    return np.array(torque), state


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("speed", [0.5, 5.0, -5.0, 20.0])
def test_steady_sliding_gives_the_strength_at_the_age_that_sliding_leaves(speed, factor):
    critical, kinetic = factor * T_CRIT, factor * T_KIN
    angle = GIVEN["renewal_angle_per_torque"] * kinetic
    n = round(max(25.0 * angle, 12.0 / 1500.0) / abs(speed) / STEP)
    torque, state = driven(np.full(n, speed), torques=(critical, kinetic))
    age = angle / abs(speed)
    fade = 0.02 * kinetic * math.exp(-((speed / 20.0) ** 2))
    expected = kinetic + (critical - kinetic) * age / (age + 3e-4) + fade
    assert state[1] == pytest.approx(age, rel=1e-4)
    assert torque[-1] == pytest.approx(math.copysign(expected, speed), rel=1e-3)


def test_a_way_of_renewal_without_load_is_the_same_at_all_torques():
    values = GIVEN | {"renewal_angle": 2e-4, "renewal_angle_per_torque": 0.0}
    speed = 3.0 * np.sin(np.linspace(0.0, 20.0, 3000)) + 1.0
    once, _ = driven(speed, values)
    thrice, _ = driven(speed, values, torques=(3.0 * T_CRIT, 3.0 * T_KIN))
    assert thrice == pytest.approx(3.0 * once, rel=1e-9)


def test_both_ways_of_renewal_add_up():
    speed = np.full(4000, 4.0)
    split = GIVEN | {"renewal_angle": 8e-5, "renewal_angle_per_torque": 1e-5}
    assert driven(speed, split)[0] == pytest.approx(driven(speed)[0], rel=1e-9)


@settings(max_examples=20)
@given(
    speed=st.floats(0.01, 30.0), load=st.floats(2e-6, 1e-3), ageing=st.floats(1e-5, 1e-1),
    direction=st.sampled_from([-1.0, 1.0]),
)  # fmt: skip
def test_sliding_one_way_never_gives_energy_back(speed, load, ageing, direction):
    values = GIVEN | {"renewal_angle_per_torque": load, "ageing_time": ageing}
    torque, _ = driven(np.full(400, direction * speed), values)
    assert np.min(torque * direction) >= 0.0


def test_slips_at_the_tightest_fit_become_more_frequent_slowly_and_never_pass_the_torsional_mode():
    rates = slip_rates(load_material_rig("fluorocarbon"))
    assert all(rise > 0.0 for rise in (b - a for a, b in pairwise(rates)))
    assert rates[1] / rates[-1] > 0.7  # a constant drop of the torque makes it about a quarter
    assert max(rates) < 257.0
