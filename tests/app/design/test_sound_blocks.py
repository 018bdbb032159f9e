"""Blocks of sound as the page asks for them."""

from __future__ import annotations

import json
import time
import urllib.request
from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.app.design import design_of
from noise.app.design_controls import bases_of
from noise.app.design_player import BLOCK, HEADER, RATE, REFUSED, Player
from noise.app.design_view import LiveSounds
from noise.app.opened import open_paths
from sim.acquisition import Acquisition
from sim.run import simulate
from tests.helpers.opened_app import PATIENCE, opened_app

BASES = bases_of(open_paths([]))
PLAIN = {"base": "fluorocarbon", "values": {}}


@pytest.fixture
def player():
    made = Player()
    yield made
    made.beside.stop()


def setting(design):
    return design_of(design, BASES).setting


def read(block):
    sequence, serial, n, m, speed = HEADER.unpack(block[: HEADER.size])
    numbers = np.frombuffer(block[HEADER.size :], "<f4")
    assert numbers.size == n + m
    return {"sequence": sequence, "serial": serial, "pressure": numbers[:n], "speed": speed}


def told(message):
    """Serial of what was refused and why, None and nothing where nothing was; then the block."""
    refused, serial, n, *_ = HEADER.unpack(message[: HEADER.size])
    if refused != REFUSED:
        return None, "", read(message)
    end = HEADER.size + n
    return serial, message[HEADER.size : end].decode(), read(message[end:])


def heard(player, designs, run=1, first=0):
    """Blocks in a row; a design that is None stays as it is."""
    blocks = []
    for i, design in enumerate(designs, first):
        if i == 0:
            player.start(run, 0, setting(design))
        elif design is not None:
            player.change(run, i, setting(design))
        block = read(player.block(run))
        assert block["sequence"] == i
        assert design is None or block["serial"] == i
        blocks.append(block["pressure"])
    return np.concatenate(blocks)


def test_a_change_that_cannot_be_is_told_and_the_run_goes_on_as_it_was(player):
    heard(player, [PLAIN, None])
    too_tight = replace(setting(PLAIN), interference=0.5)
    player.change(1, 2, too_tight)
    serial, why, block = told(player.block(1))
    assert serial == 2
    assert "interference" in why
    assert "\n" not in why
    goes_on = heard(player, [None] * 2, first=3)
    untouched = heard(player, [PLAIN, *[None] * 4], run=3)
    np.testing.assert_array_equal(
        np.concatenate([block["pressure"], goes_on]), untouched[2 * BLOCK :]
    )


@pytest.mark.parametrize(
    "said",
    [
        {},
        {"run": 1, "serial": 0},
        {"run": -1, "serial": 0, "design": PLAIN},
        {"run": 1, "serial": 1.5, "design": PLAIN},
        {"run": 1, "serial": 0, "design": {"base": "../x"}},
        {"run": 1, "serial": 0, "design": []},
        {"run": 1, "serial": 0, "design": PLAIN},  # there is no such run
    ],
)
def test_changes_that_cannot_be_are_refused_in_a_line(said):
    with pytest.raises(ParameterError) as caught:
        LiveSounds(BASES).change(said)
    assert "\n" not in str(caught.value)


def streamed(app, number, n, design=PLAIN):
    """Blocks of a stream as they come; it is left after so many."""
    said = json.dumps({"run": number, "serial": 0, "design": design}).encode()
    url = f"{app.base}/api/design/sound?token={app.token}"
    with urllib.request.urlopen(urllib.request.Request(url, said), timeout=PATIENCE) as answer:
        for _ in range(n):
            header = answer.read(HEADER.size)
            sizes = HEADER.unpack(header)[2:4]
            yield read(header + answer.read(4 * sum(sizes)))


def test_a_stream_is_the_recording_that_simulate_makes_and_comes_as_it_is_played():
    from features.kernels.weighting import sound_levels

    with opened_app() as app:
        assert len(list(streamed(app, 9, 2))) == 2  # whatever is done once is done now
        begun, blocks = time.monotonic(), []
        for block in streamed(app, 1, 75):
            blocks.append(block)
            if len(blocks) == 60:
                levels = app.json("api/design/levels?run=1")
        assert time.monotonic() - begun > 0.9 * 73 * BLOCK / RATE
        assert [block["sequence"] for block in blocks] == list(range(75))
        pressure = np.concatenate([block["pressure"] for block in blocks])
        rig, through = load_material_rig("fluorocarbon"), Acquisition(rate=RATE, noise={})
        expected = simulate(rig, 5.0, seconds=1.5, acquisition=through).recording["pressure"]
        inner, noise = slice(40, expected.size - 40), Acquisition().noise["pressure"]
        np.testing.assert_allclose(pressure[inner], expected[inner], atol=6.0 * noise)
        found = sound_levels(pressure[-RATE:].astype(float), RATE)
        assert levels["level_dba"] == pytest.approx(found.level_a, abs=1.0)
        assert levels["l_afmax_dba"] == pytest.approx(found.level_af_max, abs=1.0)
        assert app.json("api/design/levels?run=2")["level_dba"] is None
