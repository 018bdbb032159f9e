"""A rig file without a fit of its own is told whose bushing is compared with, in every answer."""

from __future__ import annotations

import json

import pytest

from models.rig_files.rig_file import load_material_rig, load_rig
from models.rig_files.shipped import material_names
from noise.cli import main
from noise.diagnosis.assumed_fit import assumed_fit
from tests.helpers.small_rigs import RIG_FILE, at, run, write_case


@pytest.mark.parametrize("name", material_names())
def test_every_shipped_bushing_is_named_by_its_own_name(name):
    rig = load_material_rig(name)
    words = assumed_fit(rig, rig.interference_range)
    assert f"shipped for {rig.material}, " in words or f"shipped for {name}, " in words
    assert words.count("Nm/rad") == len(set(rig.interference_range))


@pytest.mark.parametrize("text", ['base = "fluorocarbon-thesis"', 'material = "PDMS"', ""])
def test_the_bushing_that_was_not_stated_is_named(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    assert assumed_fit(load_rig(path), [0.279e-3]).startswith("no [[fit]] of its own")
    path.write_text(RIG_FILE, encoding="utf-8")
    assert assumed_fit(load_rig(path), [0.279e-3]) == ""


def test_json_page_and_terminal_say_the_same_of_it(tmp_path, capsys):
    recordings = [run(at(speed), seed=i) for i, speed in enumerate((1.0, 1.6))]
    data, rig = write_case(tmp_path, recordings, 'base = "fluorocarbon-thesis"')
    out = tmp_path / "out"
    assert main(["diagnose", str(data), "--rig", str(rig), "--quick", "--out", str(out)]) == 0
    words = assumed_fit(load_rig(rig), [0.279e-3])
    assert words in json.loads((out / "diagnosis.json").read_text())["notes"]
    assert words in " ".join(capsys.readouterr().err.split())
    assert words.split(",")[0] in (out / "report.html").read_text()
