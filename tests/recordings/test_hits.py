"""Hammer hits in CSV files of loggers and spreadsheets: right values in SI, or a refusal."""

import numpy as np
import pytest

from models.errors import RecordingError
from noise.recordings.hits import read_hit

RATE = 25600.0
TIME = np.arange(400) / RATE
FORCE = np.where((TIME > 2e-3) & (TIME < 3e-3), 80 * np.sin(np.pi * (TIME - 2e-3) / 1e-3), 0.0)
RESPONSE = 30 * np.exp(-200 * TIME) * np.sin(2 * np.pi * 700 * TIME)
G = 9.80665
GERMAN = {"separator": ";", "comma": True}


def written(path, header, columns, separator=",", encoding="utf-8", comma=False):
    lines = (separator.join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    text = "\n".join(lines)
    path.write_bytes((header + (text.replace(".", ",") if comma else text)).encode(encoding))
    return path


@pytest.mark.parametrize(
    ("header", "columns", "how"),
    [
        ("", (TIME, FORCE, RESPONSE), {}),
        ("# t,F,a\n", (TIME, FORCE, RESPONSE), {}),
        ("Time (ms),Force (N),Acceleration (m/s^2)\n", (1e3 * TIME, FORCE, RESPONSE), {}),
        ("Time (s),Force [kN],Acceleration (g)\n", (TIME, FORCE / 1e3, RESPONSE / G), {}),
        ("Time,Force,Acceleration\ns,lbf,g\n", (TIME, FORCE / 4.4482216152605, RESPONSE / G), {}),
        (
            "Zeit [s];Kraft [N];Beschl. [m/s²]\n",
            (TIME, FORCE, RESPONSE),
            GERMAN | {"encoding": "cp1252"},
        ),
        (
            "sep=;\nZeit;Kraft;Beschleunigung\nms;kN;g\n",
            (1e3 * TIME, FORCE / 1e3, RESPONSE / G),
            GERMAN | {"encoding": "utf-8-sig"},
        ),
        (
            "Time\tHammer\tAcc\n(µs)\t(N)\t(m/s²)\n",
            (1e6 * TIME, FORCE, RESPONSE),
            {"separator": "\t", "encoding": "utf-16"},
        ),
        (
            "Made by Analyser 3\nSample rate,25600\n\nTime (s),Force (N),Acceleration (m/s^2)\n",
            (TIME, FORCE, RESPONSE),
            {},
        ),
    ],
)
def test_headings_units_and_separators_are_followed(tmp_path, header, columns, how):
    hit, unit = read_hit(written(tmp_path / "hit.csv", header, columns, **how))
    assert (hit.rate, unit) == (RATE, "m/s^2")
    np.testing.assert_allclose(hit.force, FORCE, atol=1e-6)
    np.testing.assert_allclose(hit.response, RESPONSE, atol=1e-6)


def test_a_pressure_in_the_heading_is_the_response(tmp_path):
    header = "Time (s),Force (N),Microphone (Pa)\n"
    path = written(tmp_path / "hit.csv", header, (TIME, FORCE, RESPONSE))
    assert read_hit(path)[1] == read_hit(path, response="pressure")[1] == "Pa"
    with pytest.raises(RecordingError, match="its response is pressure, not acceleration"):
        read_hit(path, response="acceleration")


@pytest.mark.parametrize(
    ("header", "columns", "message"),
    [
        ("Time (s),Force (N),Response (V)\n", (TIME, FORCE, RESPONSE), "'Response' is in 'V'"),
        ("t (s),F (N),v (m/s)\n", (TIME, FORCE, RESPONSE), "'v' is velocity 'm/s'"),
        ("Time,Torque (N m),Response\n", (TIME, FORCE, RESPONSE), "'Torque' is torque 'N m'"),
        ("", (FORCE, TIME, RESPONSE), "time does not rise evenly"),
        ("", (TIME, FORCE), r"has shape \(400, 2\), expected three rows or columns"),
        ("", (TIME, FORCE, RESPONSE, FORCE), r"has shape \(400, 4\)"),
        ("a,b,c\n0,1,2\n1,x,3\n", (), "b is 'x' in line 3, expected a number"),
        ("t;F;a\n1.234,5;1;2\n", (), "expected a number"),
    ],
)
def test_what_is_no_hit_in_si_is_refused(tmp_path, header, columns, message):
    path = written(tmp_path / "hit.csv", header, columns)
    with pytest.raises(RecordingError, match=message) as refused:
        read_hit(path)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


def test_rows_may_be_longer_than_a_field_of_the_csv_module(tmp_path):
    hit = np.stack([np.arange(20_000) / 25_600, *np.random.default_rng(0).normal(size=(2, 20_000))])
    np.savetxt(tmp_path / "rows.csv", hit, delimiter=",")
    np.savetxt(tmp_path / "columns.csv", hit.T, delimiter=",")
    one, other = (read_hit(tmp_path / f"{name}.csv")[0] for name in ("rows", "columns"))
    np.testing.assert_array_equal(one.force, other.force)
