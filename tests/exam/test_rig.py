"""The second rig keeps the laws of mechanics, and agrees with the first where both are plain."""

from dataclasses import fields

import numpy as np
import pytest

from models.rig_file import load_material_rig, load_rig, measured_responses
from noise.diagnosis.case import read_case
from sim.acquisition import Acquisition
from sim.motion import simulate_motion
from sim.run import simulate
from sim.shaft import ConstantSpeed
from tests.blind import kernel
from tests.blind.cases import (
    NOISE,
    Case,
    responses_of,
    run_case,
    structures_of,
    support_name,
    write_case,
    write_npz,
)
from tests.blind.design import Condition, Design, draw_design
from tests.blind.effects import DEVELOPMENT
from tests.blind.rig import FIXED, Parameters, plain, turn
from tests.blind.structure import draw_structure, filtered
from tests.helpers.small_rigs import gap_of_case

RATE = 90e3


def test_damped_free_vibration_has_the_frequencies_of_the_slipping_rig():
    gentle = Parameters(damping=1e-9, critical_torque=0.0, kinetic_torque=0.0)
    setup = plain(gentle, 60.0, rate=RATE, seconds=1.0, settling=0.0)
    start = np.zeros(12)
    start[0], start[3], start[7] = 2e-3, 1e-3, 60.0
    x = turn(setup, start).states[:, kernel.X1]
    spectrum = np.abs(np.fft.rfft(x * np.hanning(x.size), 4 * x.size))
    f = np.fft.rfftfreq(4 * x.size, 1.0 / RATE)
    for low, high, expected in ((150, 400, 256.9), (900, 1200, 1056.6)):
        inside = (f > low) & (f < high)
        assert f[inside][np.argmax(spectrum[inside])] == pytest.approx(expected, abs=0.4)


def test_free_vibration_without_damping_keeps_its_energy():
    p = Parameters(damping=0.0, critical_torque=0.0, kinetic_torque=0.0)
    start = np.zeros(12)
    start[0], start[3], start[7] = 2e-3, -1e-3, 60.0
    s = turn(plain(p, 60.0, rate=RATE, seconds=1.0, settling=0.0), start).states
    energy = _energy(p, s)
    assert np.ptp(energy) < 1e-3 * energy[0]
    assert energy[-9000:].mean() == pytest.approx(energy[:9000].mean(), rel=1e-4)


def _energy(p, s):
    twist = s[:, kernel.X1] - s[:, kernel.X2]
    return 0.5 * (
        p.elastomer_inertia * s[:, kernel.V1] ** 2
        + p.clamp_inertia * s[:, kernel.V2] ** 2
        + p.elastomer_stiffness * twist**2
        + p.support_stiffness * s[:, kernel.X2] ** 2
    )


def test_the_work_of_friction_is_what_is_stored_and_what_the_dampers_take():
    p = Parameters()
    s = turn(plain(p, 2.0, rate=RATE, seconds=0.3, settling=0.0)).states
    put_in = s[:, kernel.FRICTION] * s[:, kernel.V1]
    lost = 0.5 * p.damping * ((s[:, kernel.V1] - s[:, kernel.V2]) ** 2 + s[:, kernel.V2] ** 2)
    change = np.trapezoid(put_in - lost, dx=1.0 / RATE)
    stored = _energy(p, s)
    assert change == pytest.approx(stored[-1] - stored[0], abs=0.01 * np.trapezoid(put_in) / RATE)


def test_steady_sliding_carries_the_kinetic_torque():
    s = turn(plain(Parameters(), 12.0, rate=RATE, seconds=0.3, settling=0.5))
    assert s.torque == pytest.approx(8.0, abs=1e-4)
    assert s.states[-1, kernel.X2] == pytest.approx(8.0 / 2214.0, rel=1e-4)


def test_stuck_surface_turns_with_the_shaft():
    s = turn(plain(Parameters(critical_torque=1e3), 1.0, rate=RATE, seconds=0.1, settling=0.0))
    assert s.slips.size == 0
    assert s.states[1:, kernel.V1] == pytest.approx(1.0)
    assert s.states[-1, kernel.X1] == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize(
    ("fit", "support", "speed"),
    [(0.279, 2214.0, 1.0), (0.279, 3745.0, 2.5), (0.381, 3745.0, 5.0), (0.279, FIXED, 1.0)],
)
def test_both_rigs_agree_without_effects(fit, support, speed):
    rig = load_material_rig("fluorocarbon-thesis")
    at = rig.fit(1e-3 * fit)
    stiffness = np.inf if support < 0 else support
    p = Parameters(
        rig.elastomer_inertia, rig.clamp_inertia, at.elastomer_stiffness, support,
        at.damping[stiffness], at.critical_torque, at.kinetic_torque,
    )  # fmt: skip
    mine = turn(plain(p, speed, rate=RATE, seconds=1.0, settling=0.5))
    motion = simulate_motion(
        rig, ConstantSpeed(speed), interference=1e-3 * fit, support_stiffness=stiffness,
        seconds=1.5, rate=RATE, rng=np.random.default_rng(0),
    )  # fmt: skip
    theirs = motion.torque[45_000:]
    assert mine.torque.mean() == pytest.approx(theirs.mean(), rel=1e-3)
    assert mine.torque.std() == pytest.approx(theirs.std(), rel=5e-3)
    assert _slip_frequency(mine.torque) == pytest.approx(_slip_frequency(theirs), rel=5e-3)
    for low in (100.0, 200.0, 400.0, 800.0, 1600.0):
        assert _band(mine.torque, low) == pytest.approx(_band(theirs, low), abs=0.3)


@pytest.mark.parametrize(("speed", "subharmonic"), [(1.6, False), (1.8, False), (2.0, True)])
def test_both_rigs_slip_alternately_at_the_same_speeds(speed, subharmonic):
    """Where slips alternate, the octave below the slips' is loud; a little faster it is not."""
    rig = load_material_rig("fluorocarbon-thesis")
    at = rig.fit(0.279e-3)
    p = Parameters(
        rig.elastomer_inertia, rig.clamp_inertia, at.elastomer_stiffness, 2214.0,
        at.damping[2214.0], at.critical_torque, at.kinetic_torque,
    )  # fmt: skip
    mine = turn(plain(p, speed, rate=RATE, seconds=0.5, settling=0.35)).torque
    theirs = simulate_motion(
        rig, ConstantSpeed(speed), interference=0.279e-3, support_stiffness=2214.0, seconds=0.85,
        rate=RATE, rng=np.random.default_rng(0),
    ).torque[31_500:]  # fmt: skip
    shares = [_band(x, 44.0) - 10.0 * np.log10(_power(x)) for x in (mine, theirs)]
    assert [share > -20.0 for share in shares] == [subharmonic] * 2
    if subharmonic:
        assert shares[0] == pytest.approx(shares[1], abs=0.5)


def _power(torque):
    return np.sum(np.abs(np.fft.rfft((torque - torque.mean()) * np.hanning(torque.size))) ** 2)


class _Exact(Design):
    """A design whose recordings are of the rig as its file has it, without scatter."""

    def true(self, condition, recording):  # noqa: ARG002
        return self.nominal(condition)


@pytest.mark.filterwarnings("ignore:.*is missing from the simulated")
def test_over_fits_and_supports_the_second_rig_lies_within_the_floor_of_sim(tmp_path):
    drawn = draw_design(41, 0, DEVELOPMENT)
    speeds = {0.178: 1.3, 0.279: 2.1, 0.381: 3.4}
    conditions = tuple(
        Condition(speed, fit, support)
        for fit, speed in speeds.items()
        for support in (2214.0, 3745.0, FIXED)
    )
    same = {"conditions": conditions, "seconds": 0.5, "rate": 30_000, "forms": (), "offsets": {}}
    design = _Exact(**{f.name: getattr(drawn, f.name) for f in fields(drawn)} | same)
    write_case(run_case(design), tmp_path / "case", None)
    case = read_case([tmp_path / "case"], load_rig(tmp_path / "case" / "rig.toml"))
    gap = gap_of_case(case.recordings, case.rig)
    assert gap.distance < 1.2
    assert gap.p_value > 0.05


def _slip_frequency(torque):
    x = torque - torque.mean()
    return np.argmax(np.abs(np.fft.rfft(x * np.hanning(x.size), 4 * x.size))) * RATE / (4 * x.size)


def _band(torque, low):
    x = torque - torque.mean()
    power = np.abs(np.fft.rfft(x * np.hanning(x.size))) ** 2
    f = np.fft.rfftfreq(x.size, 1.0 / RATE)
    return 10.0 * np.log10(power[(f >= low) & (f < 2 * low)].sum())


def test_measured_responses_scatter_about_the_exact_ones_as_their_coherence_says():
    p, structure = Parameters(), draw_structure(np.random.default_rng(3), 2214.0)
    for found, exact in zip(
        structure.measured(p, np.random.default_rng(4)),
        structure.exact(p, np.arange(10.0, 10_001.0, 2.5)),
        strict=True,
    ):
        error = np.abs(found["response"] - exact) / np.abs(exact)
        assert 1e-3 < np.median(error) < 0.05
        assert np.median(error[found["coherence"] < 0.9]) > np.median(error)


@pytest.mark.filterwarnings("ignore:.*is missing from the simulated")
@pytest.mark.parametrize("support", [2214.0, 3745.0, FIXED])
def test_measured_responses_serve_a_rig_file_whatever_was_drawn(support, tmp_path):
    keys = ("torque_to_acceleration", "torque_to_pressure")
    for seed in range(12):
        structure = draw_structure(np.random.default_rng(seed), support)
        p = Parameters(support_stiffness=support)
        entry = {"support_stiffness_Nm_rad": support_name(support) if support < 0 else support}
        for key, found in zip(keys, structure.measured(p, np.random.default_rng(1)), strict=True):
            entry[key] = f"{key}.npz"
            write_npz(tmp_path / entry[key], found)
        (read,) = measured_responses([entry], tmp_path, "rig file")
        assert read.torque_to_pressure.output_unit == "Pa"


def test_acceleration_of_a_run_is_its_torque_through_the_exact_response():
    p, structure = Parameters(), draw_structure(np.random.default_rng(3), 2214.0)
    turned = turn(plain(p, 2.0, rate=RATE, seconds=0.5, settling=0.0))
    torque = turned.states[:, kernel.TORQUE]
    whole = structure.respond(turned)
    for i, name in enumerate(("acceleration", "pressure")):
        through = filtered(torque, RATE, lambda f, i=i: structure.exact(p, f)[i], pad=torque.size)
        late = slice(9000, None)
        assert np.std(whole[name][late] - through[late]) < 0.03 * np.std(through[late])


@pytest.mark.filterwarnings("ignore:.*is missing from the simulated")
def test_the_bolted_clamp_sounds_as_sim_has_it_where_slips_leave_it_alone(tmp_path):
    design = draw_design(77, 1, DEVELOPMENT)
    condition = next(c for c in design.conditions if c.support == FIXED)
    structure = structures_of(design)[FIXED]
    silence = (np.zeros((4, 2), np.float32),) * len(design.conditions)
    responses = responses_of(design, structures_of(design))
    write_case(Case(design, silence, responses, {}), tmp_path / "case", None)
    run = simulate(
        load_rig(tmp_path / "case" / "rig.toml"), condition.speed,
        interference=1e-3 * condition.interference_mm, support_stiffness=np.inf,
        acquisition=Acquisition(rate=RATE, noise={}),
    )  # fmt: skip
    setup = plain(design.nominal(condition), condition.speed, rate=RATE, seconds=1.0, settling=0.35)
    turned = turn(setup)
    mine = structure.respond(turned)["pressure"][turned.settle :]
    theirs = run.recording.samples[run.recording.channel_names.index("pressure")]
    noise = NOISE["pressure"] * np.random.default_rng(1).standard_normal(mine.size)
    assert _slip_frequency(turned.torque) > 250.0
    for low in (125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0):
        assert _band(mine + noise, low) == pytest.approx(_band(theirs + noise, low), abs=1.0)
