"""A stabilizer bar in two bushings: its limits, balance of energy, loads and recordings."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad, solve_ivp

from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from models.suspension import SHIPPED, load_suspension
from sim.acquisition import Acquisition
from sim.bushing import lumped_bushing
from sim.contact import CRITICAL, KINETIC, N_CONTACT
from sim.friction import friction_law
from sim.motion import simulate_motion
from sim.parameters import resolve
from sim.plan import Plan
from sim.shaft import ConstantSpeed, Oscillation
from sim.suspension import (
    TorsionChain,
    run_suspension,
    solve_chain,
    torque_gain,
    torsion_chain,
)
from tests.helpers.contact_calls import call_law

CAR = load_suspension(SHIPPED)
AT = {"interference": 0.279e-3, "support_stiffness": 2214.0}
ROAD = Oscillation(math.radians(6.0), 2.0)


def rigid(n=2):
    """A bar that keeps its speed, with bushings that nothing loads."""
    none, one = np.zeros(n), np.ones(n)
    return TorsionChain(
        inertia=np.full(n, math.inf), stiffness=none[1:], damping=none[1:], link_stiffness=none,
        link_damping=none, travel=none, start=one, bushings=np.arange(n), load=np.zeros((n, n)),
    )  # fmt: skip


def solved(chain, rig, speed, preload=1000.0, support=2214.0):
    plan = Plan(rig, ROAD, 0.279e-3, support, (), 30e3, 0, speed.size)
    return solve_chain(chain, plan, speed, preload, np.random.default_rng(0), tolerance=1e-11)


@pytest.mark.parametrize(("material", "support"), [("fluorocarbon", math.inf), ("PDMS", 2214.0)])
def test_a_bushing_on_a_rigid_bar_is_the_rig(material, support):
    rig, n = load_material_rig(material), 3000
    chain = solved(rigid(), rig, np.full(n, 2.5), support=support)
    known = simulate_motion(
        rig, ConstantSpeed(2.5), interference=0.279e-3, support_stiffness=support, seconds=0.1,
        rate=30e3, effects=(), tolerance=1e-11,
    )  # fmt: skip
    own = chain.bushings[0]
    for name in ("torque", "friction_torque", "interface_angle", "clamp_speed", "shaft_angle"):
        scale = np.abs(getattr(known, name)).max()
        assert getattr(own, name) == pytest.approx(getattr(known, name), abs=1e-5 * scale), name


def test_an_integrator_of_its_own_finds_the_same_motion():
    """The whole chain written down again as one state, at a load that lifts the bar off."""
    n, rate, pressed, turns = 200, 30e3, 150.0, 8.0
    chain = torsion_chain(replace(CAR, wheels="left"))
    speed = np.full(n, turns)
    made = solved(chain, CAR.rig, speed, pressed)
    law = friction_law(CAR.rig.friction.name)
    values = resolve("law", law.parameters, CAR.rig.friction.parameters)
    coefficients, fit = law.coefficients(values), CAR.rig.fit(0.279e-3)
    bushing, size = lumped_bushing(CAR.rig, 0.279e-3, 2214.0), chain.inertia.size
    each = 4 + law.state().size

    def rates(t, state):
        angle, turning, *parts = np.split(state, [size, 2 * size, 2 * size + each])
        link = chain.link_stiffness * (chain.travel * turns * t - angle)
        link += chain.link_damping * (chain.travel * turns - turning)
        springs = chain.stiffness * np.diff(angle) + chain.damping * np.diff(turning)
        torque = link + np.append(springs, 0.0) - np.append(0.0, springs)
        found = []
        for node, load, part in zip(chain.bushings, chain.load @ link, parts, strict=True):
            gain, inner = torque_gain(load / pressed), np.zeros(each - 4)
            contact = np.zeros(N_CONTACT)
            contact[CRITICAL], contact[KINETIC] = (
                gain * fit.critical_torque, gain * fit.kinetic_torque,
            )  # fmt: skip
            sliding = turning[node] - part[1]
            friction = call_law(law.torque, sliding, coefficients, contact, part[4:].copy(), inner)
            elastic = bushing.elastomer_stiffness * (part[0] - part[2])
            elastic += bushing.elastomer_damping * (part[1] - part[3])
            back = bushing.support_stiffness * part[2] + bushing.support_damping * part[3]
            torque[node] -= friction
            found += [
                part[1], (friction - elastic) / bushing.elastomer_inertia,
                part[3], (elastic - back) / bushing.clamp_inertia, *inner,
            ]  # fmt: skip
        return np.concatenate([turning, torque / chain.inertia, found])

    rest = np.concatenate([np.zeros(4), law.state()])
    start = np.concatenate([np.zeros(size), turns * chain.start, rest, rest])
    times = np.arange(n) / rate
    known = solve_ivp(
        rates, (0.0, times[-1]), start, "DOP853", times, rtol=1e-9, atol=1e-12, max_step=2e-5
    ).y
    assert np.abs(made.load).max() > 2 * math.pi * pressed  # it lifts off, and slips
    assert np.abs(made.bushings[0].sliding_speed).max() > turns
    assert made.angle == pytest.approx(known[:size], abs=1e-6 * np.abs(known[:size]).max())
    for own, first in zip(made.bushings, (2 * size, 2 * size + each), strict=True):
        for name, row in (("interface_angle", 0), ("interface_speed", 1), ("clamp_angle", 2)):
            values = known[first + row]
            assert getattr(own, name) == pytest.approx(values, abs=1e-5 * np.abs(values).max())


@given(st.floats(0.2, 1.5), st.floats(0.1, 0.9), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_the_bushings_bear_what_the_links_pull(length, share, left, right):
    """Forces and moments about the bar's middle."""
    spacing = min(share * length, 0.89)
    chain = torsion_chain(replace(CAR, bar_length=length, spacing=spacing))
    loads = 0.25 * (chain.load[:, 0] * left + chain.load[:, -1] * right)
    assert loads.sum() == pytest.approx(left + right, abs=1e-9)
    moment = 0.5 * spacing * (loads[0] - loads[1])
    assert moment == pytest.approx(0.5 * length * (left - right), abs=1e-9)


@given(st.floats(math.pi * 1.001, 300.0))
def test_a_load_beyond_the_pressure_presses_what_touches_with_the_load_itself(load):
    """Where p0 (1 + rho cos) presses, its forces are the load, and the torque goes with its sum."""
    gain = torque_gain(load)
    assert torque_gain(0.999 * math.pi) == torque_gain(-1.0) == 1.0  # which the pressure carries

    def pressed(rho, weight):
        end = math.acos(max(-1.0 / rho, -1.0))
        return 2 * quad(lambda x: (1 + rho * math.cos(x)) * weight(x), 0.0, end)[0]

    # The rho that this gain belongs to.
    low, high = 1.0, load
    for _ in range(80):
        rho = 0.5 * (low + high)
        low, high = (rho, high) if pressed(rho, math.cos) < load else (low, rho)
    assert gain == pytest.approx(pressed(rho, lambda _: 1.0) / (2 * math.pi), rel=1e-6)
    assert gain > 1.0


def run_of(car=CAR, shaft=ROAD, seconds=0.1):
    quiet = Acquisition(30e3, noise={})
    return run_suspension(car, shaft, **AT, temperature=23.0, seconds=seconds, acquisition=quiet)


def test_a_recording_has_the_channels_of_both_bushings_and_one_microphone():
    recording = run_of()
    assert recording.samples.shape == (7, 3000)
    assert np.isfinite(recording.samples).all()
    assert recording["torque_2"].std() > 0.1 < recording["torque"].std()
    assert recording["acceleration_2"].std() > 0.0 < recording["pressure"].std()
    assert "left bushing" in recording.notes[0]


def test_what_cannot_be_simulated_is_named():
    coulomb = replace(CAR, rig=replace(CAR.rig, friction=LawSpec("coulomb")))
    with pytest.raises(ParameterError, match="constant torques"):
        run_of(coulomb)
    with pytest.raises(ParameterError, match=r"needs the contact pressure, hence a \[sleeve\]"):
        replace(CAR, rig=replace(CAR.rig, sleeve=None))
    with pytest.raises(ParameterError, match=r"twists the bar by .* degrees"):
        run_of(CAR, ConstantSpeed(5.0), 0.5)
    with pytest.raises(ParameterError, match="spacing = 1 m must be below"):
        replace(CAR, spacing=1.0)
