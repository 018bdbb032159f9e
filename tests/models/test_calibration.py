"""Calibration of a chain: tables of readings, lines, and what cannot be one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.calibration import Calibration
from models.errors import ParameterError
from models.rig_file import load_rig, rig_text

CELL = """reading_mV,torque_Nm
-483,-40
-240,-20
0,0
243,20
488,40
"""
"""From Table C1 of the thesis."""


@st.composite
def tables(draw):
    steps = draw(st.lists(st.floats(0.05, 1.0), min_size=2, max_size=12))
    slopes = draw(st.lists(st.floats(0.2, 5.0), min_size=len(steps), max_size=len(steps)))
    sign = draw(st.sampled_from([-1.0, 1.0]))
    readings = np.cumsum([draw(st.floats(-5.0, 5.0)), *steps])
    values = sign * np.cumsum([draw(st.floats(-5.0, 5.0)), *np.multiply(steps, slopes)])
    return Calibration(tuple(readings.tolist()), tuple(values.tolist()))


@given(table=tables(), out=st.floats(0.0, 0.2))
def test_readings_outside_are_carried_on_by_a_twentieth_and_refused_beyond(table, out):
    low, high = table.readings[0], table.readings[-1]
    readings = np.array([low, high + out * (high - low)])
    if out > 0.0501:
        with pytest.raises(ParameterError, match="by more than 5% of its span"):
            table.of(readings)
    elif out < 0.0499:
        slope = np.diff(table.values[-2:]) / np.diff(table.readings[-2:])
        expected = table.values[-1] + slope[0] * (readings[1] - high)
        assert table.of(readings)[1] == pytest.approx(expected, abs=1e-9)


def loaded(tmp_path, text, **files):
    for name, content in files.items():
        (tmp_path / f"{name}.csv").write_text(content, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(f"[sensors]\n{text}", encoding="utf-8")
    return load_rig(tmp_path / "rig.toml").sensors.calibrations


def test_sensors_written_out_are_read_back(tmp_path):
    text = """noise = { torque = 0.02 }
range = { torque = 102.5, pressure = 28.86 }
bits = 12
antialias_hz = { pressure = 12000 }
calibration.torque = "cell.csv"
calibration.angle = { sensitivity = -0.101, offset = -7e-4, reading = "V" }
"""
    loaded(tmp_path, text, cell=CELL)
    rig = load_rig(tmp_path / "rig.toml")
    (tmp_path / "again.toml").write_text(rig_text(rig), encoding="utf-8")
    again = load_rig(tmp_path / "again.toml").sensors
    for kind in ("torque", "pressure"):
        one, other = (replace(x.of(kind), calibration=None) for x in (rig.sensors, again))
        assert one == other
    for kind, readings in (("torque", [-400.0, 30.0, 470.0]), ("angle", [-1.0, 0.3])):
        one, other = (x.calibrations[kind] for x in (rig.sensors, again))
        assert one.unit == other.unit
        assert other.of(np.array(readings)) == pytest.approx(one.of(np.array(readings)))


def test_the_cell_of_the_thesis_gives_82_newton_metres_a_volt(tmp_path):
    text = 'calibration = { torque = "cell.csv", angle = { sensitivity = 0.101, offset = -7e-4 } }'
    found = loaded(tmp_path, text, cell=CELL)
    assert 1e3 * found["torque"].gain == pytest.approx(82.4, abs=0.1)
    assert found["torque"].of(np.array([-240.0, 121.5])).tolist() == [-20.0, 10.0]
    assert found["angle"].gain == pytest.approx(9.9, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "cell", "parts"),
    [
        ('calibration = { torqe = "cell.csv" }', CELL, ("did you mean 'torque'",)),
        ("calibration = { torque = 82 }", CELL, ("torque = 82", '"cell.csv"', "sensitivity")),
        ("calibration = { torque = { sensitivity = 0 } }", CELL, ("sensitivity = 0",)),
        ("calibration = { torque = { sensitivity = 1, reading = 'kV' } }", CELL, ("counts",)),
        (None, "", ("holds no rows of numbers",)),
        (None, "reading_mV,torque\n1,2\n2,3\n3,4", ("torque_Nm", "did you mean 'torque_Nm'")),
        (None, CELL.replace("torque_Nm", "angle_rad"), ("expected torque_Nm",)),
        (None, CELL.replace("243,20", "nan,20"), ("must be finite numbers",)),
        (None, CELL.replace("243,20", "243;20"), ("line 6 has 1 columns",)),
        (None, CELL.replace("243,20", "-243,20"), ("from torque_Nm = 0 to 20", "0 to -243")),
        (None, CELL.replace("243,20", "243,0"), ("torque_Nm = 0 is in it twice",)),
        (
            "calibration.torque = { reading_mV = [0, 1, 2], torque_Nm = [0, 82] }",
            CELL,
            ("torque_Nm and reading_mV must be finite numbers",),
        ),
        (None, "reading_V,torque_Nm\n0,0\n1,82", ("has 2 rows", "are a line")),
    ],
)  # fmt: skip
def test_what_cannot_be_a_calibration_is_refused_in_one_line(tmp_path, text, cell, parts):
    with pytest.raises(ParameterError) as refused:
        loaded(tmp_path, text or 'calibration = { torque = "cell.csv" }', cell=cell)
    assert all(part in str(refused.value) for part in parts), str(refused.value)
    assert "\n" not in str(refused.value)
