"""Where the contact slides smoothly, units are told by the noise of sensors, or said unchecked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.rig_file import load_rig
from models.sensors import Sensor, Sensors
from noise.diagnosis.bench.check import bench_findings, unchecked_units
from noise.diagnosis.case import Case, read_case
from noise.diagnosis.run import diagnose
from sim.acquisition import Acquisition
from tests.helpers.small_rigs import RIG, at, only, run, write_case
from tests.helpers.wrong_benches import WRONG_BENCHES

SMOOTH = ("velocity_strengthening", {"gain": 0.9, "speed": 2.0})
STATED = Sensors({kind: Sensor(noise) for kind, noise in Acquisition().noise.items()})


@pytest.fixture(scope="module")
def smooth():
    return [run(at(speed), SMOOTH, seed=i) for i, speed in enumerate((2.0, 3.0, 4.0))]


def _case(recordings, rig=RIG):
    return Case(rig, tuple(f"run{i}.wav" for i in range(len(recordings))), tuple(recordings))


def _scaled(recordings, channel, factor):
    changed = []
    for one in recordings:
        samples = np.array(one.samples)
        samples[one.first(channel)] *= factor
        changed.append(replace(one, samples=samples))
    return changed


@pytest.mark.parametrize(
    ("channel", "factor", "unit"),
    [
        ("pressure", 1e3, "mPa"), ("pressure", 1e-3, "kPa"), ("pressure", 1e6, "uPa"),
        ("acceleration", 1e3, "mm/s^2"),
    ],
)  # fmt: skip
def test_a_unit_of_a_thousand_is_told_by_the_noise(smooth, channel, factor, unit):
    (words,) = bench_findings(_case(_scaled(smooth, channel, factor)))
    assert words.startswith(f"channel {channel} looks like {unit}, not ")


def test_a_unit_of_ten_is_told_where_the_noise_is_stated(smooth):
    in_g = _scaled(smooth, "acceleration", 1.0 / 9.80665)
    assert bench_findings(_case(in_g)) == ()
    (words,) = bench_findings(_case(in_g, replace(RIG, sensors=STATED)))
    assert words.startswith("channel acceleration looks like g, not m/s^2")


def test_swapped_channels_are_told_where_their_noise_is_stated(smooth):
    change, words = WRONG_BENCHES["acceleration and pressure swapped"]
    swapped = change(smooth, np.random.default_rng(0))
    (told,) = bench_findings(_case(swapped, replace(RIG, sensors=STATED)))
    assert words in told


@pytest.mark.parametrize("sensors", [Sensors(), STATED])
@pytest.mark.parametrize("louder", [0.3, 1.0, 4.0])
def test_noise_that_sensors_have_is_no_wrong_unit(smooth, sensors, louder):
    case = _case(_scaled(_scaled(smooth, "acceleration", louder), "pressure", louder))
    assert bench_findings(replace(case, rig=replace(RIG, sensors=sensors))) == ()


def test_what_nothing_tells_is_said_to_be_unchecked(smooth, tmp_path):
    (words,) = unchecked_units(_case(smooth))
    assert words.startswith("nothing slips: units, signs and order of acceleration and pressure")
    (words,) = unchecked_units(_case([only(one, "pressure", "angle") for one in smooth]))
    assert words.startswith("no torque: units, signs and order of pressure were not checked")
    assert unchecked_units(_case([run(at(1.6)), *smooth])) == ()
    data, rig = write_case(tmp_path, smooth)
    assert any("were not checked" in note for note in diagnose(data, rig, quick=True).notes)


@pytest.mark.parametrize("effects", [(), (SMOOTH,)])
@pytest.mark.parametrize("other", ["angle", "acceleration"])
def test_a_torque_in_another_channel_is_told_before_a_start_is_looked_for(tmp_path, effects, other):
    right = [run(at(speed), *effects, seed=i) for i, speed in enumerate((2.0, 3.0, 4.0))]
    change, words = WRONG_BENCHES[f"torque and {other} swapped"]
    data, rig = write_case(tmp_path, change(right, np.random.default_rng(0)))
    (told,) = bench_findings(read_case([data], load_rig(rig)))
    assert words in told
