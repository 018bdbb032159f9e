"""Rig files that change a base, and the plausibility of what they say."""

import math

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from models.plausible import BOUNDS, remark, rig_remarks
from models.rig_files.rig_file import load_material_rig, load_rig
from models.rig_files.shipped import material_names

RIG = load_material_rig("fluorocarbon")
NAMES = ("elastomer_stiffness", "damping", "elastomer_inertia", "clamp_inertia", "ageing_time")
FIT = """
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = 10.7
kinetic_torque_Nm = 8.0
damping_Nms_rad = 0.09
"""


def written(folder, text, name="rig.toml"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", material_names())
def test_a_base_alone_is_the_material_to_the_bit(tmp_path, name):
    assert load_rig(written(tmp_path, f'base = "{name.upper()}"')) == load_material_rig(name)


@given(
    name=st.sampled_from(NAMES),
    power=st.integers(min_value=-6, max_value=6),
)
def test_a_factor_and_its_inverse_give_the_same_rig(name, power):
    there = RIG.changed(**{name: f"x{2.0**power}"})
    assert there.changed(**{name: f"x{2.0**-power}"}) == RIG
    assert (there == RIG) == (power == 0)


@given(percent=st.floats(min_value=-90.0, max_value=400.0))
def test_a_percentage_is_a_factor(percent):
    changed = RIG.changed(damping=f"{percent:+.6f} %").fits[0].damping[2214.0]
    assert math.isclose(
        changed, RIG.fits[0].damping[2214.0] * (1.0 + percent / 100.0), abs_tol=1e-7
    )


def test_a_number_by_the_long_name_holds_at_every_fit_and_support():
    rig = RIG.changed(damping_Nms_rad=0.09)
    assert {value for fit in rig.fits for value in fit.damping.values()} == {0.09}
    assert rig.friction == RIG.friction


def test_a_chain_of_files_changes_what_each_names(tmp_path):
    (tmp_path / "deep").mkdir()
    written(tmp_path, 'base = "fluorocarbon"\n[change]\ndamping = "x2"', "a.toml")
    written(tmp_path / "deep", 'base = "../a.toml"\n[change]\ndamping = "x0.5"', "b.toml")
    text = 'base = "deep/b.toml"\n[change]\nslip_pulse.amplitude = "x0.5"\n[design]\nname = "c"'
    rig = load_rig(written(tmp_path, text))
    assert rig.fits == RIG.fits
    assert rig.effects[0].parameters == {"amplitude": 45.0, "threshold": 5.2}


def test_friction_without_a_law_changes_parameters_of_the_law_that_stays(tmp_path):
    rig = load_rig(written(tmp_path, 'base = "fluorocarbon"\n[friction]\nageing_time = 1e-3'))
    assert rig == RIG.changed(ageing_time=1e-3)
    plain = load_rig(written(tmp_path, 'base = "fluorocarbon"\n[friction]\nlaw = "coulomb"'))
    assert plain.friction.parameters == {}
    assert plain.effects == RIG.effects


def test_own_fits_on_a_base_keep_its_law(tmp_path):
    rig = load_rig(written(tmp_path, 'base = "fluorocarbon"' + FIT))
    assert rig.friction == RIG.friction
    assert [fit.critical_torque for fit in rig.fits] == [10.7]


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ('material = "Fluorocarbon"' + FIT, ('base = "fluorocarbon"', 'law = "coulomb"')),
        ('base = "fluorcarbon"', ("did you mean 'fluorocarbon'",)),
        ('base = "rig.toml"', ("leads back to itself", "rig.toml -> rig.toml")),
        ('base = "pdms"\nmaterial = "fluorocarbon"', ("contradicts base",)),
        ("desing = 3", ("did you mean 'design'", "measured_response")),
        ('[change]\ndampin = "x2"', ("did you mean 'damping'", "slip_pulse.amplitude")),
        ("[change]\ndamping = 0.1", ("write damping_Nms_rad = 0.1",)),
        ('[change]\ndamping = "20 %"', ("with its sign",)),
        ('[change]\ndamping = "x0"', ("a factor above 0",)),
        ('[change]\ninterference_mm = "x2"', ("operating condition", "--interference")),
        ('[change]\ncritical_torque = "x0.1"', ("critical_torque = 0.5892",)),
        ('[change]\nslip_pulse.duration = "x2"', ("slip_pulse.duration", "as a number")),
        ('[change]\ndamping = "x2"\ndamping_Nms_rad = 0.1', ("damping is changed twice",)),
        ('[change]\ncritical_torque = "x1e9"', ("cannot be; possible is",)),
        ('[change]\nelastomer_damping_share = "x9"', ("at most 1",)),
        ("[sensors]\nnoise = 3", ("from recordings",)),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(tmp_path, text, parts):
    with pytest.raises(ParameterError) as refused:
        load_rig(written(tmp_path, text))
    assert all(part in str(refused.value) for part in parts), str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_name_that_means_several_quantities_is_refused_with_them(tmp_path):
    text = 'effects = ["slip_pulse:amplitude=60", "mains_hum:amplitude=1"]\n[change]\n'
    with pytest.raises(ParameterError, match=r"slip_pulse\.amplitude or mains_hum\.amplitude"):
        load_rig(written(tmp_path, text + 'amplitude = "x2"'))
    rig = load_rig(written(tmp_path, text + 'mains_hum.amplitude = "x2"'))
    assert [effect.parameters["amplitude"] for effect in rig.effects] == [60.0, 2.0]


def test_a_name_of_the_bushing_is_the_bushings_although_an_effect_has_one_alike(tmp_path):
    text = 'base = "fluorocarbon"\neffects = ["room_reflections:length=4.5"]\n[change]\n'
    longer = load_rig(written(tmp_path, text + 'length = "x2"'))
    assert longer.sleeve.length == 2.0 * RIG.sleeve.length
    assert longer.effects[0].parameters == {"length": 4.5}
    room = load_rig(written(tmp_path, text + "room_reflections.length = 9.0"))
    assert room.sleeve == RIG.sleeve
    assert room.effects[0].parameters == {"length": 9.0}


@pytest.mark.parametrize("name", material_names())
def test_what_is_shipped_is_plausible(name):
    assert rig_remarks(load_material_rig(name)) == ()


@pytest.mark.parametrize("name", BOUNDS)
def test_the_possible_holds_the_usual(name):
    bounds = BOUNDS[name]
    assert bounds.possible[0] <= bounds.usual[0] < bounds.usual[1] <= bounds.possible[1]
    assert remark(name, *bounds.usual) == ""
    assert remark(name, 2.0 * bounds.usual[1]).startswith(name.removeprefix("fit_"))


def test_wrong_units_are_guessed():
    rig = RIG.changed(critical_torque="x1000", kinetic_torque="x1000")
    assert [("Nmm?" in text) for text in rig_remarks(rig)] == [True, True]
    assert "metres?" in remark("interference_mm", 0.000279)
