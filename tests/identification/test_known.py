"""What a rig file states beforehand, itself or by the file that it builds on."""

import tomllib
from dataclasses import replace
from types import SimpleNamespace

import pytest

from models.condition import KnownCondition
from models.rig_file import load_material_rig, rig_from, rig_text
from noise.identification.identify import dependence_of
from noise.identification.measured import known_beforehand

INERTIAS = "elastomer_inertia_kgm2 = 1.6e-5\nclamp_inertia_kgm2 = 8e-4\n"


def test_a_file_below_states_inertias_too(tmp_path):
    (tmp_path / "bench.toml").write_text(INERTIAS)
    (tmp_path / "mine.toml").write_text('base = "bench.toml"\n')
    known = known_beforehand(tmp_path / "mine.toml")
    assert known.inertias_stated
    assert known.known == known_beforehand(tmp_path / "bench.toml").known


def test_a_shipped_material_states_none_of_a_users_rig(tmp_path):
    (tmp_path / "mine.toml").write_text('base = "fluorocarbon"\n')
    assert not known_beforehand(tmp_path / "mine.toml").inertias_stated


def test_an_identified_rig_keeps_the_structure_of_the_known_one(tmp_path):
    (tmp_path / "bench.toml").write_text(f"{INERTIAS}[plate]\nthickness_m = 0.004\n")
    beforehand = known_beforehand(tmp_path / "bench.toml")
    found = replace(load_material_rig("fluorocarbon-thesis"), fastest_fitted=3.0)
    again = rig_from(tomllib.loads(rig_text(found, (), beforehand.structure)), tmp_path, "rig")
    assert again.plate == beforehand.rig.plate != found.plate
    assert again.fits == found.fits
    assert again.friction == found.friction
    assert again.fastest_fitted == 3.0


@pytest.mark.parametrize(("heat", "reference"), [((20.0, None, 30.0), 25.0), ((None,), 23.0)])
def test_a_rig_depends_on_temperature_from_that_of_its_recordings_on(heat, reference):
    recordings = [
        SimpleNamespace(measured=SimpleNamespace(condition=condition))
        for condition in (KnownCondition(1.0, 2.79e-4, 2214.0, None, at) for at in heat)
    ]
    rig = load_material_rig("fluorocarbon")
    assert dependence_of(rig, recordings, "fluorocarbon").reference == reference
    assert dependence_of(rig, recordings, "PDMS") is None
