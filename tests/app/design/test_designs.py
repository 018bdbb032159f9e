"""What the controls of the design view say, as rigs and rig files."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import pytest

from models.errors import ParameterError
from models.rig_file import load_rig, rig_from
from noise.app.design import design_of, save_rig
from noise.app.design_controls import bases_of, controls_of
from noise.app.opened import open_paths
from noise.commands.condition import CONDITION
from noise.commands.options import add_options

MATERIALS = bases_of(open_paths([]))
CHANGED = [
    {},
    {"change.damping": 1.7, "change.length": 0.9},
    {"change.wall": 1.2, "fixed": True, "interference": 0.381},
]


def design(values, base="fluorocarbon", bases=MATERIALS):
    return design_of({"base": base, "values": values}, bases)


@pytest.mark.parametrize("values", CHANGED)
def test_the_file_that_is_saved_is_the_rig_that_is_heard(values, tmp_path):
    said = {"base": "fluorocarbon", "values": values, "name": "mine"}
    saved = save_rig(said, MATERIALS, tmp_path)
    assert Path(saved["file"]) == tmp_path / "mine.toml"
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert 'base = "fluorocarbon"' in text
    assert load_rig(tmp_path / "mine.toml") == design(values).rig


def test_a_file_of_the_users_is_a_base_and_is_never_written_over(tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('base = "PDMS"\n[change]\ndamping = "x2"\n', encoding="utf-8")
    bases = bases_of(open_paths([mine]))
    assert next(iter(bases)) == "rig 0"
    said = {"base": "rig 0", "values": {"change.damping": 1.5}, "name": "other"}
    save_rig(said, bases, tmp_path)
    other = load_rig(tmp_path / "other.toml")
    assert other == load_rig(mine).changed(damping="x1.5")
    before = mine.read_text(encoding="utf-8")
    with pytest.raises(ParameterError, match="is open"):
        save_rig({**said, "name": "mine", "replace": True}, bases, tmp_path)
    assert mine.read_text(encoding="utf-8") == before


@pytest.mark.parametrize("name", ["../out", "", "a/b", ".hidden", "x" * 90, None, "a\nb", "c\\d"])
def test_names_that_lead_elsewhere_are_refused(name, tmp_path):
    with pytest.raises(ParameterError, match="name: must begin"):
        save_rig({"base": "PDMS", "values": {}, "name": name}, MATERIALS, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("base", ["fluorocarbon", "PDMS"])
def test_each_control_acts_and_what_is_saved_is_read_as_such(base, tmp_path):
    before = design({}, base)
    for control in controls_of(MATERIALS[base].rig):
        value = before.values[control.key]
        factor = 0.99 if control.key == "change.kinetic_torque" else 1.01  # or it is above critical
        changed = design(
            {control.key: not value if control.kind == "switch" else factor * value}, base
        )
        content = tomllib.loads(changed.text(tmp_path, "mine.toml"))
        assert rig_from(content, tmp_path, "mine.toml") == changed.rig, control.key
        of_the_rig = control.key.startswith("change.")
        assert (changed.rig != before.rig) == of_the_rig, control.key
        assert of_the_rig or changed.options != before.options, control.key


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"speed": "fast"}, "Speed fast: must be a number"),
        ({"speed": float("nan")}, "must be a number"),
        ({"interference": 99}, "Interference 99: must be a number from"),
        ({"fixed": 1}, "on or off"),
        ({"support": 20.0}, "off the plate"),
        ({"nothing": 1}, "nothing called 'nothing'"),
        ({"change.critical_torque": 0.3}, "kinetic_torque"),
    ],
)
def test_what_cannot_be_is_told_in_one_line(said, told):
    with pytest.raises(ParameterError, match=told) as caught:
        design(said)
    assert "\n" not in str(caught.value)


def test_conditions_outside_what_was_measured_are_said_to_be():
    remarks = design({"speed": 20.0, "interference": 0.45, "support": 3000.0}).remarks()
    said = " | ".join(remarks)
    assert "above 13 rad/s" in said
    assert "for 0.45 mm the nearest is held" in said
    assert "damping is given for supports of" in said
    assert design({}).remarks() == []


def test_the_condition_is_told_as_options_that_the_command_reads():
    from argparse import ArgumentParser

    parser = ArgumentParser()
    add_options(parser, [CONDITION])
    for fixed in (False, True):
        of = design({"speed": 7.5, "fixed": fixed, "temperature": 40.0})
        options = parser.parse_args(of.options.split())
        assert options.interference == 0.279
        assert options.support_stiffness == (math.inf if fixed else 2214.0)
