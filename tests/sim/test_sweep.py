"""Sweeps: the same numbers as single runs, whatever the order and the number of workers."""

from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.analysis.sweep import FEATURES, Sweep
from sim.analysis.sweep_features import motion_features
from sim.analysis.sweep_systems import packed_systems
from sim.bushing import lumped_bushing
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed, Oscillation
from sim.solvers.stick_slip import solve_stick_slip

THESIS = load_material_rig("fluorocarbon-thesis")
MEMORY = load_material_rig("fluorocarbon")
SCATTERED = replace(MEMORY, effects=(LawSpec("speed_fluctuation", {"form": "random"}),))


def plain(n, seconds=0.1, **more):
    rng = np.random.default_rng(5)
    return Sweep(
        THESIS,
        rng.uniform(-12.0, 12.0, n),
        interference=rng.uniform(0.17e-3, 0.39e-3, n),
        support_stiffness=rng.uniform(1500.0, 5000.0, n),
        seconds=seconds,
        **more,
    )


def test_systems_over_arrays_are_those_of_the_single_model():
    rng = np.random.default_rng(1)
    fits = rng.uniform(0.1e-3, 0.5e-3, 50)
    supports = np.append(rng.uniform(1000.0, 9000.0, 48), [2214.0, np.inf])
    for rig in (THESIS, MEMORY, load_material_rig("PDMS")):
        rows = packed_systems(rig, fits, supports)
        for row, interference, support in zip(rows, fits, supports, strict=True):
            fit = rig.fit(interference)
            single = lumped_bushing(rig, interference, support).packed()
            expected = [*single, fit.critical_torque, fit.kinetic_torque]
            assert row == pytest.approx(expected, rel=1e-12)


def test_features_are_those_of_a_run_that_is_stored():
    runs = plain(12, seconds=0.2, settling=0.05)
    found = runs.features()
    for i in range(12):
        fit = THESIS.fit(runs.interference[i])
        system = lumped_bushing(THESIS, runs.interference[i], runs.support_stiffness[i]).packed()
        shaft = np.full(7500, runs.speed[i])
        states, direction, events = solve_stick_slip(
            system, fit.critical_torque, fit.kinetic_torque, shaft, 1 / 30e3
        )
        torque = states[1500:, 1]
        slips = events[::2][events[::2] >= 0.05]
        assert found["slip_count"][i] == slips.size
        assert found["torque_mean"][i] == pytest.approx(torque.mean(), rel=1e-9)
        assert found["torque_rms"][i] == pytest.approx(torque.std(), rel=1e-6, abs=1e-9)
        assert found["torque_max"][i] == pytest.approx(torque.max(), rel=1e-12)
        assert found["torque_min"][i] == pytest.approx(torque.min(), rel=1e-12)
        clamp = np.sqrt(np.mean(states[1500:, 5] ** 2))
        assert found["clamp_speed_rms"][i] == pytest.approx(clamp, rel=1e-9)
        assert found["stick_fraction"][i] == pytest.approx(np.mean(direction[1500:] == 0), abs=0.01)
        if slips.size > 1:
            rate = (slips.size - 1) / (slips[-1] - slips[0])
            assert found["slip_frequency"][i] == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize("rig", [THESIS, SCATTERED], ids=["plain", "scattered"])
def test_results_are_the_same_bits_whatever_the_number_of_workers(rig):
    several = [
        Sweep(rig, np.linspace(1.0, 8.0, 5), seconds=0.02, seed=3, workers=workers).features()
        for workers in (1, 2, 5)
    ]
    for name in FEATURES:
        assert several[0][name].tobytes() == several[1][name].tobytes()
        assert several[0][name].tobytes() == several[2][name].tobytes()


def test_each_position_has_its_own_seed():
    torque = Sweep(SCATTERED, [3.0, 3.0], seconds=0.05, seed=1).torque()
    again = Sweep(SCATTERED, [3.0, 3.0, 3.0], seconds=0.05, seed=1).torque()
    assert not np.array_equal(torque[0], torque[1])
    assert np.array_equal(torque, again[:2])
    assert not np.array_equal(torque, Sweep(SCATTERED, [3.0] * 2, seconds=0.05, seed=2).torque())


def test_rigs_speeds_and_supports_are_broadcast():
    found = Sweep(
        [THESIS, MEMORY],
        np.array([[1.0], [5.0], [9.0]]),
        support_stiffness=np.array([[[2214.0]], [[np.inf]]]),
        seconds=0.05,
    ).features()
    assert all(values.shape == (2, 3, 2) for values in found.values())
    alone = Sweep(MEMORY, 5.0, support_stiffness=np.inf, seconds=0.05).features()
    assert found["torque_rms"][1, 1, 1] == alone["torque_rms"]


def test_a_shaft_that_swings_can_be_swept():
    swings = [Oscillation(0.26, 2.0), Oscillation(0.1, 4.0)]
    found = Sweep(THESIS, swings, seconds=0.3).features()
    motion = simulate_motion(
        THESIS, swings[1], interference=0.279e-3, support_stiffness=2214.0, seconds=0.3, rate=30e3
    )
    assert found["torque_min"][1] == motion_features(motion)[FEATURES.index("torque_min")]


def test_torques_are_decimated_without_aliasing():
    runs = Sweep(THESIS, [1.0], seconds=0.3, settling=0.1)
    fine, coarse = (runs.torque(every=every)[0].astype(float) for every in (1, 30))

    def spectrum(torque, rate):
        lines = np.fft.rfft((torque - torque.mean()) * np.hanning(torque.size)) / torque.size
        return np.abs(lines)[: round(350.0 * torque.size / rate)]

    wanted, found = spectrum(fine, 30e3), spectrum(coarse, 1e3)
    assert np.abs(found - wanted).max() < 0.01 * wanted.max()
    assert np.abs(spectrum(fine[::30], 1e3) - wanted).max() > 0.01 * wanted.max()


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ParameterError, match="do not fit together"):
        Sweep(THESIS, [1.0, 2.0], interference=[1e-4, 2e-4, 3e-4]).features()


def test_a_support_without_stiffness_is_refused():
    with pytest.raises(ParameterError, match="support stiffness = 0 "):
        Sweep(THESIS, [1.0, 2.0], support_stiffness=[2214.0, 0.0]).features()


def test_a_stutter_is_no_slip():
    motion = simulate_motion(
        THESIS, ConstantSpeed(1.0), interference=0.279e-3, support_stiffness=3745.0,
        seconds=0.1, rate=30e3,
    )  # fmt: skip
    stuttering = replace(motion, interface_speed=motion.interface_speed.copy())
    stuck = np.flatnonzero(motion.stuck)[50:-50:20]
    stuttering.interface_speed[stuck] -= 0.2  # creeps for one sample
    angle = motion.interface_angle.copy()
    angle[stuck] -= 0.2 / motion.rate
    stuttering = replace(stuttering, interface_angle=angle)
    before, after = (motion_features(m)[0] for m in (motion, stuttering))
    assert np.count_nonzero(np.diff(stuttering.stuck)) > 2 * np.count_nonzero(np.diff(motion.stuck))
    assert before == after
