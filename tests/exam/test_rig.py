"""The second rig keeps the laws of mechanics, and agrees with the first where both are plain."""

from dataclasses import fields

import numpy as np
import pytest

from models.rig_file import load_material_rig, load_rig
from noise.diagnosis.case import read_case
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.blind import kernel
from tests.blind.cases import (
    run_case,
    write_case,
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


def test_acceleration_of_a_run_is_its_torque_through_the_exact_response():
    p, structure = Parameters(), draw_structure(np.random.default_rng(3), 2214.0)
    turned = turn(plain(p, 2.0, rate=RATE, seconds=0.5, settling=0.0))
    torque = turned.states[:, kernel.TORQUE]
    whole = structure.respond(turned)
    for i, name in enumerate(("acceleration", "pressure")):
        through = filtered(torque, RATE, lambda f, i=i: structure.exact(p, f)[i], pad=torque.size)
        late = slice(9000, None)
        assert np.std(whole[name][late] - through[late]) < 0.03 * np.std(through[late])
