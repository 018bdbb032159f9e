"""Blocks of sound as the page asks for them."""

from __future__ import annotations

import struct
import time

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig_files.rig_file import load_material_rig
from noise.app.design.bases import bases_of
from noise.app.design.sound import BLOCK, RATE, LiveSounds
from noise.app.opened import open_paths
from sim.acquisition import Acquisition
from sim.long_run import simulate_blocks
from tests.helpers.opened_app import opened_app

BASES = bases_of(open_paths([]))
PLAIN = {"base": "fluorocarbon", "values": {}}


@pytest.fixture
def sounds():
    made = LiveSounds(BASES)
    yield made
    made.stop()


def read(block):
    sequence, serial, n, m, _, speed = struct.unpack("<4I2f", block[:24])
    numbers = np.frombuffer(block[24:], "<f4")
    assert numbers.size == n + m
    return {"sequence": sequence, "serial": serial, "pressure": numbers[:n], "speed": speed}


def heard(sounds, designs, run=1, first=0):
    """Blocks in a row; a design that is None stays as it is."""
    blocks = []
    for i, design in enumerate(designs, first):
        said = {"run": run, "sequence": i, "serial": i}
        block = read(sounds.block(said | ({"design": design} if design else {})))
        assert (block["sequence"], block["serial"]) == (i, i)
        blocks.append(block["pressure"])
    return np.concatenate(blocks)


def test_blocks_joined_are_the_recording_that_simulate_makes(sounds):
    pressure = heard(sounds, [PLAIN, *[None] * 24])
    whole = simulate_blocks(
        load_material_rig("fluorocarbon"), 5.0, seconds=0.5, acquisition=Acquisition(rate=RATE)
    )
    expected = np.hstack(list(whole.blocks))[2]
    n = expected.size - 40
    np.testing.assert_allclose(pressure[:n], expected[:n], atol=1e-5 * np.abs(expected).max())


def test_another_support_is_heard_once_its_response_is_known(sounds):
    stiff = {"base": "PDMS", "values": {"support": 3745.0}}
    first = heard(sounds, [{"base": "PDMS", "values": {}}, None, stiff])
    assert np.isfinite(first).all()
    end = time.monotonic() + 60.0
    i = 3
    while sounds._beside.newest is None and time.monotonic() < end:
        heard(sounds, [None], first=i)
        i += 1
        time.sleep(0.05)
    run = sounds._runs[1].live
    heard(sounds, [None, None], first=i)
    np.testing.assert_array_equal(
        run._found.torque_to_pressure, sounds._beside.newest[1].torque_to_pressure
    )


def test_several_blocks_at_once_are_those_that_come_one_by_one(sounds):
    one_by_one = heard(sounds, [PLAIN, *[None] * 3])
    said = {"run": 9, "sequence": 0, "serial": 0, "count": 4, "design": PLAIN}
    answer = sounds.block(said)
    size = len(answer) // 4
    blocks = [read(answer[i * size : (i + 1) * size]) for i in range(4)]
    assert [block["sequence"] for block in blocks] == [0, 1, 2, 3]
    together = np.concatenate([block["pressure"] for block in blocks])
    np.testing.assert_array_equal(together, one_by_one)
    with pytest.raises(ParameterError, match="count"):
        sounds.block({**said, "sequence": 4, "count": 99})


def test_a_design_that_cannot_be_changes_nothing(sounds):
    heard(sounds, [PLAIN, None])
    broken = {"base": "fluorocarbon", "values": {"change.critical_torque": 0.1}}
    with pytest.raises(ParameterError, match="kinetic_torque"):
        sounds.block({"run": 1, "sequence": 2, "serial": 2, "design": broken})
    goes_on = heard(sounds, [None] * 3, first=2)
    untouched = heard(sounds, [PLAIN, *[None] * 4], run=3)
    np.testing.assert_array_equal(goes_on, untouched[2 * BLOCK :])


@pytest.mark.parametrize(
    "said",
    [
        None,
        {},
        {"run": 1, "sequence": 0, "serial": 0},
        {"run": -1, "sequence": 0, "serial": 0, "design": PLAIN},
        {"run": 1, "sequence": 5, "serial": 0, "design": PLAIN},
        {"run": 1, "sequence": 0, "serial": 0, "design": {"base": "../x"}},
        {"run": 1, "sequence": 0, "serial": 0, "design": []},
    ],
)
def test_requests_that_cannot_be_are_refused_in_a_line(sounds, said):
    with pytest.raises(ParameterError) as caught:
        sounds.block(said)
    assert "\n" not in str(caught.value)


def test_levels_are_those_of_the_meter(sounds):
    from features.kernels.levels import sound_levels

    assert sounds.levels(1)["level_dba"] is None
    pressure = heard(sounds, [PLAIN, *[None] * 49]).astype(float)
    found = sound_levels(pressure, RATE)
    assert sounds.levels(1)["level_dba"] == pytest.approx(found.level_a, abs=0.06)
    assert sounds.levels(1)["l_afmax_dba"] == pytest.approx(found.level_af_max, abs=0.06)


def test_without_the_token_or_from_another_site_no_sound_comes():
    said = {"run": 1, "sequence": 0, "serial": 0, "design": PLAIN}
    with opened_app() as app:
        for path in ("block", "facts", "rig"):
            for wrong in (
                {"token": "wrong"}, {"Origin": "http://evil.example"}, {"Host": "evil.example"},
            ):  # fmt: skip
                status, answer = app.request(f"api/design/{path}", said, **wrong)
                assert status == 403, (path, wrong)
                assert answer.startswith(b"refused")
        status, answer = app.request("api/design/block", said)
        assert status == 200
        assert len(answer) > 4 * BLOCK
