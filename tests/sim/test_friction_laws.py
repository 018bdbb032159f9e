"""Friction laws in their limits, alone on a surface that moves as told and on the rig."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numba import float64, int64, njit

from models.rig_file import load_material_rig
from sim.contact import CRITICAL, KINETIC, N_CONTACT, address_of, call_law_at
from sim.friction import LAWS, friction_law
from sim.parameters import resolve
from tests.helpers.contacts import contact_of, solve_contact

RIG = load_material_rig("fluorocarbon-thesis")
VIOLENT = load_material_rig("fluorocarbon")  # its critical torque is twice the kinetic one
T_CRIT, T_KIN = 10.7, 8.0
STEP = 5e-6

STRIBECK = {
    "stribeck_exponential": lambda x: np.exp(-abs(x)),
    "stribeck_gaussian": lambda x: np.exp(-(x**2)),
    "stribeck_lorentzian": lambda x: 1.0 / (1.0 + x**2),
}
NAMES = tuple(name for name in LAWS if name not in {"coulomb", "lugre"})

_VECTOR = float64[::1]


@njit
def _torque(law, v, coefficients, contact, state, rates):
    return call_law_at(law, v, coefficients.ctypes, contact.ctypes, state.ctypes, rates.ctypes)


@njit(_VECTOR(int64, _VECTOR, _VECTOR, _VECTOR, _VECTOR, float64))
def _followed(law, coefficients, contact, state, speed, step):
    """Torque at each time while the surface slides at `speed`; `state` becomes the last."""
    torque = np.empty(speed.size)
    rates = np.zeros((4, state.size))
    for i in range(speed.size):
        v = speed[i]
        torque[i] = _torque(law, v, coefficients, contact, state, rates[0])
        _torque(law, v, coefficients, contact, state + 0.5 * step * rates[0], rates[1])
        _torque(law, v, coefficients, contact, state + 0.5 * step * rates[1], rates[2])
        _torque(law, v, coefficients, contact, state + step * rates[2], rates[3])
        state += step / 6.0 * (rates[0] + 2.0 * rates[1] + 2.0 * rates[2] + rates[3])
    return torque


def follow(name, speed, given=None, torques=(T_CRIT, T_KIN), step=STEP):
    """Torque over time, and the law's state at the end."""
    law = friction_law(name)
    coefficients = law.coefficients(resolve(name, law.parameters, given or {}))
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC] = torques
    state = law.state()
    speed = np.ascontiguousarray(speed, dtype=float)
    return _followed(address_of(law.torque), coefficients, contact, state, speed, step), state


def steady(name, speed, given=None, torques=(T_CRIT, T_KIN), angle=0.05):
    n = max(round(angle / abs(speed) / STEP), 20_000)
    return follow(name, np.full(n, speed), given, torques)[0][-1]


def on_the_rig(name, speed, given=None, *, seconds, step=STEP, refined=1, rig=RIG,
               interference=0.279e-3, stiffness=2214.0):  # fmt: skip
    torques, options = contact_of(rig, interference, stiffness, name, given or {})
    drive = np.full(round(seconds / step), float(speed))
    return solve_contact(*torques, drive, step, refined=refined, **options)[0]


def expected_torque(name, v, given):
    """What each law's steady torque is to be at v > 0, by its equations."""
    p = resolve(name, friction_law(name).parameters, given)
    drop = T_CRIT - T_KIN
    if name in STRIBECK:
        f, s = STRIBECK[name], p["second_share"]
        fade = (1.0 - s) * f(v / p["first_speed"]) + s * f(v / p["second_speed"])
        return T_KIN + drop * fade
    age = p["renewal_angle"] / v
    if name == "contact_with_memory":
        age += p["renewal_angle_per_torque"] * T_KIN / v
        fade = math.exp(-((v / p["weakening_speed"]) ** p["weakening_exponent"]))
        return T_KIN * (1.0 + p["weakening_share"] * fade) + drop * age / (age + p["ageing_time"])
    if name == "ageing":
        return T_KIN + drop * (1.0 - math.exp(-age / p["ageing_time"]))
    direct = p["direct_effect"] * math.log(1.0 + v / p["direct_speed"])
    return T_KIN * (1.0 + direct) + drop * age / (age + p["ageing_time"])


UNUSUAL = {
    "rate_and_state": {"direct_effect": 0.02, "ageing_time": 1e-3},
    "ageing": {"renewal_angle": 2e-3},
    "contact_with_memory": {"renewal_angle_per_torque": 2e-5, "weakening_share": 0.02},
} | {name: {"second_share": 0.4, "second_speed": 12.0} for name in STRIBECK}


@pytest.mark.parametrize("given", [{}, UNUSUAL], ids=["default", "unusual"])
@pytest.mark.parametrize("speed", [0.3, 2.0, 15.0])
@pytest.mark.parametrize("name", NAMES)
def test_steady_sliding_gives_the_torque_of_the_law(name, speed, given):
    values = given.get(name, {})
    expected = expected_torque(name, speed, values)
    assert steady(name, speed, values) == pytest.approx(expected, rel=1e-6)
    assert steady(name, -speed, values) == pytest.approx(-expected, rel=1e-6)


def within(parameter):
    if parameter.low > 0.0 and parameter.high / parameter.low > 20.0:
        logs = st.floats(math.log(parameter.low), math.log(parameter.high))
        return logs.map(lambda x: min(max(math.exp(x), parameter.low), parameter.high))
    return st.floats(parameter.low, parameter.high)


def any_values(name):
    declared = {key: within(value) for key, value in friction_law(name).parameters.items()}
    return st.fixed_dictionaries(declared)


# A memory's renewal can be faster than the steps of `follow`.
@pytest.mark.parametrize("name", [name for name in NAMES if name != "contact_with_memory"])
@settings(max_examples=15)
@given(data=st.data())
def test_sliding_one_way_never_gives_energy_back(name, data):
    values = data.draw(any_values(name))
    speed = data.draw(st.floats(0.01, 50.0)) * data.draw(st.sampled_from([-1.0, 1.0]))
    torque, _ = follow(name, np.full(4000, speed), values)
    assert np.min(torque * speed) >= 0.0


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=8)
@given(data=st.data())
def test_any_parameters_are_followed(name, data):
    values = data.draw(any_values(name))
    speed = data.draw(st.floats(0.25, 20.0))
    interference = data.draw(st.sampled_from([0.178e-3, 0.279e-3, 0.381e-3]))
    coarse, fine = (
        on_the_rig(
            name, speed, values, seconds=0.01, refined=n, rig=VIOLENT, interference=interference
        )
        for n in (1, 4)
    )
    assert np.abs(coarse[:, :2]).max() < 1.2 * np.abs(fine[:, :2]).max() + 0.1
