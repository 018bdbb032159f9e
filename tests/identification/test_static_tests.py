"""Static tests and ring-downs: what slow motion below any slip says, of both simulators."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.signal import lfilter

from models.condition import Condition
from models.errors import ParameterError
from models.rig import Fit, LawSpec
from models.rig_file import load_material_rig
from noise.cli import main
from noise.identification.bushing_fit import Known
from noise.identification.evidence import elastomer_stiffness, static_evidence
from noise.identification.measured import read_measurements
from noise.identification.static_test import find_ring_down, static_test
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed, LoggedSpeed, Oscillation
from tests.blind.identify.laws import LAWS, draw_law
from tests.blind.identify.static import (
    RATE,
    held,
    made_with,
    record_static,
    to_and_fro,
    write_static,
)

KNOWN = Known(1.0 / 65000.0, 1.0 / 1200.0, 0.02)
SUPPORT = 2214.0
EFFECTIVE = 1.0 / (1.0 / 665.0 + 1.0 / SUPPORT)
STICKING = ("constant", "stribeck", "ageing")


def our_own(rig, shaft, support, seconds=3.0, rate=8e3):
    motion = simulate_motion(
        rig, shaft, interference=0.279e-3, support_stiffness=support, seconds=seconds, rate=rate
    )
    return static_test(
        motion.torque, motion.shaft_angle, rate, Condition(None, 0.279e-3, support), "slow"
    )


def second(law, omega, seed=3, support=SUPPORT):
    made = made_with(draw_law(law, np.random.default_rng([seed, 7])), support)
    return record_static(made, 0.279, support, omega, 100 + seed).astype(float)


def slow_test(law, seed=3):
    torque, angle = second(law, to_and_fro(0.7 * 8.0 / EFFECTIVE, 1.0, 2.5), seed)
    return static_test(torque, angle, RATE, Condition(None, 0.279e-3, SUPPORT), law)


@settings(max_examples=6)
@given(
    stiffness=st.floats(300.0, 1200.0),
    support=st.sampled_from([2214.0, 3745.0, math.inf]),
    share=st.floats(0.2, 0.8),
)
def test_stiffness_of_our_own_rig_that_truly_sticks_is_the_slope(stiffness, support, share):
    base = load_material_rig("fluorocarbon-thesis")
    fit = Fit(0.279e-3, stiffness, 10.7, 8.0, {support: 0.09})
    rig = replace(base, fits=(fit,), friction=LawSpec("coulomb"))
    effective = 1.0 / (1.0 / stiffness + 1.0 / support)
    found = our_own(rig, Oscillation(share * 8.0 / effective, 1.0), support)
    assert found.elastic
    assert elastomer_stiffness(found.effective_stiffness, support)[0] == pytest.approx(
        stiffness, rel=0.01
    )


def test_the_shipped_rubbers_contact_is_told_from_its_elastomer():
    rig = load_material_rig("fluorocarbon")
    found = our_own(rig, Oscillation(0.7 * 8.0 / 665.0, 1.0), math.inf)
    contact = (
        rig.fit(0.279e-3).kinetic_torque * rig.friction.parameters["contact_stiffness_per_torque"]
    )
    assert not found.elastic
    assert found.effective_stiffness == pytest.approx(1 / (1 / 665.0 + 1 / contact), rel=0.01)
    assert found.held_stiffness == pytest.approx(665.0, rel=0.02)


@pytest.mark.parametrize("law", LAWS)
def test_stiffness_of_the_second_rig_is_found_whatever_its_law(law):
    found = slow_test(law)
    (said,) = static_evidence([found], KNOWN, sticks=law in STICKING)
    # the rig and the cell's gain scatter by 2 and 1 %
    assert said.value == pytest.approx(665.0, rel=0.06)


@pytest.mark.parametrize("law", ["constant", "memory", "bristle"])
def test_loading_and_unloading_part_where_the_contact_yields(law):
    assert slow_test(law).elastic == (law in STICKING)


@pytest.mark.parametrize("law", ["constant", "memory"])
def test_a_held_shaft_tells_damping_and_the_clamps_inertia(law):
    torque, angle = second(law, held(0.5 * 8.0 / EFFECTIVE, 1.0, 0.3))
    stop = static_test(torque, angle, RATE, Condition(None, 0.279e-3, SUPPORT), "held")
    said = {e.name: e.value for e in static_evidence([slow_test(law), stop], KNOWN)}
    assert said["damping"] == pytest.approx(0.1, rel=0.08)
    assert said["clamp_inertia"] == pytest.approx(1.0 / 1200.0, rel=0.03)


def test_noise_on_a_held_shaft_is_no_ring_down():
    rng = np.random.default_rng(1)
    angle = np.minimum(np.arange(8000) / RATE, 0.1) * 0.1
    assert find_ring_down(300.0 * angle + 0.005 * rng.standard_normal(8000), angle, RATE) is None


@pytest.mark.parametrize("speed", [0.3, 1.0, 5.0, 10.0])
@pytest.mark.parametrize("material", ["fluorocarbon", "fluorocarbon-thesis"])
def test_rotation_that_slips_is_no_static_test(material, speed):
    assert our_own(load_material_rig(material), ConstantSpeed(speed), SUPPORT, 0.5) is None


def test_swinging_that_slips_is_no_static_test():
    rig = load_material_rig("fluorocarbon-thesis")
    assert our_own(rig, Oscillation(0.1, 1.0), SUPPORT, 1.0) is None


@settings(max_examples=60)
@given(
    n=st.integers(1, 3000),
    seed=st.integers(0, 1000),
    shape=st.sampled_from(["noise", "steady", "steps", "still"]),
)
def test_torque_that_does_not_go_with_the_angle_is_no_static_test(n, seed, shape):
    rng = np.random.default_rng(seed)
    angle = {
        "noise": rng.standard_normal(n),
        "steady": np.linspace(0.0, 1.0, n),
        "steps": np.round(np.linspace(0.0, 3.0, n)),
        "still": np.zeros(n),
    }[shape]
    torque = rng.standard_normal(n)
    assert static_test(torque, angle, 1e4, Condition(None, 0.279e-3, SUPPORT), "x") is None


def test_a_slow_rise_alone_is_a_static_test():
    shaft = LoggedSpeed([0.0, 2.0], [4e-3, 4e-3])
    found = our_own(load_material_rig("fluorocarbon-thesis"), shaft, SUPPORT, 2.0)
    assert found.effective_stiffness == pytest.approx(EFFECTIVE, rel=0.01)
    assert found.branches == 1


def test_a_static_test_without_its_interference_is_named():
    angle = 5e-3 * np.sin(2 * np.pi * np.arange(4000) / 1000.0)
    with pytest.raises(ParameterError, match="states no interference_mm"):
        static_test(500.0 * angle, angle, 1000.0, Condition(None, None, SUPPORT), "slow")


@pytest.mark.parametrize(
    ("memory", "yields"),
    [
        (0.0, True),
        (0.97, False),
        *(
            pytest.param(*one, marks=pytest.mark.slow)
            for one in [(0.0, False), (0.9, False), (0.9, True), (0.97, True)]
        ),
    ],
)
def test_the_stated_error_is_the_scatter_of_tests_whose_noise_remembers(memory, yields):
    torque = 4.0 * np.sin(2 * np.pi * 2.5 * np.arange(4000) / 4000)
    step = np.diff(torque, prepend=torque[0])
    contact = np.cumsum(step / (2000.0 * (1.0 - np.sign(step) * torque / 6.0)))
    angle = torque / 500.0 + yields * contact
    found = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        noise = lfilter([math.sqrt(1.0 - memory**2)], [1.0, -memory], rng.standard_normal(6000))
        measured = angle + 4e-5 * noise[2000:]
        found.append(static_test(torque, measured, 1e3, Condition(None, 0.279e-3, SUPPORT), "x"))
    assert {one.elastic for one in found} == {not yields}
    for value, error in (("effective_stiffness", "error"), ("held_stiffness", "held_error")):
        values = np.array([getattr(one, value) for one in found])
        # without what every encoder errs by
        said = math.sqrt(np.median([getattr(one, error) for one in found]) ** 2 - 0.002**2)
        assert 1 / 1.5 < said / (values.std() / values.mean()) < 1.5


def test_static_tests_alone_give_a_rig(tmp_path):
    data = tmp_path / "data"
    data.mkdir()
    made = made_with(draw_law("memory", np.random.default_rng([3, 7])), SUPPORT)
    for i, omega in enumerate(
        (to_and_fro(0.7 * 8.0 / EFFECTIVE, 1.0, 2.0), held(0.5 * 8.0 / EFFECTIVE, 1.0, 0.3))
    ):
        samples = record_static(made, 0.279, SUPPORT, omega, 100 + i)
        write_static(data / f"static{i}.wav", samples, 0.279, SUPPORT)
    assert len(read_measurements([data]).static) == 2
    assert main(["identify", str(data), "--out", str(tmp_path / "mine")]) == 0
    found = json.loads((tmp_path / "mine" / "identification.json").read_text())
    numbers = {one["name"]: one for one in found["numbers"]}
    stiffness = numbers["elastomer_stiffness"]
    assert stiffness["value"] == pytest.approx(665.0, rel=0.06)
    assert 1.05 < stiffness["high"] / stiffness["low"] < 1.25  # one rig is not the next
    assert found["static"][0]["elastic"] is False
    assert "loading and unloading part" in (tmp_path / "mine" / "report.html").read_text()
