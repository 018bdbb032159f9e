"""The solver of contacts: against itself with far shorter steps, a general one, and energy."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import simpson, solve_ivp

from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.effects import EFFECTS
from sim.friction import LAWS
from sim.run import simulate
from tests.helpers.contact_calls import call_law
from tests.helpers.contacts import contact_of, hook, solve_contact

THESIS, CALIBRATED = load_material_rig("fluorocarbon-thesis"), load_material_rig("fluorocarbon")
RATE = 90e3
CONDITIONS = {
    "thesis": (THESIS, 0.279e-3),
    "calibrated": (CALIBRATED, 0.279e-3),
    "three times that": (CALIBRATED, 0.381e-3),
}
NAMES = tuple(name for name in LAWS if name != "coulomb")
FORMS = [
    (name, form)
    for name, effect in EFFECTS.items()
    if effect.contact is not None
    for form in effect.forms
]


def arguments(condition, name, given=None, hooks=(), stiffness=3745.0):
    """Of the solver, but for the drive and the step."""
    rig, interference = CONDITIONS[condition]
    torques, options = contact_of(rig, interference, stiffness, name, given)
    return torques, options | {"hooks": hooks}


def solve(condition, name, speed, seconds, *, refined=1, given=None, hooks=(), stiffness=3745.0):
    torques, options = arguments(condition, name, given, hooks, stiffness)
    drive = np.full(round(seconds * RATE), float(speed))
    return solve_contact(*torques, drive, 1.0 / RATE, refined=refined, **options)[0]


def error_before_chaos(condition, name, speed, hooks=(), stiffness=3745.0, seconds=0.12):
    """Of the torque over its rms, over ten cycles or until a billionth has grown a thousandfold."""
    coarse, other, fine = (
        solve(condition, name, v, seconds, refined=n, hooks=hooks, stiffness=stiffness)[:, 1]
        for v, n in ((speed, 1), (speed * (1.0 + 1e-9), 1), (speed, 16))
    )
    mean = fine.mean()
    rises = np.flatnonzero((fine[1:] > mean) & (fine[:-1] <= mean))
    end = rises[10] if rises.size > 10 else fine.size
    rms = np.sqrt(np.mean(fine[:end] ** 2))
    grown = np.flatnonzero(np.abs(other - coarse) > 1e-6 * rms)
    end = min([end, *grown[:1]])
    assert end > 0.003 * RATE  # the wildest part their neighbours within a cycle
    return np.sqrt(np.mean((coarse - fine)[:end] ** 2)) / rms


@pytest.mark.slow
@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("speed", [1.0, 5.0, 10.0])
@pytest.mark.parametrize("stiffness", [2214.0, 3745.0])
@pytest.mark.parametrize("name", NAMES)
def test_a_law_agrees_with_a_sixteenth_of_its_step_anywhere(name, stiffness, speed, condition):
    assert error_before_chaos(condition, name, speed, stiffness=stiffness) < 1e-4


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize(("name", "form"), FORMS)
def test_an_effect_on_true_stick_agrees_with_a_sixteenth_of_its_step(name, form, condition):
    hooks = (hook(name, form=form),)
    assert error_before_chaos(condition, "coulomb", 2.5, hooks, seconds=0.06) < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("law", ["coulomb", "contact_with_memory"])
@pytest.mark.parametrize("speed", [1.0, 5.0])
@pytest.mark.parametrize(("name", "form"), FORMS)
def test_an_effect_agrees_with_a_sixteenth_of_its_step_anywhere(name, form, speed, law, condition):
    assert error_before_chaos(condition, law, speed, (hook(name, form=form),)) < 1e-4


def test_a_slip_that_nearly_catches_goes_on():
    # The sliding is least just where a step begins, over and over: 0.1 rad/s, after 0.11 s.
    effects = (
        LawSpec("velocity_weakening", {"share": 0.110897, "speed": 11.7191}),
        LawSpec("static_ageing", {"share": 0.755184, "ageing_time": 0.00252834}),
    )
    run = simulate(replace(THESIS, effects=effects), 5.234, seconds=0.05)
    torque = run.motion.torque
    assert 9.0 < torque.max() < 10.7  # of a contact that ages, less than at rest
    assert np.ptp(torque[-900:]) > 1.0


def test_what_is_too_steep_is_refused_by_name():
    steep = LawSpec("velocity_strengthening", {"gain": 5.0, "speed": 0.01})
    with pytest.raises(ParameterError, match=r"velocity_strengthening: the motion changes so fast"):
        simulate(replace(THESIS, effects=(steep,)), 1.0, seconds=0.1)


@pytest.mark.parametrize("form", EFFECTS["partial_slip"].forms)
def test_a_creeping_stick_breaks_and_catches_at_its_creeping_speed(form):
    torques, options = arguments(
        "thesis", "coulomb", hooks=(hook("partial_slip", form=form, share=0.6),)
    )
    drive = np.full(40000, 2.0)
    states, direction = solve_contact(*torques, drive, 2.5e-7 * 10.0, **options)
    surface = states[:, 3]
    # No faster than the torque that the break sets free can turn the surface.
    fastest = (10.7 - 8.0) * 65000 * 2.5e-6
    jumps = np.abs(np.diff(surface))
    assert np.count_nonzero(np.diff(direction)) >= 2
    assert jumps.max() < 1.5 * fastest
    last = np.flatnonzero(np.diff(np.abs(direction)) > 0)[0]
    assert surface[last] < 0.6 * 2.0
    assert surface[last] == pytest.approx(2.0 * (1.0 - 0.6), rel=0.2)


# Against a general solver, and against the balance of energy


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
    torques, options = contact_of(CALIBRATED, interference, stiffness)
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
    torques, options = contact_of(CALIBRATED, interference, stiffness, name)
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
