"""Rig and material files: what they make of a base, what is refused, and writing."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from models.rig import Rig, damping_at
from models.rig_file import changed_rig_text, load_material_rig, load_rig, material_names, rig_text
from models.schema import remarks
from models.sensors import Sensor, Sensors

RIG = load_material_rig("fluorocarbon")
NAMES = ("elastomer_stiffness", "damping", "elastomer_inertia", "clamp_inertia", "ageing_time")
FIT = """
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = 10.7
kinetic_torque_Nm = 8.0
damping_Nms_rad = { "2214" = 0.105, "3745" = 0.085, fixed = 0.085 }
"""
CONTRACT = f"""
name = "bench"
material = "fluorocarbon"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
effects = []
{FIT}
[friction]
law = "coulomb"
"""
CONVERTER = """
[sensors]
noise = { torque = 0.02 }
range = { torque = 102.5, acceleration = 976.75, pressure = 28.86, angle = 12.375 }
bits = 12
antialias_hz = 14000
"""


def loaded(folder, text, name="rig.toml"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return load_rig(path)


def test_a_rig_with_its_own_fits_is_the_plain_model_with_constant_torques(tmp_path):
    rig = loaded(tmp_path, CONTRACT)
    assert (rig.friction.name, rig.effects, rig.sleeve) == ("coulomb", (), None)
    assert rig.elastomer_damping_share == 0.5
    assert rig.fit(0.279e-3).critical_torque == 10.7
    assert damping_at(rig.fit(0.279e-3), math.inf) == 0.085
    text = CONTRACT.replace('{ "2214" = 0.105, "3745" = 0.085, fixed = 0.085 }', "0.09")
    fit = loaded(tmp_path, text).fit(0.279e-3)
    assert {damping_at(fit, k) for k in (1e3, 3e3, math.inf)} == {0.09}


@pytest.mark.parametrize("name", material_names())
def test_a_shipped_material_makes_a_plausible_rig_as_a_base_to_the_bit(tmp_path, name):
    rig = load_material_rig(name.upper())
    assert rig.material == name
    assert remarks(rig) == ()
    assert loaded(tmp_path, f'base = "{name.lower()}"') == rig
    assert loaded(tmp_path, f'material = "{name.lower()}"').fits == rig.fits


def test_a_chain_of_files_changes_what_each_names(tmp_path):
    (tmp_path / "deep").mkdir()
    loaded(tmp_path, 'base = "fluorocarbon"\n[change]\ndamping = "x2"', "a.toml")
    loaded(tmp_path / "deep", 'base = "../a.toml"\n[change]\ndamping = "x0.5"', "b.toml")
    text = 'base = "deep/b.toml"\n[change]\nslip_pulse.amplitude = "x0.5"\n[design]\nname = "c"'
    rig = loaded(tmp_path, text)
    assert rig.fits == RIG.fits
    assert rig.effects[0].parameters == {"amplitude": 45.0, "threshold": 5.2}


def test_a_base_keeps_its_law_unless_another_is_named(tmp_path):
    rig = loaded(tmp_path, 'base = "fluorocarbon"\n[friction]\nageing_time = 1e-3')
    assert rig == RIG.changed(ageing_time=1e-3)
    plain = loaded(tmp_path, 'base = "fluorocarbon"\n[friction]\nlaw = "coulomb"')
    assert (plain.friction.parameters, plain.effects) == ({}, RIG.effects)
    own = loaded(tmp_path, 'base = "fluorocarbon"' + FIT)
    assert own.friction == RIG.friction
    assert [fit.critical_torque for fit in own.fits] == [10.7]


# Changes


@given(name=st.sampled_from(NAMES), power=st.integers(min_value=-6, max_value=6))
def test_a_factor_and_its_inverse_give_the_same_rig(name, power):
    there = RIG.changed(**{name: f"x{2.0**power}"})
    assert there.changed(**{name: f"x{2.0**-power}"}) == RIG
    assert (there == RIG) == (power == 0)


def test_a_name_of_the_bushing_is_the_bushings_although_an_effect_has_one_alike(tmp_path):
    text = 'base = "fluorocarbon"\neffects = ["room_reflections:length=4.5"]\n[change]\n'
    longer = loaded(tmp_path, text + 'length = "x2"')
    assert longer.sleeve.length == 2.0 * RIG.sleeve.length
    assert longer.effects[0].parameters == {"length": 4.5}
    room = loaded(tmp_path, text + "room_reflections.length = 9.0")
    assert room.sleeve == RIG.sleeve
    assert room.effects[0].parameters == {"length": 9.0}


# Sensors


def test_the_converter_of_the_thesis_has_its_steps_and_a_file_changes_of_it_what_it_states(
    tmp_path,
):
    sensors = loaded(tmp_path, CONVERTER, "base.toml").sensors
    steps = {kind: sensors.of(kind).step for kind in ("torque", "acceleration", "pressure")}
    expected = {"torque": 0.05, "acceleration": 0.477, "pressure": 0.0141}
    assert steps == pytest.approx(expected, rel=0.01)
    assert sensors.of("torque") == Sensor(0.02, 102.5, 12, 14000.0)
    assert sensors.of("force") == Sensor(antialias=14000.0)
    finer = 'base = "base.toml"\n[sensors]\nbits = { torque = 16 }\nnoise = { pressure = 0.01 }'
    sensors = loaded(tmp_path, finer).sensors
    assert sensors.of("torque") == Sensor(0.02, 102.5, 16, 14000.0)
    assert sensors.of("pressure") == Sensor(0.01, 28.86, 12, 14000.0)
    assert RIG.sensors == Sensors()


# Refusals


def fit(old, new):
    return CONTRACT.replace(old, new)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("desing = 3", ("did you mean 'design'", "measured_response")),
        ('effects = "none"', ("effects must be a list",)),
        ("elastomer_damping_share = 2", ("must be a number from 0 to 1",)),
        # fits
        (fit("= 665.0", "= -1.0"), ("fit 1: elastomer_stiffness_Nm_rad = -1.0", "Nm/rad")),
        (fit("torque_Nm = 10.7", "torque_Nm = 7.0"), ("critical_torque_Nm = 7", "is below")),
        (fit('"3745"', '"stiff"'), ("entry 'stiff'", "or fixed")),
        (CONTRACT + FIT, ("two [[fit]] entries have the same interference_mm",)),
        ('material = "Fluorocarbon"' + FIT, ('base = "fluorocarbon"', 'law = "coulomb"')),
        # bases
        ('base = "fluorcarbon"', ("did you mean 'fluorocarbon'",)),
        ('base = "rig.toml"', ("leads back to itself", "rig.toml -> rig.toml")),
        ('base = "pdms"\nmaterial = "fluorocarbon"', ("contradicts base",)),
        # structure
        ("[plate]\nlenght_m = 1", (", plate: unknown key 'lenght_m'; did you mean 'length_m'",)),
        ("[plate]\nlength_m = 1e6", ("modes up to 16 kHz; it must have 5 to 5000",)),
        ("[plate]\nclamp_position_m = [9, 0]", ("lies off the plate",)),
        ("[microphone]\nposition_m = [0, 0, -1]", ("z = -1 m", "at least 0.01 m above the plate")),
        ("[beams]\nanchor_rotation_Nm_rad = 'soft'", ('a number above 0 Nm/rad, or "rigid"',)),
        # bushing
        ("[temperature]\nreference_C = -30\nglass_transition_C = -20", ("not above glass",)),
        ("[sleeve]\nhardness_shore_A = 60\nyoungs_modulus_MPa = 3", ("not both",)),
        ("[sleeve]\nhardness_shore_A = 90", ("must be a number from 20 to 80",)),
        # changes
        (FIT + "[change]\nwall_mm = 6", ("wall needs a [sleeve] table",)),
        ('[change]\ndampin = "x2"', ("did you mean 'damping'", "slip_pulse.amplitude")),
        ("[change]\ndamping = 0.1", ("write damping_Nms_rad = 0.1",)),
        ('[change]\ndamping = "20 %"', ("with its sign",)),
        ('[change]\nslip_pulse.duration = "x2"', ("slip_pulse.duration", "as a number")),
        ('[change]\ndamping = "x2"\ndamping_Nms_rad = 0.1', ("damping is changed twice",)),
        # sensors
        ("[sensors]\nnoise = 3", ("from recordings",)),
        ("[sensors]\nragne = { torque = 1 }", ("'ragne'", "did you mean 'range'")),
        ("[sensors]\nbits = 12", ("bits of torque without a range", "range = { torque = ... }")),
        ("[sensors]\nrange = { torque = 50 }\nbits = 12.5", ("bits = 12.5", "whole number")),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(tmp_path, text, parts):
    with pytest.raises(ParameterError) as refused:
        loaded(
            tmp_path,
            text if "base" in text or "fit" in text else f'base = "{RIG.material}"\n{text}',
        )
    message = str(refused.value)
    assert all(part in message for part in parts), message
    assert message.startswith(f"rig file {tmp_path / 'rig.toml'}")
    assert "\n" not in message


# Remarks


# Writing


def written_again(folder, rig, **options):
    return loaded(folder, rig_text(rig, **options), "again.toml")


def other_rig(folder) -> Rig:
    text = """
base = "fluorocarbon"
name = "Prüfstand \\"7\\""
effects = ["slip_pulse:amplitude=12.5"]
assumed = ["plate"]
[temperature]
reference_C = 40
glass_transition_C = -25.5
[plate]
loss_factor = 0.05
[microphone]
position_m = [0.1, 0.2, 0.75]
[beams]
radiate = false
anchor_rotation_Nm_rad = "rigid"
"""
    return loaded(folder, text + CONVERTER)


def test_a_rig_written_out_is_the_same_when_it_is_read(tmp_path):
    for rig in map(load_material_rig, material_names()):
        whole = replace(rig, sleeve=None, elastomer_inertia=1.5e-5, clamp_inertia=8e-4)
        assert written_again(tmp_path, whole) == whole


def test_a_rig_written_over_a_base_keeps_its_structure(tmp_path):
    rig = other_rig(tmp_path)
    changed = replace(rig.changed(damping="x2"), elastomer_inertia=1.5e-5, clamp_inertia=8e-4)
    assert written_again(tmp_path, changed, base="rig.toml") == changed


def test_changes_written_out_are_those_that_are_read(tmp_path):
    changes = {"damping": "x1.5", "slip_pulse.amplitude": "x2", "kinetic_torque_Nm": 3.5}
    text = changed_rig_text(
        "fluorocarbon", changes, RIG.effects, {"slip_pulse.amplitude": 0.02}, ["note"]
    )
    assert loaded(tmp_path, text) == RIG.changed(**changes)
