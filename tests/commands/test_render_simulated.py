from __future__ import annotations

import json

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.cli import main
from noise.recordings import read_recording, write_recording

PLAIN_RIG = """
name = "plain"
material = "our rubber"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = {torque}
kinetic_torque_Nm = 8.0
damping_Nms_rad = 0.09
"""


def rendered(*arguments):
    assert main(["render", *map(str, arguments)]) == 0


def test_two_rig_files_are_heard_back_to_back_at_one_gain(tmp_path):
    for name, torque in (("old", 10.7), ("new", 8.5)):
        (tmp_path / f"{name}.toml").write_text(PLAIN_RIG.format(torque=torque))
    out = tmp_path / "ab.wav"
    rigs = [tmp_path / "old.toml", tmp_path / "new.toml"]
    given = ["--speed", "2", "--seconds", "0.5", "--gap", "0.25"]
    rendered("--ab", *rigs, *given, "--out", out)
    about = json.loads(out.with_suffix(".json").read_text())
    assert [part["name"] for part in about["parts"]] == ["old", "new"]
    assert [part["start_s"] for part in about["parts"]] == [0.0, 0.75]
    assert [part["conditions"]["material"] for part in about["parts"]] == ["our rubber"] * 2
    heard = read_recording(out)
    assert heard.duration == pytest.approx(1.25)
    assert heard.condition.speed == 2.0
    parts = heard["pressure"][:24000], heard["pressure"][36000:]
    told = about["parts"][0]["level_db"] - about["parts"][1]["level_db"]
    found = 20 * np.log10(parts[0].std() / parts[1].std())
    assert found == pytest.approx(told, abs=0.1)
    assert abs(told) > 1.0


def test_recordings_and_conditions_in_quotes_can_be_compared(tmp_path):
    tone = 0.1 * np.sin(2 * np.pi * 1000 * np.arange(24000) / 48e3)[np.newaxis]
    write_recording(tmp_path / "measured", Recording(tone, 48e3, (Channel("pressure"),)))
    out = tmp_path / "ab"
    condition = "--interference 0.381 --material PDMS"
    given = ["--speed", "5", "--seconds", "0.2"]
    rendered("--ab", tmp_path / "measured.wav", condition, *given, "--out", out)
    parts = json.loads((tmp_path / "ab.json").read_text())["parts"]
    simulated = "interference-0.381-material-PDMS"
    assert [part["name"] for part in parts] == ["measured.wav", simulated]
