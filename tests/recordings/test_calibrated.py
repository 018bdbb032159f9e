"""Volts and counts become units by the calibration of a rig file, unless something else says."""

import json

import numpy as np
import pytest
import soundfile

from models.calibration import Calibration
from models.errors import RecordingError
from noise.recordings import read_recording

CELL = Calibration(
    (-483.0, -240.0, 0.0, 243.0, 488.0), (-40.0, -20.0, 0.0, 20.0, 40.0), "mV", source="cell.csv"
)
POTENTIOMETER = Calibration.line(0.101, -7e-4, "V")
BOTH = {"torque": CELL, "angle": POTENTIOMETER}


def written(folder, samples, channels, subtype="FLOAT", **more):
    soundfile.write(folder / "run.wav", np.transpose(samples), 30_000, subtype=subtype)
    (folder / "run.json").write_text(json.dumps({"channels": channels, **more}))
    return folder / "run.wav"


def volts(name, unit="V", **more):
    return {"name": name, "unit": unit, **more}


READINGS = np.array([np.linspace(-0.4, 0.45, 64), np.linspace(0.0, 0.3, 64)], np.float32)
TORQUE = np.interp(1e3 * READINGS[0], CELL.readings, CELL.values)
ANGLE = (READINGS[1] + 7e-4) / 0.101


def test_volts_become_torque_and_angle(tmp_path):
    path = written(tmp_path, READINGS, [volts("torque"), volts("angle")])
    assert not read_recording(path).calibrated
    run = read_recording(path, calibrations=BOTH)
    assert run.calibrated
    assert run["torque"] == pytest.approx(TORQUE, abs=1e-5)
    assert run["angle"] == pytest.approx(ANGLE, abs=1e-5)


def test_integers_take_the_volts_of_full_scale_from_the_sidecar(tmp_path):
    channels = [volts("torque", scale=1.25), volts("angle", "mV", scale=1250.0)]
    path = written(tmp_path, READINGS / 1.25, channels, "PCM_24")
    run = read_recording(path, calibrations=BOTH)
    assert run["torque"] == pytest.approx(TORQUE, abs=1e-4)
    assert run["angle"] == pytest.approx(ANGLE, abs=1e-4)
    assert run.channels[0].full_scale == pytest.approx(1250.0 * CELL.gain)


def test_what_is_said_to_be_uncalibrated_is_calibrated_too(tmp_path):
    plain = [{"name": "torque"}, {"name": "angle"}]
    path = written(tmp_path, [1e3 * READINGS[0], READINGS[1]], plain, calibrated=False)
    assert read_recording(path, calibrations=BOTH)["torque"] == pytest.approx(TORQUE, abs=1e-4)


def test_a_file_that_knows_its_units_keeps_them(tmp_path):
    path = written(tmp_path, READINGS, [volts("torque", "N m"), volts("angle")])
    run = read_recording(path, calibrations=BOTH)
    assert run["torque"] == pytest.approx(READINGS[0])
    assert run["angle"] == pytest.approx(ANGLE, abs=1e-5)


def test_an_option_wins_over_the_calibration_of_the_chain(tmp_path):
    path = written(tmp_path, READINGS[:1], [volts("pressure")])
    microphone = {"pressure": Calibration.line(0.0433)}
    assert read_recording(path, calibrations=microphone)["pressure"][0] == pytest.approx(
        -0.4 / 0.0433
    )
    assert read_recording(path, calibrations=microphone, full_scale=10.0)["pressure"][0] == (
        pytest.approx(-4.0)
    )


def test_readings_just_outside_are_told(tmp_path):
    path = written(tmp_path, [np.linspace(-480.0, 500.0, 64)], [volts("torque", "mV")])
    run = read_recording(path, calibrations=BOTH)
    assert run["torque"][-1] == pytest.approx(40.0 + 12.0 * 20.0 / 245.0)
    assert run.notes == ("torque was read up to 1.2% of its span outside of cell.csv",)


@pytest.mark.parametrize(
    ("samples", "channel", "subtype", "reason"),
    [
        (
            [0.0, 0.6],
            volts("torque"),
            "FLOAT",
            "reads 0.6, outside of cell.csv .-0.483 to",
        ),
        ([0.0, 0.1], volts("torque", "counts"), "FLOAT", "is in counts, and cell.csv in mV"),
        ([0.0, 0.1], volts("torque"), "PCM_16", "holds fractions of full scale"),
        ([0.0, 0.1], {"name": "torque"}, "PCM_16", "state its unit, 'mV', and scale"),
        ([0.0, 0.1], volts("torque", "kV"), "FLOAT", "has unit 'kV', expected 'N m'"),
    ],
)
def test_what_cannot_be_calibrated_is_refused_in_one_line(
    tmp_path, samples, channel, subtype, reason
):
    path = written(tmp_path, [np.linspace(*samples, 64)], [channel], subtype)
    with pytest.raises(RecordingError, match=reason) as refused:
        read_recording(path, calibrations=BOTH)
    assert "channel 'torque'" in str(refused.value)
    assert "\n" not in str(refused.value)
