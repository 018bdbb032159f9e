from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from models.errors import ParameterError
from models.radiation.rig_response import first_mode_damping, impulse_responses
from models.rig_file import load_material_rig
from models.structure.beams import ANCHOR_FORCE, ANCHOR_MOMENT, TORQUE, beam_length, beam_structure
from models.structure.plate import plate_modes, pressure_response
from tests.helpers.spectra import path_spectra

RATE = 96e3
THESIS = load_material_rig("fluorocarbon-thesis")
BENCH = dataclasses.replace(THESIS, beams=dataclasses.replace(THESIS.beams, radiating=False))
SQUEAKY = 2.79e-4


def test_torque_reaches_the_microphone_through_both_anchors():
    modes = plate_modes(BENCH.plate, 16e3)
    arm = BENCH.beams.lever + beam_length(BENCH.beams, 2214.0)
    x, y = BENCH.plate.clamp_position
    damping = first_mode_damping(BENCH, SQUEAKY, 2214.0)
    structure = beam_structure(BENCH.beams, 2214.0, BENCH.clamp_inertia, damping, 40e3)
    frequency = np.array([100.0, 250.0, 1000.0, 3300.0, 7000.0, 12000.0])
    anchors = structure.frequency_response(frequency)[ANCHOR_FORCE:, TORQUE]
    drives = [
        modes.shape([x + arm], [y]),
        modes.shape([x - arm], [y]),
        modes.slope([x + arm], [y]),
        modes.slope([x - arm], [y]),
    ]
    heard = pressure_response(modes, np.concatenate(drives).T, BENCH.microphone, RATE, 2**17)
    kernel = np.exp(-2j * np.pi / RATE * np.outer(np.arange(2**17), frequency))
    force = anchors[ANCHOR_FORCE - 1]
    moment = anchors[ANCHOR_MOMENT - 1]
    right, left, right_turn, left_turn = heard @ kernel
    expected = force * (right - left) + moment * (right_turn + left_turn)
    found = path_spectra(impulse_responses(BENCH, SQUEAKY, 2214.0, RATE), frequency)
    assert np.abs(found.torque_to_pressure / expected) == pytest.approx(1, abs=0.05)


def test_anchors_off_the_plate_are_refused():
    narrow = dataclasses.replace(BENCH, plate=dataclasses.replace(BENCH.plate, length=0.33))
    with pytest.raises(ParameterError, match="off the plate"):
        impulse_responses(narrow, SQUEAKY, 2214.0, RATE)
