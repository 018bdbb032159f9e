"""Recorded acceleration and sound against what the identified rig's structure predicts."""

from dataclasses import replace

import numpy as np
import pytest

from models.condition import Condition
from models.rig_file import load_material_rig
from noise.identification.identify import level_offsets, structure_notes
from noise.identification.measured import measured
from sim.run import simulate

RIG = load_material_rig("fluorocarbon-thesis")


def recorded(gain=1.0, channels=None):
    run = simulate(RIG, 1.0, seconds=0.4, rng=np.random.default_rng(3)).recording
    samples = run.samples.copy()
    for i, channel in enumerate(run.channels):
        if channel.kind in ("acceleration", "pressure"):
            samples[i] *= gain
    whole = replace(run, samples=samples, condition=Condition(1.0, 0.279e-3, 2214.0))
    if channels is None:
        return measured(whole, "run")
    rows = [i for i, channel in enumerate(run.channels) if channel.kind in channels]
    return measured(
        replace(whole, samples=samples[rows], channels=tuple(run.channels[i] for i in rows)), "run"
    )


def test_our_own_structure_fits_itself():
    offsets = level_offsets(RIG, [recorded()])
    assert set(offsets) == {"acceleration", "pressure"}
    assert all(abs(offset) < 1.5 for offset in offsets.values())


@pytest.mark.parametrize(("gain", "words"), [(2.0, "6 dB above"), (0.1, "20 dB below")])
def test_another_structure_is_told_by_its_level(gain, words):
    notes = structure_notes(RIG, [recorded(gain)])
    assert len(notes) == 2
    assert all("measure responses with frf" in note for note in notes)
    offset = level_offsets(RIG, [recorded(gain)])["acceleration"]
    assert offset == pytest.approx(20.0 * np.log10(gain), abs=1.5)
    assert any(words.split()[2] in note for note in notes)


def test_torque_alone_says_nothing_of_the_structure():
    assert structure_notes(RIG, [recorded(channels=("torque", "angle"))]) == []
