from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from models.bench import Beams, Microphone, Plate
from models.condition import FIXED
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses, radiate, radiate_pulses
from models.radiation.rig_response import impulse_responses
from models.rig import Fit, LawSpec, Rig
from models.structure.beams import ANCHOR_FORCE, ANCHOR_MOMENT, TORQUE, beam_length, beam_structure
from models.structure.plate import plate_modes, pressure_response
from tests.helpers.spectra import path_spectra

RATE = 96e3
BENCH = Rig(
    name="bench",
    material="fluorocarbon",
    elastomer_inertia=1 / 65000,
    clamp_inertia=1 / 1200,
    fits=(
        Fit(2.79e-4, 665.0, 10.7, 8.0, {2214.0: 0.105, 3745.0: 0.085}),
        Fit(3.81e-4, 1011.0, 36.94, 30.0, {2214.0: 0.236, 3745.0: 0.080}),
    ),
    friction=LawSpec("coulomb"),
    elastomer_damping_share=0.5,
    effects=(),
    beams=Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4),
    plate=Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (-0.07, 0.04)),
    microphone=Microphone((0.15, -0.10, 0.80)),
)
SQUEAKY = 2.79e-4
TIGHT = 3.81e-4


def test_torque_reaches_the_microphone_through_both_anchors():
    modes = plate_modes(BENCH.plate, 16e3)
    arm = BENCH.beams.lever + beam_length(BENCH.beams, 2214.0)
    x, y = BENCH.plate.clamp_position
    damping = 0.5 * 0.105 / (2 * math.sqrt(2214.0 / 1200))
    structure = beam_structure(BENCH.beams, 2214.0, 1 / 1200, damping, 40e3)
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


def test_bolting_the_clamp_down_silences_the_pulses():
    bolted = impulse_responses(BENCH, TIGHT, FIXED, RATE)
    pulse = np.zeros(4800)
    pulse[100:105] = 10.0
    acceleration, pressure = radiate_pulses(bolted, pulse)
    assert not np.any(acceleration)
    assert not np.any(pressure)


def test_anchors_off_the_plate_are_refused():
    narrow = dataclasses.replace(BENCH, plate=dataclasses.replace(BENCH.plate, length=0.4))
    with pytest.raises(ParameterError, match="off the plate"):
        impulse_responses(narrow, SQUEAKY, 2214.0, RATE)


random = np.random.default_rng(11)
CHAIN = ImpulseResponses(48e3, *random.normal(size=(4, 300)))


@pytest.mark.parametrize("torque", [0.0, 8.0, -30.0])
def test_a_steady_torque_is_silent(torque):
    acceleration, pressure = radiate(CHAIN, np.full(1000, torque))
    assert not np.any(acceleration)
    assert not np.any(pressure)
