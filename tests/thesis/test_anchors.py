"""Anchors fitted to measured modes."""

from dataclasses import replace

import numpy as np
import pytest

from models.bench import Beams
from models.errors import ParameterError
from noise.thesis.anchors import fit_anchors
from noise.thesis.exact_beams import ClampOnBeams, RootMotion, natural_frequencies

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
BENCH = ClampOnBeams(STEEL, 0.123, 0.96, 1 / 1050, 3500.0 * 4.4482216 / 0.0254, 750.0)
MOTIONS = (RootMotion.TURNING, RootMotion.SIDEWAYS)


@pytest.fixture(scope="module")
def fitted():
    measured = {0.123: [250.0, 900.0, 4500.0, 6000.0], 0.092: [310.0, 1375.0]}
    return fit_anchors(BENCH, measured)


def test_anchors_that_yield_bring_all_measured_modes_within_a_tenth(fitted):
    assert max(map(abs, fitted.errors)) < 0.10
    assert fitted.found == pytest.approx(
        [x * (1 + e) for x, e in zip(fitted.measured, fitted.errors, strict=True)]
    )


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
            for length, mode in zip(fitted.length[1:4], fitted.measured[1:4], strict=True)
        ]
        nearest.append(np.abs(np.log(every[0.092] / 1375.0)).min())
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


def test_what_cannot_be_fitted_is_refused():
    with pytest.raises(ParameterError, match="'density' cannot be fitted"):
        fit_anchors(BENCH, {0.123: [250.0]}, free=["density"])
    with pytest.raises(ParameterError, match="1 measured modes cannot give 3 numbers"):
        fit_anchors(BENCH, {0.123: [250.0]})
