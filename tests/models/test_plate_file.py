"""Plate and microphone tables of rig files."""

from __future__ import annotations

import pytest

from models.errors import ParameterError
from models.rig import Floor
from models.rig_files.plate_file import a_microphone, a_plate
from models.rig_files.rig_file import load_material_rig, load_rig

TABLE = {
    "length_m": 0.9,
    "width_m": 0.6,
    "thickness_m": 0.01,
    "youngs_modulus_Pa": 2e11,
    "density_kgm3": 7850.0,
    "poisson_ratio": 0.3,
    "loss_factor": 0.03,
    "clamp_position_m": [0.0, 0.12],
}
PLATE = a_plate(TABLE, "plate")


def test_the_shipped_plate_is_simply_supported_without_a_floor():
    rig = load_material_rig("fluorocarbon")
    assert rig.plate == PLATE
    assert rig.plate.edges == "simply_supported"
    assert rig.microphone.floor is None


def test_edges_damping_by_frequency_and_floor_come_from_the_file(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        "[plate]\n"
        'edges = ["clamped", "free", "simply_supported", "free"]\n'
        'loss_factor = { "1000" = 0.03, "100" = 0.05 }\n'
        "[microphone]\n"
        'floor = { normal = "y", position_m = -0.8, reflection = 0.9 }\n',
        encoding="utf-8",
    )
    rig = load_rig(path)
    assert rig.plate.sides == ("clamped", "free", "simply_supported", "free")
    assert rig.plate.loss_table == ((100.0, 0.05), (1000.0, 0.03))
    assert rig.microphone.floor == Floor("y", -0.8, 0.9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"thickness_m": -0.01}, "thickness_m = -0.01 must be a number above 0"),
        ({"edges": "glued"}, "edges = 'glued' must be one of free, simply_supported, clamped"),
        ({"edges": ["free", "free"]}, "a list of four"),
        ({"edges": [["free"], 1, "free", "free"]}, "a list of four"),
        ({"edges": 3}, "edges = 3"),
        ({"loss_factor": {}}, "loss_factor is empty"),
        ({"loss_factor": {"low": 0.1}}, "entry 'low'"),
        ({"loss_factor": {"-5": 0.1}}, "entry '-5'"),
        ({"loss_factor": {"100": 0.0}}, "100 = 0.0 must be a number above 0"),
        ({"loss_factor": {"100": 0.1, "1e2": 0.2}}, "two entries for the same frequency"),
        ({"loss_factor": 1.5}, "loss_factor = 1.5"),
        ({"poisson_ratio": 0.7}, "poisson_ratio = 0.7"),
        ({"thickness_m": 0.0003}, "a plate must have 5 to 5000"),
        ({"edges": "free", "thickness_m": 0.001}, "not all simply_supported must have 5 to 1500"),
        (
            {"edges": ["free", "clamped", "free", "free"], "thickness_m": 0.003},
            "opposite edges are unlike must have 5 to 600",
        ),
        ({"edge": "free"}, "unknown key 'edge'"),
    ],
)
def test_a_plate_that_cannot_be_used_is_refused_by_key(change, message):
    with pytest.raises(ParameterError) as refused:
        a_plate(TABLE | change, "plate")
    assert message in str(refused.value)
    assert str(refused.value).startswith("plate")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"position_m": [0.0, 0.0, -0.005]}, "position_m = [0, 0, -0.005] is inside the plate"),
        ({"position_m": [0.0, 0.0, -0.5]}, "behind it; its z must be at least 0.01 m above"),
        ({"position_m": [2.0, 0.0, 0.0]}, "level with the plate's surface"),
        ({"floor": 3}, "floor must be a table"),
        ({"floor": {"normal": "up", "position_m": 1}}, "normal = 'up'"),
        ({"floor": {"normal": "x"}}, "position_m is missing"),
        ({"floor": {"normal": "x", "position_m": 2, "reflection": 2}}, "reflection = 2"),
        ({"floor": {"normal": "x", "position_m": 0.2}}, "position = 0.2 m along x"),
        ({"floor": {"normal": "z", "position_m": -0.7}}, "must be above the microphone"),
    ],
)
def test_a_microphone_that_cannot_hear_is_refused_by_key(table, message):
    with pytest.raises(ParameterError) as refused:
        a_microphone({"position_m": [0.1, 0.1, 0.5]} | table, PLATE, "microphone")
    assert message in str(refused.value)
    assert str(refused.value).startswith("microphone")
    assert "\n" not in str(refused.value)
