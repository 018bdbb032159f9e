"""Friction laws with an inner state, and the regimes of the calibrated rig."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from features.kernels.harmonics import analyse_harmonics
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.analysis.regime import Regime, friction_regime
from sim.bushing import lumped_bushing
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.helpers.rig_measures import slip_rates

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


def test_a_contact_that_never_ages_does_not_weaken():
    never = LawSpec("contact_with_memory", {"ageing_time": 1e3, "weakening_share": 0.0})
    rig = replace(FLUOROCARBON, friction=never)
    slow, fast = (motion(rig, speed, seconds=0.5).torque[-1] for speed in (5.0, 12.0))
    kinetic = rig.fit(0.279e-3).kinetic_torque
    assert slow == pytest.approx(kinetic, rel=1e-3)
    assert fast == pytest.approx(kinetic, rel=1e-3)


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


def test_slip_frequency_rises_with_speed_and_stays_below_the_first_torsional_mode():
    found = [
        analyse_harmonics(motion(FLUOROCARBON, speed).torque[45000:], 90e3).fundamental
        for speed in (1.0, 2.5, 5.0)
    ]
    assert found == sorted(found)
    assert found[-1] < lumped_bushing(FLUOROCARBON, 0.279e-3, 2214.0).natural_frequencies()[0]


def test_slips_at_the_tightest_fit_become_more_frequent_slowly_and_never_pass_the_torsional_mode():
    rates = slip_rates(FLUOROCARBON)
    assert all(later > earlier for earlier, later in pairwise(rates))
    assert rates[1] / rates[-1] > 0.7  # a constant drop of the torque makes it about a quarter
    assert max(rates) < 257.0
