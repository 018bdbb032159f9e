"""Units as files spell them: what each is, and what is no unit of anything."""

import math

import pytest

from models.units import kind_of_unit, split_unit

G = 9.80665


@pytest.mark.parametrize(
    ("spelling", "kind", "value"),
    [
        *((unit, "pressure", 1.0) for unit in ("Pascal", "[Pa]", "PA", "N/m^2", "N/m²", "Pa")),
        *((unit, "torque", 1.0) for unit in ("N-m", "N·m", "Nm", "N*m", "NM", "Newton-Meter")),
        *((unit, "acceleration", 1.0) for unit in ("m/s²", "m/s**2", "M/S2", "m s^-2", "(m/s^2)")),
        *((unit, "speed", math.pi / 30) for unit in ("U/min", "rpm", "RPM", "1/min", "r.p.m.")),
        ("g", "acceleration", G), ("G", "acceleration", G), ("mg", "acceleration", G / 1e3),
        ("µPa", "pressure", 1e-6), ("MPa", "pressure", 1e6), ("mPa", "pressure", 1e-3),
        ("kN", "force", 1e3), ("KN", "force", 1e3), ("Degrees", "angle", math.pi / 180),
    ],
)  # fmt: skip
def test_spellings_of_channels(spelling, kind, value):
    assert kind_of_unit(spelling) == (kind, pytest.approx(value))


@pytest.mark.parametrize("spelling", ["V", "dB", "", "MN", "MPA", "nm", "kn", "%", "counts", "ms"])
def test_units_of_no_channel_or_of_several(spelling):
    assert kind_of_unit(spelling) is None


@pytest.mark.parametrize(
    ("heading", "parts"),
    [
        ("Time (ms)", ("Time", "ms")),
        ("Beschl. [m/s²]", ("Beschl.", "m/s²")),
        ("Kraft / kN", ("Kraft", "kN")),
        ("acceleration_g", ("acceleration", "g")),
        ("pressure_2", ("pressure_2", "")),
        ("Response", ("Response", "")),
    ],
)
def test_headings_are_parted_into_name_and_unit(heading, parts):
    assert split_unit(heading) == parts
