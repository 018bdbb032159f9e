"""Anchors fitted to measured modes."""

from dataclasses import replace

import numpy as np
import pytest

from models.bench import Beams
from noise.thesis.exact_beams import ClampOnBeams, RootMotion, natural_frequencies
from noise.thesis.modes import fit_anchors

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
BENCH = ClampOnBeams(STEEL, 0.123, 0.96, 1 / 1050, 3500.0 * 4.4482216 / 0.0254, 750.0)
MOTIONS = (RootMotion.TURNING, RootMotion.SIDEWAYS)


MEASURED = {0.123: [250.0, 900.0, 4500.0, 6000.0], 0.092: [310.0, 1375.0]}


@pytest.fixture(scope="module")
def fitted():
    return fit_anchors(BENCH, MEASURED)


def test_anchors_that_yield_bring_all_measured_modes_within_a_tenth(fitted):
    assert fitted.found == pytest.approx([*MEASURED[0.123], *MEASURED[0.092]], rel=0.10)


def test_no_neighbour_of_the_fit_is_better(fitted):
    def cost(structure):
        every = {
            length: np.concatenate(
                [natural_frequencies(replace(structure, length=length), 8e3, m) for m in MOTIONS]
            )
            for length in (0.123, 0.092)
        }
        nearest = [
            np.abs(np.log(every[length] / mode)).min()
            for length, modes in MEASURED.items()
            for mode in modes[1:]
        ]
        first = [
            np.log(natural_frequencies(replace(structure, length=length), 500.0)[0] / mode)
            for length, mode in ((0.123, 250.0), (0.092, 310.0))
        ]
        return np.sum(np.abs([*nearest, *first]) ** 4)

    best, beams = cost(fitted.structure), fitted.structure.beams
    for factor in (0.95, 1.05):
        stiffer = replace(beams, anchor_translation=factor * beams.anchor_translation)
        assert cost(replace(fitted.structure, beams=stiffer)) > best
        inertia = factor * fitted.structure.clamp_inertia
        assert cost(replace(fitted.structure, clamp_inertia=inertia)) > best
