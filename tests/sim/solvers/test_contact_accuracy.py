"""The contact solver against a general one, and against the balance of energy."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import simpson, solve_ivp

from models.rig_file import load_material_rig
from tests.helpers.contact_calls import call_law
from tests.helpers.contacts import contact_of, solve_contact

RIG = load_material_rig("fluorocarbon")


def general(torques, options, speed, times):
    """Elastomer torque by DOP853 at rtol 1e-10."""
    (j_e, j_c, k_e, k_b, c_e, c_b), critical, kinetic = torques
    contact = np.array([critical, kinetic, k_e, 0.0, 0.0, np.inf, 0.0])
    rates = np.zeros(options["law_state"].size)

    def change(_, x):
        friction = call_law(
            options["law"], speed - x[1], options["coefficients"], contact, x[4:].copy(), rates
        )
        elastomer = k_e * (x[0] - x[2]) + c_e * (x[1] - x[3])
        clamp = 0.0 if k_b < 0.0 else (elastomer - k_b * x[2] - c_b * x[3]) / j_c
        return np.array([x[1], (friction - elastomer) / j_e, x[3], clamp, *rates])

    rest = np.array([0.0, 0.0, 0.0, 0.0, *options["law_state"]])
    run = solve_ivp(
        change, (0.0, times[-1]), rest, "DOP853", t_eval=times, rtol=1e-10, atol=1e-13,
        max_step=1e-4,
    )  # fmt: skip
    angle, turning, clamp, moving = run.y[:4]
    return k_e * (angle - clamp) + c_e * (turning - moving)


@pytest.mark.parametrize(
    ("interference", "stiffness", "speed", "seconds"),
    [(0.279e-3, 3745.0, 10.0, 0.01), (0.279e-3, np.inf, 2.5, 0.015)],
)
def test_first_slips_agree_with_a_general_solver(interference, stiffness, speed, seconds):
    torques, options = contact_of(RIG, interference, stiffness)
    step, n = 1.0 / 30e3, round(30e3 * seconds)
    states, _ = solve_contact(*torques, np.full(n, speed), step, **options)
    exact = general(torques, options, speed, step * np.arange(n))
    assert np.diff(exact).min() < 0.0  # it has slipped
    assert np.abs(states[:, 1] - exact).max() < 1e-5 * exact.max()


@settings(max_examples=5)
@given(
    interference=st.sampled_from([0.178e-3, 0.279e-3, 0.381e-3]),
    stiffness=st.floats(1500.0, 6000.0),
    speed=st.floats(-12.0, 12.0).filter(lambda v: abs(v) > 0.5),
    name=st.sampled_from(["contact_with_memory", "rate_and_state", "lugre", "ageing"]),
)
def test_the_work_of_friction_is_what_is_stored_and_what_is_damped(
    interference, stiffness, speed, name
):
    torques, options = contact_of(RIG, interference, stiffness, name)
    j_e, j_c, k_e, k_b, c_e, c_b = torques[0]
    step, n = 1e-6, 30_001
    states, _ = solve_contact(*torques, np.full(n, speed), step, **options)
    friction, _, angle, turning, clamp, moving, _ = states.T
    kinetic = 0.5 * (j_e * turning**2 + j_c * moving**2)
    stored = kinetic + 0.5 * (k_e * (angle - clamp) ** 2 + k_b * clamp**2)
    damped = simpson(c_e * (turning - moving) ** 2 + c_b * moving**2, dx=step)
    work = simpson(friction * turning, dx=step)
    assert damped > 0.0
    assert work == pytest.approx(stored[-1] - stored[0] + damped, rel=1e-5, abs=1e-7)
