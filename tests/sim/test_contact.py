"""Friction laws with an inner state, and the regimes of the calibrated rig."""

import numpy as np
import pytest

from models.rig_file import load_material_rig
from sim.analysis.regime import Regime, friction_regime
from sim.bushing import lumped_bushing
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

FLUOROCARBON = load_material_rig("fluorocarbon")
PDMS = load_material_rig("PDMS")


def motion(rig, speed, interference=0.279e-3, stiffness=2214.0, seconds=1.0):
    return simulate_motion(
        rig,
        ConstantSpeed(speed),
        interference=interference,
        support_stiffness=stiffness,
        seconds=seconds,
        rate=90e3,
    )


def strongest_line(run):
    torque = run.torque[run.torque.size // 2 :]
    spectrum = np.abs(np.fft.rfft((torque - torque.mean()) * np.hanning(torque.size)))
    return np.fft.rfftfreq(torque.size, 1.0 / run.rate)[spectrum.argmax()]


def test_pdms_triples_its_torque_and_never_oscillates():
    runs = [motion(PDMS, speed, 0.254e-3, seconds=0.5) for speed in (0.25, 5.0, 17.0)]
    assert all(friction_regime(run) is Regime.STEADY_SLIDING for run in runs)
    assert 2.5 < runs[-1].torque[-1] / runs[0].torque[-1] < 3.5


@pytest.mark.parametrize(
    ("interference", "stiffness", "speed", "regime"),
    [
        (0.279e-3, 2214.0, 1.0, Regime.STICK_SLIP),
        (0.279e-3, 2214.0, 10.0, Regime.STEADY_SLIDING),
        (0.279e-3, 3745.0, 10.0, Regime.QUASI_HARMONIC),
        (0.178e-3, 2214.0, 7.5, Regime.STEADY_SLIDING),
        (0.381e-3, 3745.0, 10.0, Regime.STICK_SLIP),
    ],
)
def test_regimes_of_the_calibrated_fluorocarbon_are_those_of_the_thesis(
    interference, stiffness, speed, regime
):
    assert friction_regime(motion(FLUOROCARBON, speed, interference, stiffness)) is regime


def test_squeal_is_the_elastomers_mode_and_not_the_first_torsional_one():
    run = motion(FLUOROCARBON, 10.0, stiffness=3745.0)
    elastomer = lumped_bushing(FLUOROCARBON, 0.279e-3, 3745.0).natural_frequencies()[1]
    assert strongest_line(run) == pytest.approx(elastomer, rel=0.12)
