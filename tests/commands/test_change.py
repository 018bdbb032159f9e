"""One rig file for every command, ``--change``, and what is said of a run once."""

import json

import numpy as np
import pytest

from noise.cli import main
from noise.recordings import read_recording

SHORT = ("--speed", "5", "--seconds", "0.2")


def simulated(folder, name, *given):
    assert main(["simulate", *SHORT, *map(str, given), "--out", str(folder / name)]) == 0
    return read_recording(folder / f"{name}.wav"), json.loads((folder / f"{name}.json").read_text())


def test_a_copy_by_base_is_heard_as_the_material_bit_for_bit(tmp_path):
    rig = tmp_path / "copy.toml"
    rig.write_text('base = "fluorocarbon"\n[design]\nname = "copy"\n[tolerances]\ndamping = 0.1\n')
    plain, about = simulated(tmp_path, "plain")
    copy, copied = simulated(tmp_path, "copy", "--rig", rig)
    assert np.array_equal(plain.samples, copy.samples)
    assert about == copied
    assert "notes" not in about


def test_a_change_of_the_call_is_that_of_the_file(tmp_path):
    rig = tmp_path / "soft.toml"
    rig.write_text('base = "fluorocarbon"\n[change]\ndamping = "x2"\nageing_time = "-20 %"\n')
    filed, _ = simulated(tmp_path, "filed", "--rig", rig)
    called, _ = simulated(
        tmp_path, "called", "--change", "damping=x2", "--change", "ageing_time=-20%"
    )
    assert np.array_equal(filed.samples, called.samples)


@pytest.mark.parametrize("change", ["damping", "dampin=x2", "damping=0.1", "damping=x0"])
def test_a_change_that_cannot_be_used_is_refused(capsys, change):
    assert main(["simulate", *SHORT, "--change", change]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_what_is_odd_is_said_once_and_kept(tmp_path, capsys):
    given = ["--effect", "partial_slip", "--temperature", "80", "--support-stiffness", "3000"]
    given += ["--interference", "0.000279", "--change", "critical_torque=x1000"]
    _, about = simulated(tmp_path, "odd", *given, "--change", "kinetic_torque=x1000")
    told = capsys.readouterr().err
    for part in ("Nmm?", "metres?", "interpolated", "partial_slip cannot act", "temperature 80",
                 "nothing ever slips"):  # fmt: skip
        assert any(part in note for note in about["notes"]), part
    assert all(told.count(note) == 1 for note in about["notes"])
