"""Further modes of clamp, beams and anchors."""

from __future__ import annotations

import numpy as np
import pytest

from models.condition import FIXED
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from tests.helpers.chain_paths import RATE, changed, spectra
from tests.helpers.spectra import path_spectra

RIG = load_material_rig("fluorocarbon")


@pytest.fixture(scope="module")
def plain():
    return impulse_responses(RIG, 0.381e-3, 2214.0, RATE, seconds=0.1)


def test_a_further_mode_stands_out_in_acceleration_and_sound(plain):
    louder = changed(plain, "beam_modes", constant=20.0)
    frequency = np.array([4500.0])
    before, after = (path_spectra(each, frequency) for each in (plain, louder))
    added = after.torque_to_acceleration - before.torque_to_acceleration
    assert np.abs(added) == pytest.approx(20.0 / (2 * 0.01), rel=1e-4)
    heard = after.torque_to_pressure - before.torque_to_pressure
    expected = 0.04 * np.abs(added) * np.abs(before.pulse_to_pressure)
    assert np.abs(heard) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("form", "expected"),
    [("single", [900]), ("pair", [900, 1200]), ("ladder", [900, 2500, 4900, 8100, 12100, 16900])],
)
def test_forms_of_beam_modes_have_their_frequencies(plain, form, expected):
    louder = changed(plain, "beam_modes", form=form, frequency=900.0, damping_ratio=0.002)
    frequency, after, before = spectra(louder.torque_to_acceleration, plain.torque_to_acceleration)
    added = np.abs(after - before)
    peaks = np.flatnonzero((added[1:-1] > added[:-2]) & (added[1:-1] > added[2:])) + 1
    strong = peaks[added[peaks] > 10.0 * np.median(added)]
    assert frequency[strong] == pytest.approx(expected, abs=6.0)


def test_with_the_clamp_bolted_down_there_are_no_beams_to_have_modes():
    bolted = impulse_responses(RIG, 0.381e-3, FIXED, RATE, seconds=0.1)
    assert changed(bolted, "beam_modes", amount=50.0) is bolted
