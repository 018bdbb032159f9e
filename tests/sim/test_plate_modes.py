"""Further resonances of what radiates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from sim.chain import resonance
from tests.helpers.chain_paths import RATE, changed, spectra
from tests.helpers.spectra import path_spectra

RIG = load_material_rig("fluorocarbon")


@pytest.fixture(scope="module")
def plain():
    return impulse_responses(RIG, 0.381e-3, 2214.0, RATE, seconds=0.1)


def test_a_lonely_resonance_adds_6_db_where_it_is_and_nothing_far_away(plain):
    louder = changed(plain, "plate_modes", frequency=2000.0)
    frequency = np.array([200.0, 2000.0, 15e3])
    before, after = (path_spectra(each, frequency) for each in (plain, louder))
    for path in ("torque_to_pressure", "pulse_to_pressure"):
        gain = 20 * np.log10(np.abs(getattr(after, path) / getattr(before, path)))
        assert gain == pytest.approx([0.0, 6.02, 0.0], abs=0.02)


@pytest.mark.parametrize("form", ["even", "scattered"])
def test_many_resonances_lie_as_dense_as_they_are_told(plain, form):
    flat = replace(plain, torque_to_pressure=np.ones(1), pulse_to_pressure=np.ones(1))
    given = {"form": form, "frequency": 1000.0, "spacing": 500.0, "damping_ratio": 1e-3}
    rung = changed(flat, "plate_modes", **given).torque_to_pressure
    frequency, rung = spectra(rung)
    size = np.abs(rung - 1.0)
    peaks = np.count_nonzero((size[1:-1] > size[:-2]) & (size[1:-1] > size[2:]))
    assert 22 <= peaks <= 34
    assert frequency[size > 0.5].min() == pytest.approx(1000.0, abs=5.0) or form == "scattered"


@pytest.mark.parametrize("frequency", [100.0, 3000.0, 12e3])
def test_a_resonance_is_exact_where_it_rings(frequency):
    ringing = resonance([0.0, 0.04, 0.0], frequency, 0.02, RATE)
    turn = np.exp(-2j * np.pi * frequency / RATE * np.arange(ringing.size))
    assert ringing @ turn == pytest.approx(1.0, abs=1e-4)
