"""Laws for the slip rate: their limits, and that the study's page is of its fits."""

import json
import math

import numpy as np
import pytest

from models.rig_files.rig_file import load_material_rig
from noise.identification.settled_run import settled_run
from noise.thesis.runs import LONG, SHORT
from tests.studies.slip_rate_laws.__main__ import FITS, left_out_speed, run
from tests.studies.slip_rate_laws.laws import LAWS, simulate
from tests.studies.slip_rate_laws.point import START, UNKNOWNS, constants, unknowns

SHIPPED = load_material_rig("fluorocarbon")
STEADY = 14.0  # above all critical speeds at 0.279 mm


@pytest.mark.parametrize("speed", [2.5, 10.0])
def test_the_prototype_slips_as_often_as_the_simulator(speed):
    ours = settled_run(SHIPPED, 0.381e-3, LONG, speed).slips.rate
    assert run("shipped", START, 0.381, LONG, speed).slips.rate == pytest.approx(ours, rel=0.01)


@pytest.mark.parametrize("law", [law for law in LAWS if law not in ("shipped", "front")])
def test_each_law_has_the_shipped_one_as_its_limit(law):
    torques = [
        simulate(one, 5.0, constants(one, START, 0.381, LONG), unknowns(one, START), 0.1)[0]
        for one in ("shipped", law)
    ]
    assert np.abs(torques[0] - torques[1]).max() < 1e-6 * np.abs(torques[0]).max()


def test_a_stiff_front_slips_as_often_as_the_shipped_contact():
    rates = [run(law, START, 0.381, LONG, 5.0).slips.rate for law in ("shipped", "front")]
    assert rates[1] == pytest.approx(rates[0], rel=0.005)


@pytest.mark.parametrize("law", LAWS)
def test_steady_sliding_takes_the_mean_torque_of_the_law(law):
    some = dict(START, s=0.3, mu=0.2, lam=0.3, chi=0.2, eps=0.3, gam=0.1, s1=0.3, s2=0.1)
    c = constants(law, some, 0.279, SHORT)
    torque, _ = simulate(law, STEADY, c, unknowns(law, some), 0.8)
    assert np.ptp(torque[-1000:]) < 0.02 * torque[-1]
    assert torque[-1] == pytest.approx(8.0, rel=0.1)  # flat from 5 rad/s on


def test_a_speed_between_two_rises_of_the_measured_size_is_no_error():
    assert left_out_speed(200.0, 217.0, 235.0) == 0.0
    assert left_out_speed(200.0, 240.0, 235.0) == pytest.approx(15.0 / 240.0)


def test_every_fit_states_all_unknowns_of_its_law():
    for fit in json.loads(FITS.read_text(encoding="utf-8")):
        assert set(fit["point"]) == set(START) | set(UNKNOWNS[fit["law"]])
        assert all(math.isfinite(value) for value in fit["point"].values())
