"""Modes fitted to response functions."""

import numpy as np
import pytest

from features.modal.modal_fit import fit_modes
from models.errors import ParameterError
from models.structure.modal import ModalModel

FREQUENCY = np.array([147.0, 250.0, 310.0, 900.0, 1375.0, 1800.0, 1850.0, 3000.0, 4500.0])
DAMPING = np.array([0.02, 0.01, 0.01, 0.02, 0.005, 0.008, 0.008, 0.03, 0.01])
SHAPES = np.array([0.9, -0.6, 0.5, 1.0, -0.4, 0.8, 0.7, -0.9, 1.0])
LINES = np.arange(2.0, 6000.0, 2.0)


STRUCTURE = ModalModel(
    FREQUENCY, DAMPING, SHAPES[:, None], np.zeros((1, 9)), SHAPES[None], np.zeros((1, 1))
)


def measured(noise, seed=0):
    true = STRUCTURE.frequency_response(LINES)[0, 0]
    scatter = np.random.default_rng(seed).standard_normal((2, LINES.size))
    return true * (1 + noise * (scatter[0] + 1j * scatter[1]))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_modes_survive_noise_and_none_are_made_up(seed):
    modes = fit_modes(LINES, measured(0.02, seed=seed), low=50, high=5500)
    np.testing.assert_allclose(modes.frequency, FREQUENCY, rtol=2e-3)
    np.testing.assert_allclose(modes.damping_ratio, DAMPING, rtol=0.15)
    peak = np.abs(modes.residues) / (2 * np.pi * modes.frequency * modes.damping_ratio)
    expected = SHAPES**2 / (2 * DAMPING)
    np.testing.assert_allclose(peak, expected, rtol=0.2, atol=0.05 * expected.max())


def test_a_band_of_few_lines_is_refused():
    with pytest.raises(ParameterError, match=r"lines lie between 100 and 110 Hz"):
        fit_modes(LINES, measured(0.0), low=100, high=110)
