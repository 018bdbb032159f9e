"""Copies of design files beside a screen: each is the design that was screened."""

from models.rig_file import load_rig
from noise.screening.design import copy_design_file


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
