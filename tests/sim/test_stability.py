"""Linear stability of steady sliding, against numbers found otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.analysis.stability import sliding_growth
from sim.effects import EFFECTS, constant_version
from sim.friction import LAWS
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

THESIS = load_material_rig("fluorocarbon-thesis")
MEMORY = constant_version(load_material_rig("fluorocarbon"))
SPEEDS = np.arange(0.25, 15.0, 0.25)


def weakened(slope, speed=5.0, scale=1e3):
    """Constant torque that falls by so much per speed, at `speed` [Nm s/rad]."""
    kinetic = THESIS.fit(0.279e-3).kinetic_torque
    share = -slope * scale / kinetic * np.exp(speed / scale)
    values = {"share": float(share), "speed": scale}
    return replace(THESIS, effects=(LawSpec("velocity_weakening", values),))


@pytest.mark.parametrize(("support", "slope"), [(2214.0, -0.0465), (3745.0, -0.0346)])
def test_sliding_loses_its_stability_at_the_slope_that_the_modes_damping_bears(support, slope):
    gentle, steep = (
        sliding_growth(weakened(factor * slope, scale=100.0), 5.0, 0.279e-3, support)
        for factor in (0.97, 1.03)
    )
    assert gentle < 0.0 < steep


@pytest.mark.parametrize(("speed", "support"), [(9.5, 2214.0), (12.5, 3745.0)])
def test_a_vibration_dies_as_fast_in_simulation_as_stability_says(speed, support):
    rate = 30e3
    motion = simulate_motion(
        MEMORY,
        ConstantSpeed(speed),
        interference=0.279e-3,
        support_stiffness=support,
        seconds=1.6,
        rate=rate,
        tolerance=1e-10,
    )
    torque = motion.torque - motion.torque[-1]
    early, late = (np.std(torque[round(t * rate) : round((t + 0.1) * rate)]) for t in (0.6, 0.9))
    found = sliding_growth(MEMORY, speed, 0.279e-3, support)
    assert np.log(late / early) / 0.3 == pytest.approx(float(found), rel=0.02)


@pytest.mark.parametrize("law", list(LAWS))
def test_every_law_has_a_finite_growth_with_and_without_clamp(law):
    rig = replace(THESIS, friction=LawSpec(law))
    found = sliding_growth(rig, SPEEDS, 0.279e-3, [[2214.0], [np.inf]])
    assert found.shape == (2, SPEEDS.size)
    assert np.isfinite(found).all()


@pytest.mark.parametrize("effect", [e.name for e in EFFECTS.values() if e.contact is not None])
def test_effects_on_the_contact_leave_growth_finite(effect):
    found = sliding_growth(replace(MEMORY, effects=(LawSpec(effect),)), SPEEDS[::8])
    assert np.isfinite(found).all()


@settings(max_examples=15)
@given(st.floats(0.3, 13.0), st.floats(0.178e-3, 0.381e-3), st.floats(1500.0, 5000.0))
def test_either_way_of_turning_is_alike_and_many_at_once_are_as_one(speed, fit, support):
    one = sliding_growth(MEMORY, speed, fit, support)
    back = sliding_growth(MEMORY, -speed, fit, support)
    several = sliding_growth(MEMORY, [1.0, speed], fit, support)
    assert one == back == several[1]
