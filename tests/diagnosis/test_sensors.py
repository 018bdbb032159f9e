"""A diagnosis expects the sensors that the rig file states, and says what they cost."""

import json
from dataclasses import replace

import numpy as np
import pytest

from models.recording import Channel, Recording
from models.rig import LawSpec
from models.rig_file import load_rig
from models.sensors import Sensor, Sensors
from noise.cli import main
from noise.diagnosis.case import read_case
from noise.diagnosis.causes.verdict import needs_explaining
from noise.diagnosis.first_answer import unlearned_sensors
from noise.diagnosis.gap import Gap
from noise.diagnosis.simulated.model_runs import Model, ModelRuns
from noise.diagnosis.simulated.repeats import Scatter, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.acquisition import Acquisition
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RATE, RIG, RIG_FILE, SECONDS, at, gap_of_case, run

COARSE = """
[sensors]
range = { torque = 20, acceleration = 400, pressure = 6, angle = 12.4 }
bits = 9
antialias_hz = 4000
"""

EXACT = Scatter(0.0, 0.0, 0.0, 0.0)
CONDITIONS = ((1.0, 2214.0), (2.0, 2214.0), (1.0, 3745.0))


def sensed(**by_kind):
    return replace(RIG, sensors=Sensors(by_kind))


def nominal(rig, scatter=EXACT):
    samples = np.zeros((1, round(SECONDS * RATE)))
    template = Recording(samples, RATE, (Channel("torque"),), at(2.0))
    return nominal_repeats(template, rig, TransferFunctionCache(RIG), [1], scatter)[0]


def test_repeats_are_filtered_as_recordings_are():
    silent = Sensor(noise=0.0)
    kinds = ("torque", "acceleration", "pressure", "angle")
    plain = nominal(sensed(**dict.fromkeys(kinds, silent)))
    corner = replace(silent, antialias=1500.0)
    low = nominal(sensed(torque=silent, acceleration=corner, pressure=corner, angle=silent))
    frequency = np.fft.rfftfreq(plain.samples.shape[1], 1.0 / RATE)
    window = np.hanning(plain.samples.shape[1])
    for kind in ("acceleration", "pressure"):
        before, after = (np.abs(np.fft.rfft(x[kind] * window)) ** 2 for x in (plain, low))
        for center, expected in ((750.0, 1.0), (1500.0, 0.5)):
            band = np.abs(frequency - center) < 60.0
            assert after[band].sum() / before[band].sum() == pytest.approx(expected, abs=0.15)


def test_repeats_are_rounded_and_clipped_as_recordings_are():
    sensor = Sensor(full_scale=9.0, bits=8)
    impacts = replace(sensed(torque=sensor), effects=(LawSpec("slip_pulse", {"amplitude": 20.0}),))
    for one in (
        nominal(sensed(torque=sensor)),
        nominal(impacts),
        ModelRuns(sensed(torque=sensor), EFFECTS, {}).simulated(Model(), run(at(2.0)), 3),
    ):
        steps = one["torque"] / sensor.step
        assert np.array_equal(steps, np.round(steps))
        assert one["torque"].max() == 127 * sensor.step


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    """Recordings by ``simulate`` through a coarse converter, their file, and one without it."""
    folder = tmp_path_factory.mktemp("coarse")
    (folder / "rig.toml").write_text(RIG_FILE + COARSE, encoding="utf-8")
    (folder / "plain.toml").write_text(RIG_FILE, encoding="utf-8")
    for i, (speed, support) in enumerate(CONDITIONS):
        given = ["--speed", speed, "--support-stiffness", support, "--seconds", 0.6, "--seed", i]
        out = folder / "data" / f"run{i}"
        words = ["simulate", "--rig", folder / "rig.toml", *given, "--out", out]
        assert main([str(word) for word in words]) == 0
    return folder


def test_recordings_through_a_coarse_converter_are_no_gap_to_a_file_that_states_it(coarse):
    gaps = {}
    for name in ("rig", "plain"):
        rig = load_rig(coarse / f"{name}.toml")
        gaps[name] = gap_of_case(read_case([coarse / "data"], rig).recordings, rig)
    assert gaps["rig"].p_value > 0.05
    assert gaps["plain"].p_value < 0.01
    assert gaps["plain"].distance > 2.0 * gaps["rig"].distance


def test_the_command_names_no_cause_and_says_what_its_causes_were_learned_with(coarse, capsys):
    words = ["diagnose", coarse / "data", "--quick", "--rig", coarse / "rig.toml"]
    assert main([str(word) for word in words]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["verdict"] == []
    (note,) = (note for note in found["notes"] if "learned with better sensors" in note)
    assert "noise or rounding of acceleration" in note
    assert "a filter of torque at 4000 Hz" in note


def test_noise_from_recordings_is_found_and_told(tmp_path):
    stated = "[sensors]\nnoise = { torque = 0.1, acceleration = 2.0, pressure = 0.04 }\n"
    (tmp_path / "true.toml").write_text(RIG_FILE + stated, encoding="utf-8")
    estimated = '[sensors]\nnoise = "from recordings"\nrange.torque = 20\nbits = 12\n'
    (tmp_path / "rig.toml").write_text(RIG_FILE + estimated, encoding="utf-8")
    for i, (speed, support) in enumerate(CONDITIONS):
        given = ["--speed", speed, "--support-stiffness", support, "--seconds", 0.5, "--seed", i]
        words = ["simulate", "--rig", tmp_path / "true.toml", *given, "--out", tmp_path / f"run{i}"]
        assert main([str(word) for word in words]) == 0
    case = read_case([tmp_path], load_rig(tmp_path / "rig.toml"))
    sensors = case.rig.sensors
    for kind, level in (("torque", 0.1), ("acceleration", 2.0), ("pressure", 0.04)):
        assert sensors.of(kind).noise == pytest.approx(level, rel=0.1)
    assert sensors.of("angle").noise == pytest.approx(1e-4, rel=0.1)
    assert sensors.of("torque").bits == 12
    assert "noise of the sensors (white, RMS), by the recordings: torque 0." in " ".join(case.notes)


def test_good_sensors_are_those_the_causes_were_learned_with():
    recording = run(at(2.0))
    good = {kind: Sensor(1.5 * level, 1e3, 24) for kind, level in Acquisition().noise.items()}
    assert unlearned_sensors(Sensors(good), [recording]) == ""
    assert unlearned_sensors(Sensors(), [recording]) == ""
    note = unlearned_sensors(Sensors({"torque": Sensor(full_scale=5.0)}), [recording])
    assert "a range that torque reaches" in note


def test_models_that_have_not_seen_such_sensors_raise_no_alarm_alone():
    small, large = (
        Gap(1.0, 0.4, np.ones(1), np.ones((1, 3))),
        Gap(6.0, 0.001, np.ones(1), np.ones((1, 3))),
    )
    assert needs_explaining(0.001, 0.05, small)
    assert not needs_explaining(0.001, 0.05, small, chance=0.4)
    assert needs_explaining(0.001, 0.05, small, chance=0.003)
    assert needs_explaining(0.001, 0.05, large, chance=0.4)
