"""Natural rubber as the thesis found it (5.1.3, 5.2.2, 5.2.3): before, on and after its film."""

import numpy as np
import pytest

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.rig_file import load_material_rig
from sim.analysis.regime import Regime, friction_regime
from sim.run import simulate

BARE = ("natural-rubber", "natural-rubber-film-removed")


def run(material, speed, stiffness=2214.0):
    return simulate(
        load_material_rig(material),
        speed,
        interference=0.127e-3,
        support_stiffness=stiffness,
        seconds=1.0,
    )


def torque_lines(found):
    torque = found.motion.torque
    return find_lines(autospectrum(torque[torque.size // 2 :], found.motion.rate), low=20, high=5e3)


@pytest.mark.parametrize("material", BARE)
@pytest.mark.parametrize(("stiffness", "mode"), [(2214.0, 250.0), (3745.0, 310.0)])
@pytest.mark.parametrize("speed", [7.5, 10.0])
def test_it_vibrates_at_the_first_torsional_mode(material, stiffness, mode, speed):
    found = run(material, speed, stiffness)
    assert friction_regime(found.motion) is Regime.STICK_SLIP
    assert found.motion.stuck.mean() > 0.05
    assert torque_lines(found).frequency[0] == pytest.approx(mode, rel=0.05)


@pytest.mark.parametrize("stiffness", [2214.0, 3745.0])
@pytest.mark.parametrize("speed", [1.0, 5.0, 10.0])
def test_on_its_film_there_is_no_tone(speed, stiffness):
    found = run("natural-rubber-film", speed, stiffness)
    assert torque_lines(found).strongest_share < 0.25


def test_on_its_film_the_beams_shake_with_about_50_m_s2():
    assert np.std(run("natural-rubber-film", 7.5).recording["acceleration"]) == pytest.approx(
        50.0, rel=0.2
    )
