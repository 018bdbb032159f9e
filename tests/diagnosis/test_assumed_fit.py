"""A rig file without a fit of its own is told whose bushing is compared with."""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.rig_file import load_material_rig, load_rig, material_names
from noise.diagnosis.case import Case
from noise.diagnosis.diagnose import assumed_fit, case_remarks
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG_FILE, at, run


@pytest.mark.parametrize("name", material_names())
def test_every_shipped_bushing_is_named_by_its_own_name(name):
    rig = load_material_rig(name)
    words = assumed_fit(rig)
    assert f"shipped for {rig.material};" in words or f"shipped for {name};" in words


@pytest.mark.parametrize("text", ['base = "fluorocarbon-thesis"', 'material = "PDMS"', ""])
def test_the_bushing_that_was_not_stated_is_named(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    assert assumed_fit(load_rig(path)).startswith("no [[fit]] of its own")
    path.write_text(RIG_FILE, encoding="utf-8")
    assert assumed_fit(load_rig(path)) == ""


@pytest.mark.parametrize(("heat", "far"), [(25.0, False), (60.0, True)])
def test_recordings_far_from_the_temperature_of_a_shipped_bushing_say_so(heat, far):
    recording = run(at(1.0))
    hot = replace(recording, condition=replace(recording.condition, temperature=heat))
    case = Case(load_material_rig("fluorocarbon-thesis"), ("run",), (hot,))
    assert far == any("temperature 60" in text for text in case_remarks(case, EFFECTS))
