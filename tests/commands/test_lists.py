"""What there is to choose from: a rig file to start from, effects, materials."""

import re

import pytest

from models.rig_file import load_material_rig, load_rig, material_names
from noise.cli import main
from noise.screening.design import load_design
from sim.effects import EFFECTS


@pytest.mark.parametrize("material", material_names())
def test_a_new_rig_is_its_material_and_each_comment_can_be_used(material, tmp_path):
    path = tmp_path / "mine.toml"
    assert main(["new-rig", material.lower(), "--out", str(path)]) == 0
    shipped, rig = load_material_rig(material), load_rig(path)
    assert (rig.fits, rig.friction, rig.effects) == (
        shipped.fits,
        shipped.friction,
        shipped.effects,
    )
    text = path.read_text(encoding="utf-8")
    used = re.sub(r"^# (?=\w+ = |\[)", "", text, flags=re.MULTILINE)
    path.write_text(used, encoding="utf-8")
    changed = load_design(path)
    assert changed.use.speed[0] == 0.25
    assert len(changed.tolerances) == 2
    assert changed.rig.sensors is not None
    stiffness = shipped.fits[0].elastomer_stiffness
    assert changed.rig.fits[0].elastomer_stiffness == pytest.approx(0.9 * stiffness)


def test_a_file_that_is_there_is_not_replaced(tmp_path, capsys):
    path = tmp_path / "mine.toml"
    path.write_text("mine")
    assert main(["new-rig", "--out", str(path)]) == 2
    assert path.read_text() == "mine"
    assert "exists already" in capsys.readouterr().err


def test_all_effects_and_materials_are_listed(capsys):
    assert main(["effects"]) == main(["materials"]) == 0
    out = capsys.readouterr().out
    assert all(re.search(rf"^{name} \(", out, re.MULTILINE) for name in EFFECTS)
    assert all(f"  {key}=" in out for one in EFFECTS.values() for key in one.parameters)
    assert all(re.search(rf"^{name}$", out, re.MULTILINE) for name in material_names())


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        ("lable x", "'label'"),
        ("label x --outt y.csv", "'--out'"),
        ("effects slippulse", "'slip_pulse'"),
    ],
)
def test_what_is_nearly_right_is_asked_for(call, meant, capsys):
    assert main(call.split()) == 2
    assert f"did you mean {meant}?" in capsys.readouterr().err
