"""Effects of the contact and the elastomer: limits, what they change, and that they compose."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.contact import (
    CREEP,
    CRITICAL,
    ELASTOMER_TORQUE,
    KINETIC,
    N_CONTACT,
    N_CONTEXT,
    SHAFT_SPEED,
    SLIDING_SPEED,
    STICK_TIME,
    STICKS,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
)
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.helpers.contact_calls import call_hook
from tests.helpers.contacts import hook

TRUE_STICK = load_material_rig("fluorocarbon-thesis")
MEMORY = load_material_rig("fluorocarbon")
RATE = 90e3


def motion(*specs, rig=TRUE_STICK, speed=1.0, stiffness=3745.0, seconds=0.5):
    return simulate_motion(
        rig,
        ConstantSpeed(speed),
        interference=0.279e-3,
        support_stiffness=stiffness,
        seconds=seconds,
        rate=RATE,
        effects=activated(tuple(LawSpec(name, given) for name, given in specs), EFFECTS),
    )


def touch(effect, state=None, *, critical=10.7, kinetic=8.0, stiffness=665.0, **context):
    """Contact and rates of the states that an effect makes of one instant."""
    index = {
        "time": TIME, "speed": SLIDING_SPEED, "stick_time": STICK_TIME, "sticks": STICKS,
        "twist": TWIST, "torque": TORQUE, "shaft_speed": SHAFT_SPEED,
    }  # fmt: skip
    now = np.zeros(N_CONTEXT)
    for name, value in context.items():
        now[index[name]] = value
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC], contact[STIFFNESS] = critical, kinetic, stiffness
    state = np.zeros(effect.n_states) if state is None else np.array(state, dtype=float)
    rates = np.zeros(effect.n_states)
    call_hook(effect.function, now, effect.values, state, rates, contact)
    return contact, rates


@pytest.mark.parametrize("form", EFFECTS["partial_slip"].forms)
def test_creep_grows_with_torque_and_ends_with_unloading(form):
    effect = hook("partial_slip", form=form, share=0.8)
    creep = [touch(effect, torque=t, shaft_speed=2.0)[0][CREEP] for t in (0.0, 3.0, 8.0, 10.7)]
    assert creep == sorted(creep)
    assert creep[0] == 0.0
    assert 0.7 < creep[-1] <= 0.8
    assert touch(effect, torque=8.0, shaft_speed=-2.0)[0][CREEP] == 0.0


@pytest.mark.parametrize("name", ["velocity_weakening", "velocity_strengthening"])
def test_steady_sliding_gives_the_torque_of_the_curve(name):
    sign = -1.0 if name == "velocity_weakening" else 1.0
    for form in EFFECTS[name].forms:
        effect = hook(name, form=form)
        at_rest, at_ten, fast = (
            touch(effect, speed=v)[0][KINETIC] / 8.0 for v in (0.0, -10.0, 40.0)
        )
        assert at_rest == 1.0
        assert 0.04 < sign * (at_ten - 1.0) <= 0.1 * (1.0 + 1e-12)
        assert sign * fast > sign * at_ten


@settings(max_examples=50)
@given(
    st.sampled_from(EFFECTS["static_ageing"].forms),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.floats(1e-6, 1.0),
)
def test_strength_grows_with_age_between_kinetic_and_critical(form, share, early, further):
    effect = hook("static_ageing", form=form, share=share)
    young, old = (
        touch(effect, stick_time=t, sticks=3.0, time=5.0)[0][CRITICAL]
        for t in (early, early + further)
    )
    assert 8.0 <= young <= old <= 10.7 + 1e-12
    assert touch(effect, sticks=3.0, time=5.0)[0][CRITICAL] == pytest.approx(10.7 - 2.7 * share)


@pytest.mark.parametrize("form", EFFECTS["critical_torque_scatter"].forms)
def test_scatter_has_the_spread_and_the_correlation_asked_for(form):
    effect = hook("critical_torque_scatter", form=form, scatter=0.2, correlation=0.8)
    torque = np.array(
        [touch(effect, sticks=i, time=9.0)[0][CRITICAL] for i in np.arange(1.0, 4000.0)]
    )
    assert torque.std() / 2.7 == pytest.approx(0.2, rel=0.15)
    assert torque.mean() == pytest.approx(10.7, abs=0.1)
    lag = np.corrcoef(torque[1:], torque[:-1])[0, 1]
    assert lag == pytest.approx(0.8 if form == "correlated" else 0.0, abs=0.06)


def test_the_surface_warms_as_appendix_g_has_it():
    effect = hook("frictional_heating", softening=1e-6)
    assert warmed(effect, 0.23) == pytest.approx(26.0, rel=0.02)
    assert warmed(effect, 0.92) == pytest.approx(52.0, rel=0.02)
    paint = hook("frictional_heating", form="two_layer", softening=1e-6)
    assert warmed(paint, 0.23) == pytest.approx(93.0, rel=0.08)


def warmed(effect, seconds, steps=4000):
    """Rise of the temperature at 30 Nm and 10 rad/s [K], by implicit Euler steps."""
    state = np.zeros(effect.n_states)
    _, source = touch(effect, state, kinetic=30.0, critical=30.0, speed=10.0)
    _, unit = touch(effect, np.ones(effect.n_states), kinetic=30.0, critical=30.0, speed=0.0)
    for _ in range(steps):
        state = (state + seconds / steps * source) / (1.0 - seconds / steps * unit)
    return state.sum()


@pytest.mark.parametrize("form", EFFECTS["viscoelastic_stiffness"].forms)
@pytest.mark.parametrize("frequency", [1.0, 300.0, 1e5])
def test_branches_stiffen_with_frequency_and_always_dissipate(form, frequency):
    effect = hook("viscoelastic_stiffness", form=form, stiffening=0.5)
    omega = 2.0 * math.pi * frequency
    time = np.arange(0.0, 1.0, 1.0 / 512.0)
    # The branches are linear: their steady response to twist exp(i omega t) from the hook's rates.
    n = effect.n_states
    _, forced = touch(effect, twist=1.0)
    _, relaxed = touch(effect, np.ones(n))
    state = forced / (1j * omega - relaxed)
    twist = np.exp(2j * np.pi * time)
    torque = [touch(effect, (state * z).real, twist=z.real)[0][ELASTOMER_TORQUE] for z in twist]
    modulus = 2.0 * np.mean(torque * twist.conj())
    assert modulus.imag > 0.0
    assert 0.0 < modulus.real < 0.5 * 665.0
    if frequency == 1.0:
        assert abs(modulus) < 0.02 * 665.0
    if frequency == 1e5:
        assert modulus.real > 0.45 * 665.0


@pytest.mark.parametrize("form", EFFECTS["amplitude_softening"].forms)
def test_a_static_twist_does_not_soften_and_torque_rises_with_every_departure(form):
    effect = hook("amplitude_softening", form=form, share=0.8)

    def torque(twist, mean):
        contact, _ = touch(effect, [mean], twist=twist)
        return contact[STIFFNESS] * twist + contact[ELASTOMER_TORQUE]

    assert torque(0.02, 0.02) == pytest.approx(665.0 * 0.02)
    departures = np.linspace(-0.05, 0.05, 2001)
    curve = np.array([torque(0.02 + d, 0.02) for d in departures])
    assert (np.diff(curve) > 0.0).all()
    assert curve[-1] - curve[1000] == pytest.approx(curve[1000] - curve[0])
    assert curve[-1] - curve[1000] < 0.4 * 665.0 * 0.05
