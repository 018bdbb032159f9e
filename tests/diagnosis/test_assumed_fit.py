"""A rig file without a fit of its own is told whose bushing is compared with, in every answer."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from models.rig_file import load_material_rig, load_rig, material_names
from noise.cli import main
from noise.diagnosis.case import Case
from noise.diagnosis.diagnose import assumed_fit, case_remarks
from sim.effects import EFFECTS
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


@pytest.mark.parametrize(("heat", "far"), [(25.0, False), (60.0, True)])
def test_recordings_far_from_the_temperature_of_a_shipped_bushing_say_so(heat, far):
    recording = run(at(1.0))
    hot = replace(recording, condition=replace(recording.condition, temperature=heat))
    case = Case(load_material_rig("fluorocarbon-thesis"), ("run",), (hot,))
    assert far == any("temperature 60" in text for text in case_remarks(case, EFFECTS))


def test_json_page_and_terminal_say_the_same_of_it(tmp_path, capsys):
    recordings = [run(at(speed), seed=i) for i, speed in enumerate((1.0, 1.6))]
    data, rig = write_case(tmp_path, recordings, 'base = "fluorocarbon-thesis"')
    out = tmp_path / "out"
    assert main(["diagnose", str(data), "--rig", str(rig), "--quick", "--out", str(out)]) == 0
    words = assumed_fit(load_rig(rig), [0.279e-3])
    notes = json.loads((out / "diagnosis.json").read_text())["notes"]
    said = " ".join(capsys.readouterr().err.split())
    assert words in notes
    assert any("repeats differ is assumed" in note for note in notes)
    assert all(said.count(note) == 1 for note in notes)
    assert words.split(",")[0] in (out / "report.html").read_text()
