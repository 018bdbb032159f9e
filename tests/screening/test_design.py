"""Design files: what they say, and what is refused by name."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.screening.design import axis_values, load_design, read_tolerances
from noise.screening.environments import environment, in_environment
from noise.screening.parts import factor_of, varied
from noise.screening.vibration import Condition

DESIGN = """\
name = "rig"
material = "our rubber"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = 10.7
kinetic_torque_Nm = 8.0
damping_Nms_rad = { "2214" = 0.105, fixed = 0.085 }
[design]
name = "softer"
speed_rad_s = "1..5/5"
interference_mm = [0.25, 0.3]
support_stiffness_Nm_rad = [2214, "fixed"]
temperature_C = [-10, 23]
oscillation = { amplitude_deg = 15, frequency_hz = "1..2/3" }
[tolerances]
elastomer_stiffness = 0.05
interference = 0.04
kinetic_torque = { low = 7.5, high = 8.5 }
"""


def written(folder, text):
    path = folder / "softer.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_design_file_says_rig_use_and_tolerances(tmp_path):
    design = load_design(written(tmp_path, DESIGN))
    assert design.name == "softer"
    assert design.rig.fit(0.279e-3).critical_torque == 10.7
    assert design.use.speed == (1.0, 2.0, 3.0, 4.0, 5.0)
    assert design.use.support_stiffness == (2214.0, math.inf)
    assert design.use.interference == (0.25e-3, 0.3e-3)
    assert design.use.swinging.frequency == (1.0, 1.5, 2.0)
    assert design.use.swinging.peak_speed[0] == pytest.approx(2 * math.pi * math.radians(15))
    assert [t.name for t in design.tolerances] == [
        "elastomer_stiffness", "interference", "kinetic_torque",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (("[design]", "[design]\ncolour = 1"), "unknown key 'colour'"),
        (('name = "rig"', 'colour = "red"'), "unknown key 'colour'"),
        (('"1..5/5"', '"5..1"'), "a range rises"),
        (('"1..5/5"', '"1..5/x"'), "whole number from 2"),
        (('"1..5/5"', "[0.0]"), "values must be above 0"),
        (('"1..5/5"', "true"), "give numbers"),
        (('[2214, "fixed"]', '["soft"]'), "expected numbers"),
        (("[0.25, 0.3]", "[0.25, 12]"), "must be at most 10"),
        (("[-10, 23]", "[-300]"), "above -273.15"),
        (("amplitude_deg = 15, ", ""), "amplitude_deg is missing"),
        (("elastomer_stiffness = 0.05", "stiffness = 0.05"), "unknown key 'stiffness'"),
        (("elastomer_stiffness = 0.05", 'elastomer_stiffness = "5 %"'), "must be a number"),
        (("low = 7.5, high = 8.5", "low = 7.5"), "give a number, or low and high"),
        (("low = 7.5, high = 8.5", "low = 8.5, high = 7.5"), "is not below high"),
        (("critical_torque_Nm = 10.7", "critical_torque_Nm = 7.0"), "is below kinetic_torque"),
    ],
)
def test_what_cannot_be_used_is_named_with_its_file(tmp_path, changed, message):
    path = written(tmp_path, DESIGN.replace(*changed))
    with pytest.raises(ParameterError, match=message) as refused:
        load_design(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@given(
    st.floats(0.01, 50.0).map(lambda x: round(x, 4)),
    st.floats(0.01, 50.0).map(lambda x: round(x, 4)),
    st.integers(2, 200),
)
def test_a_range_has_its_ends_and_as_many_points_as_asked(low, wide, points):
    values = axis_values(f"{low}..{low + wide}/{points}", "--speed")
    assert len(values) == points
    assert values[0] == pytest.approx(low)
    assert values[-1] == pytest.approx(low + wide)
    assert all(a < b for a, b in pairwise(values))


def test_tolerances_become_factors_on_the_nominal_value():
    damping, fit = read_tolerances(
        {"damping": 0.1, "interference": {"low": 0.2, "high": 0.3}}, "design"
    )
    assert factor_of(damping, 0.1).stats() == pytest.approx((1.0, 0.1**2))
    assert factor_of(fit, 0.25).support() == pytest.approx((0.8, 1.2))


def test_a_critical_torque_is_never_below_the_kinetic_one():
    design = load_design("fluorocarbon-thesis")
    rig, _ = varied(design.rig, Condition(5.0, 0.279e-3, 3745.0), {"critical_torque": 0.5})
    assert all(fit.critical_torque == fit.kinetic_torque for fit in rig.fits)


@pytest.mark.parametrize("factors", [{"damping": 0.0}, {"damping": math.nan}])
def test_a_factor_that_cannot_be_used_is_refused(factors):
    design = load_design("PDMS")
    with pytest.raises(ParameterError):
        varied(design.rig, Condition(5.0, 0.279e-3, 3745.0), factors)


@pytest.mark.parametrize("name", ["cold", "hot"])
def test_what_a_material_says_of_temperature_stands_in_for_the_factors_of_cold_and_hot(name):
    rig = load_design("fluorocarbon").rig
    assert in_environment(rig, environment(name)) is rig
    assert in_environment(rig, environment("wet")) is not rig


def test_a_changed_design_has_the_use_and_the_tolerances_of_its_base(tmp_path):
    (tmp_path / "one.toml").write_text(
        'base = "fluorocarbon"\n[design]\nname = "one"\ninterference_mm = [0.279]\n'
        "[tolerances]\nelastomer_stiffness = 0.05\n"
    )
    (tmp_path / "two.toml").write_text('base = "one.toml"\n[change]\ndamping = "x2"\n')
    one, two = (load_design(tmp_path / f"{name}.toml") for name in ("one", "two"))
    assert (two.name, two.use, two.tolerances) == ("two", one.use, one.tolerances)
    assert two.use.interference == pytest.approx((0.279e-3,))
