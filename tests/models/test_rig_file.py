"""Rig and material files."""

import math

import pytest

from models.errors import ParameterError
from models.rig import damping_at
from models.rig_files.rig_file import load_material_rig, load_rig
from models.rig_files.rig_parts import parse_spec
from models.rig_files.shipped import material_names

CONTRACT = """
name = "bench"
material = "fluorocarbon"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
effects = []
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = 10.7
kinetic_torque_Nm = 8.0
damping_Nms_rad = { "2214" = 0.105, "3745" = 0.085, fixed = 0.085 }
[friction]
law = "coulomb"
"""


def written(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_rig_with_its_own_fits_is_the_plain_model_with_constant_torques(tmp_path):
    rig = load_rig(written(tmp_path, CONTRACT))
    assert rig.friction.name == "coulomb"
    assert rig.effects == ()
    assert rig.elastomer_damping_share == 0.5
    assert rig.fit(0.279e-3).critical_torque == 10.7
    assert damping_at(rig.fit(0.279e-3), math.inf) == 0.085


def test_a_rig_without_fits_takes_them_from_its_material(tmp_path):
    rig = load_rig(written(tmp_path, 'name = "car"\nmaterial = "pdms"'))
    assert rig.material == "PDMS"
    assert rig.fits == load_material_rig("PDMS").fits


def test_a_single_damping_holds_for_every_support(tmp_path):
    text = CONTRACT.replace('{ "2214" = 0.105, "3745" = 0.085, fixed = 0.085 }', "0.09")
    fit = load_rig(written(tmp_path, text)).fit(0.279e-3)
    assert {damping_at(fit, k) for k in (1e3, 3e3, math.inf)} == {0.09}


def test_part_of_a_table_replaces_that_part(tmp_path):
    text = CONTRACT + "[plate]\nthickness_m = 0.012\n"
    plate = load_rig(written(tmp_path, text)).plate
    assert plate.thickness == 0.012
    assert plate.length == load_material_rig("PDMS").plate.length


def test_effects_of_the_file_are_on(tmp_path):
    text = CONTRACT.replace("effects = []", 'effects = ["slip_pulse:amplitude=120"]')
    (spec,) = load_rig(written(tmp_path, text)).effects
    assert str(spec) == "slip_pulse:amplitude=120"


def test_every_shipped_material_makes_a_rig():
    for name in material_names():
        rig = load_material_rig(name.upper())
        assert rig.material == name
        assert all(fit.critical_torque >= fit.kinetic_torque for fit in rig.fits)


def test_between_fits_properties_are_interpolated_and_outside_held():
    rig = load_material_rig("fluorocarbon-thesis")
    assert rig.fit(0.33e-3).elastomer_stiffness == pytest.approx(838.0)
    assert rig.fit(1e-3) == rig.fits[-1]
    assert rig.fit(1e-6).kinetic_torque == rig.fits[0].kinetic_torque


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("clamp_inertia_kgm2 = 8.333e-4", "clamp_inertia_kgm2 = 0"), "clamp_inertia_kgm2 = 0"),
        (("clamp_inertia_kgm2 = 8.333e-4", "clamp_inertia = 1.0"), "unknown key 'clamp_inertia'"),
        (("= 665.0", "= -1.0"), "elastomer_stiffness_Nm_rad = -1.0 must be a number above 0"),
        (("= 665.0", "= nan"), "elastomer_stiffness_Nm_rad = nan"),
        (("= 665.0", '= "stiff"'), "elastomer_stiffness_Nm_rad = 'stiff'"),
        (("critical_torque_Nm = 10.7", "critical_torque_Nm = 7.0"), "below kinetic_torque_Nm"),
        (("elastomer_stiffness_Nm_rad = 665.0", ""), "elastomer_stiffness_Nm_rad is missing"),
        (('"3745"', '"stiff"'), "entry 'stiff'"),
        (("effects = []", 'effects = "none"'), "effects must be a list"),
        (("effects = []", 'effects = ["slip_pulse:loud"]'), "NAME:key=value"),
        (('name = "bench"', "name = 3"), "name = 3 must be a text"),
        (("[[fit]]", "[fit"), "no TOML"),
        (("[[fit]]", "[plate]\nthickness_m = -1\n[[fit]]"), "thickness_m = -1"),
        (("[[fit]]", "[plate]\nclamp_position_m = [9, 0]\n[[fit]]"), "lies off the plate"),
        (("[[fit]]", "[microphone]\nposition_m = [0, 0, -1]\n[[fit]]"), "above the plate"),
        (("[[fit]]", "[microphone]\nposition_m = [0, 0]\n[[fit]]"), "a list of 3 numbers"),
        (("[[fit]]", "[plate]\nlength_m = 1e6\n[[fit]]"), "modes up to 16 kHz"),
        (("[[fit]]", "[plate]\nthickness_m = 1e3\n[[fit]]"), "modes up to 16 kHz"),
        (("effects = []", "assumed = 3"), "assumed must be a list"),
        (("= 665.0", "= true"), "elastomer_stiffness_Nm_rad = True"),
        (("= 665.0", f"= {10**400}"), "elastomer_stiffness_Nm_rad"),
    ],
)
def test_a_rig_that_cannot_be_used_is_refused_by_key(tmp_path, change, message):
    with pytest.raises(ParameterError) as refused:
        load_rig(written(tmp_path, CONTRACT.replace(*change)))
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"nowhere\.toml"):
        load_rig(tmp_path / "nowhere.toml")


def test_an_unknown_material_is_refused_with_the_known_ones():
    with pytest.raises(ParameterError, match="PDMS"):
        load_material_rig("teflon")


def test_a_specification_is_read_as_it_is_written():
    assert str(parse_spec("slip_pulse:amplitude=20,threshold=3.5")) == (
        "slip_pulse:amplitude=20,threshold=3.5"
    )


def test_a_fit_that_is_no_table_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="fit must be given as"):
        load_rig(written(tmp_path, "fit = 3"))
