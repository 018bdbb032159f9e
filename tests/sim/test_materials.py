"""Shipped materials on the rig as the thesis found them, and which of them let go at all."""

import math
from dataclasses import replace

import numpy as np
import pytest

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.rig import LawSpec
from models.rig_file import load_material_rig, material_names
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import Regime, friction_regime, never_slips
from sim.bushing import lumped_bushing
from sim.effects import constant_version
from sim.run import simulate
from sim.shaft import Oscillation

FLUOROCARBON = load_material_rig("fluorocarbon")
SWING = Oscillation(math.radians(15.0), 2.0)


def run(rig, shaft, interference=0.279e-3, stiffness=2214.0, seconds=1.0):
    rig = load_material_rig(rig) if isinstance(rig, str) else rig
    return simulate(
        rig, shaft, interference=interference, support_stiffness=stiffness, seconds=seconds
    )


def torque_lines(found):
    torque = found.motion.torque
    return find_lines(autospectrum(torque[torque.size // 2 :], found.motion.rate), low=20, high=5e3)


# Fluorocarbon and silicone


def test_pdms_triples_its_torque_and_never_oscillates():
    runs = [run("PDMS", speed, 0.254e-3, seconds=0.5).motion for speed in (0.25, 5.0, 17.0)]
    assert all(friction_regime(one) is Regime.STEADY_SLIDING for one in runs)
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
    rig = constant_version(FLUOROCARBON)
    assert friction_regime(run(rig, speed, interference, stiffness).motion) is regime


def test_squeal_is_the_elastomers_mode_and_not_the_first_torsional_one():
    found = torque_lines(run(FLUOROCARBON, 10.0, stiffness=3745.0))
    elastomer = lumped_bushing(FLUOROCARBON, 0.279e-3, 3745.0).natural_frequencies()[1]
    assert found.frequency[0] == pytest.approx(elastomer, rel=0.12)


def test_the_constant_version_has_no_scatter_and_keeps_an_effect_of_the_users_own():
    own = LawSpec("rattle", {})
    rig = replace(load_material_rig("PDMS"), effects=(own, LawSpec("speed_fluctuation", {})))
    assert constant_version(rig).effects == (own,)
    even, scattered = (
        motion_from_rest(
            replace(FLUOROCARBON, effects=(LawSpec("critical_torque_scatter", {"scatter": s}),)),
            2.5, 0.279e-3, 2214.0, seconds=0.2,
        ).torque
        for s in (0.0, 0.9)
    )  # fmt: skip
    assert np.array_equal(even, scattered)


# Natural rubber before, on and after its film (5.1.3, 5.2.2, 5.2.3)


@pytest.mark.parametrize("material", ["natural-rubber", "natural-rubber-film-removed"])
@pytest.mark.parametrize(
    ("stiffness", "mode", "speed"), [(2214.0, 250.0, 7.5), (3745.0, 310.0, 10.0)]
)
def test_natural_rubber_vibrates_at_the_first_torsional_mode(material, stiffness, mode, speed):
    found = run(material, speed, 0.127e-3, stiffness)
    assert friction_regime(found.motion) is Regime.STICK_SLIP
    assert found.motion.stuck.mean() > 0.05
    assert torque_lines(found).frequency[0] == pytest.approx(mode, rel=0.05)


@pytest.mark.parametrize(("speed", "stiffness"), [(1.0, 2214.0), (5.0, 3745.0), (7.5, 2214.0)])
def test_on_its_film_there_is_no_tone_but_the_beams_shake(speed, stiffness):
    found = run("natural-rubber-film", speed, 0.127e-3, stiffness)
    assert torque_lines(found).strongest_share < 0.25
    if speed == 7.5:
        assert np.std(found.recording["acceleration"]) == pytest.approx(50.0, rel=0.2)


# Whether the contact ever lets go


@pytest.mark.parametrize("material", material_names())
@pytest.mark.parametrize("shaft", [5.0, SWING], ids=["turning", "swinging"])
def test_a_contact_that_holds_never_slips_and_one_that_lets_go_does(material, shaft):
    rig = load_material_rig(material)
    fit = rig.fits[0].interference
    assert not never_slips(run(rig, shaft, fit, seconds=0.3).motion)
    held = rig.changed(critical_torque="x9999")
    if material != "natural-rubber-film":  # whose torque does not come from the critical one
        assert never_slips(run(held, shaft, fit, seconds=0.3).motion)
