"""Stiffness, inertias and damping from single recordings, of both simulators."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.rig import Fit, LawSpec
from models.rig_file import load_material_rig
from noise.identification.bushing_fit import Known, fit_bushing, torque_levels
from noise.identification.measured import measured
from sim.acquisition import Acquisition
from sim.run import simulate

RATE = 30e3


def recorded(torque, speed, fit=0.279e-3, support=math.inf, rate=RATE):
    angle = speed * np.arange(torque.size) / rate
    return measured(
        Recording(
            np.stack([torque, angle]), rate, (Channel("torque"), Channel("angle")),
            Condition(speed, fit, support),
        ),
        "run",
    )  # fmt: skip


def simulated(stiffness, speed, support, critical=10.7, kinetic=8.0, damping=0.09):
    base = load_material_rig("fluorocarbon-thesis")
    fit = Fit(0.279e-3, stiffness, critical, kinetic, {support: damping})
    rig = replace(base, fits=(fit,), friction=LawSpec("coulomb"))
    silent = dict.fromkeys(("torque", "acceleration", "pressure", "angle"), 0.0)
    run = simulate(
        rig, speed, support_stiffness=support, seconds=0.4, acquisition=Acquisition(RATE, silent)
    )
    return rig, recorded(run.recording["torque"], speed, support=support)


@settings(max_examples=6)
@given(
    stiffness=st.floats(300.0, 1000.0),
    speed=st.floats(0.4, 1.6),
    support=st.sampled_from([2214.0, 3745.0, math.inf]),
)
def test_stiffness_of_our_own_rig_is_found(stiffness, speed, support):
    rig, one = simulated(stiffness, speed, support)
    known = Known(rig.elastomer_inertia, rig.clamp_inertia, 0.02)
    fit = fit_bushing(one, known)
    assert fit.bushing.elastomer_stiffness == pytest.approx(stiffness, rel=0.01)


def test_torques_and_damping_of_our_own_rig_are_found():
    rig, one = simulated(665.0, 1.2, 2214.0, damping=0.09)
    fit = fit_bushing(one, Known(rig.elastomer_inertia, rig.clamp_inertia, 0.02))
    levels = torque_levels(fit)
    assert fit.damping == pytest.approx(0.09, rel=0.1)
    assert levels.critical == pytest.approx(10.7, rel=0.02)
    assert levels.kinetic == pytest.approx(8.0, rel=0.03)


def test_the_clamps_inertia_is_found_from_a_wrong_start():
    rig, one = simulated(665.0, 1.2, 2214.0)
    fit = fit_bushing(one, Known(rig.elastomer_inertia, 1.4 * rig.clamp_inertia, 0.5))
    assert fit.bushing.clamp_inertia == pytest.approx(rig.clamp_inertia, rel=0.02)


@pytest.mark.parametrize("way", [(1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])
def test_the_sign_of_rotation_and_cell_does_not_matter(way):
    _, one = simulated(665.0, 1.0, math.inf)
    torque, angle = one.recording["torque"] * way[0], one.recording["angle"] * way[1]
    turned = measured(replace(one.recording, samples=np.stack([torque, angle])), "turned")
    assert np.array_equal(turned.torque, one.torque)
    assert np.allclose(turned.shaft_speed, one.shaft_speed)


def test_a_shaft_that_turns_back_is_refused():
    t = np.arange(30_000) / RATE
    samples = np.stack([3.0 * np.sin(6.0 * t), 0.1 * np.sin(6.0 * t) + 0.05 * t])
    swung = Recording(
        samples, RATE, (Channel("torque"), Channel("angle")), Condition(None, 0.279e-3, 2214.0)
    )
    with pytest.raises(ParameterError, match="turns back and forth, or stops"):
        measured(swung, "swung")
