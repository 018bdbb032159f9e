"""Copies of design files beside a screen: each is the design that was screened."""

import pytest

from models.rig_file import load_rig
from noise.screening.design import copy_design_file, load_design


def written(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def test_a_design_whose_bases_lie_in_several_folders_can_be_copied(tmp_path):
    written(tmp_path / "mine" / "rig.toml", 'base = "fluorocarbon"\n[change]\ndamping = "x2"\n')
    improved = 'base = "../mine/rig.toml"\n[change]\ncritical_torque = "-10 %"\n'
    written(tmp_path / "diagnosis" / "improved.toml", improved)
    easier = 'base = "diagnosis/improved.toml"\n[change]\nelastomer_stiffness = "-5 %"\n'
    source = written(tmp_path / "easier.toml", easier)
    copy = copy_design_file("easier", source, tmp_path / "screen" / "designs")
    assert load_rig(copy) == load_rig(source)


def test_a_base_of_the_same_folder_goes_with_the_copy(tmp_path):
    written(tmp_path / "base.toml", 'base = "PDMS"\n[change]\ndamping = "x2"\n')
    source = written(tmp_path / "soft.toml", 'base = "base.toml"\n')
    copy = copy_design_file("soft", source, tmp_path / "designs")
    before = load_rig(source)
    (tmp_path / "base.toml").unlink()
    assert load_rig(copy) == before


def test_a_changed_design_has_the_use_and_the_tolerances_of_its_base(tmp_path):
    (tmp_path / "one.toml").write_text(
        'base = "fluorocarbon"\n[design]\nname = "one"\ninterference_mm = [0.279]\n'
        "[tolerances]\nelastomer_stiffness = 0.05\n"
    )
    (tmp_path / "two.toml").write_text('base = "one.toml"\n[change]\ndamping = "x2"\n')
    one, two = (load_design(tmp_path / f"{name}.toml") for name in ("one", "two"))
    assert (two.name, two.use, two.tolerances) == ("two", one.use, one.tolerances)
    assert two.use.interference == pytest.approx((0.279e-3,))
