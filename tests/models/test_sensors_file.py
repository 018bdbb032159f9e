"""The sensors of a rig file."""

import pytest

from models.errors import ParameterError
from models.plausible import rig_remarks
from models.rig_files.rig_file import load_material_rig, load_rig
from models.sensors import Sensor, Sensors

THESIS = """
[sensors]
noise = { torque = 0.02 }
range = { torque = 102.5, acceleration = 976.75, pressure = 28.86, angle = 12.375 }
bits = 12
antialias_hz = 14000
"""


def loaded(tmp_path, text, name="rig.toml"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return load_rig(tmp_path / name)


def test_the_converter_of_the_thesis_has_its_steps(tmp_path):
    sensors = loaded(tmp_path, THESIS).sensors
    steps = {kind: sensors.of(kind).step for kind in ("torque", "acceleration", "pressure")}
    assert steps == pytest.approx(
        {"torque": 0.05, "acceleration": 0.477, "pressure": 0.0141}, rel=0.01
    )
    assert sensors.of("torque") == Sensor(0.02, 102.5, 12, 14000.0)
    assert sensors.of("force") == Sensor(antialias=14000.0)


def test_nothing_said_is_nothing_changed(tmp_path):
    assert loaded(tmp_path, "").sensors == load_material_rig("PDMS").sensors == Sensors()


def test_a_file_changes_of_its_base_what_it_says(tmp_path):
    loaded(tmp_path, THESIS, "base.toml")
    finer = 'base = "base.toml"\n[sensors]\nbits = { torque = 16 }\nnoise = { pressure = 0.01 }'
    sensors = loaded(tmp_path, finer).sensors
    assert sensors.of("torque") == Sensor(0.02, 102.5, 16, 14000.0)
    assert sensors.of("pressure") == Sensor(0.01, 28.86, 12, 14000.0)


def test_noise_is_stated_or_estimated_whoever_says_so_last(tmp_path):
    estimated = '[sensors]\nnoise = "from recordings"'
    loaded(tmp_path, THESIS, "stated.toml")
    over = loaded(tmp_path, f'base = "stated.toml"\n{estimated}', "estimated.toml").sensors
    assert over.noise_from_recordings
    assert over.of("torque") == Sensor(None, 102.5, 12, 14000.0)
    back = loaded(tmp_path, 'base = "estimated.toml"\n[sensors]\nnoise = { torque = 0.1 }').sensors
    assert not back.noise_from_recordings
    assert back.of("torque").noise == 0.1


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("ragne = { torque = 1 }", ("'ragne'", "did you mean 'range'")),
        ("range = { torqe = 1 }", ("sensors, range", "did you mean 'torque'")),
        ("range = 50", ("range = 50", "{ torque = 50 }")),
        ("range = { torque = -1 }", ("torque = -1", "above 0")),
        ('range = { torque = "50 Nm" }', ("torque = '50 Nm'", "a number")),
        ("bits = 12", ("bits without a range", "range = { torque = ... }")),
        ("range = { torque = 50 }\nbits = { pressure = 12 }", ("bits of pressure without",)),
        ("range = { torque = 50 }\nbits = 12.5", ("bits = 12.5", "whole number")),
        ("range = { torque = 50 }\nbits = 64", ("bits = 64 cannot be", "2 to 32")),
        ("antialias_hz = 0", ("antialias_hz = 0", "above 0")),
        ("antialias_hz = { torque = 0.5 }", ("antialias_hz = 0.5 cannot be",)),
        ("noise = { torque = -0.1 }", ("torque = -0.1", "at least 0")),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(tmp_path, text, parts):
    with pytest.raises(ParameterError) as refused:
        loaded(tmp_path, f"[sensors]\n{text}")
    assert all(part in str(refused.value) for part in parts), str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_is_unusual_is_told(tmp_path):
    text = "[sensors]\nrange = { torque = 2e5 }\nbits = 4\nantialias_hz = { pressure = 12 }"
    said = rig_remarks(loaded(tmp_path, text))
    assert [line.split(" = ")[0] for line in said] == ["range.torque", "bits", "antialias_hz"]
    assert said[-1].endswith("(is it in kHz?)")
    assert rig_remarks(loaded(tmp_path, THESIS)) == ()
